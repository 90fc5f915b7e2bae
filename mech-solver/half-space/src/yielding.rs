//! A layer that yields, in series with friction: two sliders under one traction.
//!
//! The slip of an element in a step is the sum of the slip λ_f of the surfaces on the layer and the
//! plastic flow λ of the layer. Both oppose the traction:
//!
//! |p| ≤ f p_n, and < f p_n where λ_f = 0;  |p| ≤ τ(κ), and < τ(κ) where λ = 0;
//! τ(κ) = max(τ₀ + k κ, τ_r),  κ = κ' + λ,
//!
//! with the plastic shift κ accumulated along the path of a particle, κ' before the step, the yield
//! stress τ₀ of fresh material, its change k with the plastic shift (hardening or softening) and
//! the lowest yield stress τ_r. The weaker slider gives way. Both therefore act as one slider with
//! the slip |S| = λ_f + λ, whose bound depends on |S|:
//!
//! - τ(κ') ≥ f p_n: the bound is f p_n, and the layer does not flow;
//! - otherwise τ(κ' + |S|) while below f p_n: the layer takes all of the slip;
//! - otherwise f p_n: the layer has hardened to it, by λ = (f p_n − τ(κ'))/k, and the surfaces take
//!   the remaining slip.
//!
//! Source: Hou, Kalousek and Magel, Wear 211 (1997) 134–140, for the law; Vollebregt, CONTACT, for
//! particles that carry the plastic shift through the contact. The reduction to one slider is this
//! project's.

/// Yield stress of a layer as a function of the plastic shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Yield {
    /// Yield stress τ₀ of fresh material [Pa].
    pub stress: f64,
    /// Change k of the yield stress with the plastic shift [Pa/m]; negative for softening.
    pub hardening: f64,
    /// Lowest yield stress τ_r [Pa].
    pub residual: f64,
}

/// State of both sliders of an element.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SliderState {
    /// Bound of the traction after the slip [Pa].
    pub bound: f64,
    /// Plastic shift λ of the step [m].
    pub shift: f64,
    /// Change of the bound with κ' and with the slip [Pa/m].
    pub slope: f64,
    /// Derivative of κ with respect to κ' [-].
    pub passes: f64,
    /// Derivative of κ with respect to the slip [-].
    pub grows: f64,
    /// Change of the bound of friction with the slip, if friction is the bound [Pa/m].
    pub friction_slope: f64,
}

impl SliderState {
    /// State of an element without a layer, for the bound of friction f p_n [Pa].
    #[must_use]
    pub fn of_friction(friction: f64) -> Self {
        Self { bound: friction, passes: 1.0, ..Self::default() }
    }

    /// Change of the bound with the slip of the element [Pa/m].
    #[must_use]
    pub fn own_slope(&self) -> f64 {
        self.slope + self.friction_slope
    }

    /// Returns true if friction is the bound, and not the layer.
    #[must_use]
    pub fn governed_by_friction(&self) -> bool {
        self.slope == 0.0 && self.grows == 0.0
    }
}

impl Yield {
    /// Yield stress τ after a plastic shift [Pa], and its slope [Pa/m].
    fn after(&self, shift: f64) -> (f64, f64) {
        let stress = self.stress + self.hardening * shift;
        if stress > self.residual { (stress, self.hardening) } else { (self.residual, 0.0) }
    }

    /// Bound before any slip, for the friction bound f p_n and the plastic shift κ' [Pa].
    #[must_use]
    pub fn limit(&self, friction: f64, before: f64) -> f64 {
        friction.min(self.after(before).0)
    }

    /// Largest bound of fresh material for any slip [Pa].
    #[must_use]
    pub fn most(&self, friction: f64) -> f64 {
        if self.hardening > 0.0 { friction } else { friction.min(self.stress) }
    }

    /// Smallest and largest bound after any slip, starting from the plastic shift κ' [Pa].
    #[must_use]
    pub fn range(&self, friction: f64, before: f64) -> [f64; 2] {
        let first = self.limit(friction, before);
        match self.hardening > 0.0 {
            true => [first, friction],
            false if first == friction => [first; 2],
            false => [first.min(self.residual), first],
        }
    }

    /// Plastic shift from κ' to this yield stress [m]; 0 if the yield stress is constant.
    #[must_use]
    pub fn shift_to(&self, stress: f64, before: f64) -> f64 {
        match self.hardening == 0.0 {
            true => 0.0,
            false => ((stress - self.after(before).0) / self.hardening).max(0.0),
        }
    }

    /// State of an element after this slip [m], for the friction bound f p_n [Pa] and the plastic
    /// shift κ' before [m].
    #[must_use]
    pub fn carried(&self, friction: f64, before: f64, slip: f64) -> SliderState {
        let (first, _) = self.after(before);
        if first >= friction {
            return SliderState::of_friction(friction);
        }
        let (bound, slope) = self.after(before + slip);
        if bound < friction {
            let shift = slip;
            return SliderState {
                bound,
                slope,
                shift,
                passes: 1.0,
                grows: 1.0,
                friction_slope: 0.0,
            };
        }
        let shift = (friction - first) / self.hardening;
        SliderState { bound: friction, shift, ..SliderState::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The two sliders act in turn: the layer flows while its bound grows, then the surfaces slip.
    /// Derivatives agree with differences. Tolerance: differences over 1e-6 of the slip.
    #[test]
    fn the_weaker_slider_gives_way() {
        let harder = Yield { stress: 2.0, hardening: 4.0, residual: 0.2 };
        let softer = Yield { hardening: -4.0, ..harder };
        let of = |law: &Yield, friction, before, slip| {
            let carried = law.carried(friction, before, slip);
            [carried.bound, carried.shift]
        };
        assert_eq!(of(&harder, 1.5, 0.0, 0.3), [1.5, 0.0]);
        assert_eq!(of(&harder, 3.0, 0.0, 0.125), [2.5, 0.125]);
        assert_eq!(of(&harder, 3.0, 0.125, 0.5), [3.0, 0.125]);
        assert_eq!(of(&harder, 3.0, 0.5, 0.5), [3.0, 0.0]);
        assert_eq!(of(&softer, 3.0, 0.0, 0.25), [1.0, 0.25]);
        assert_eq!(of(&softer, 3.0, 0.25, 0.5), [0.2, 0.5]);
        assert_eq!(of(&softer, 1.5, 0.0, 0.5), [1.5, 0.0]);
        assert_eq!((harder.most(3.0), softer.most(3.0), softer.most(1.0)), (3.0, 2.0, 1.0));
        assert_eq!(harder.range(3.0, 0.125), [2.5, 3.0]);
        assert_eq!(softer.range(3.0, 0.125), [0.2, 1.5]);
        let small = 1e-6;
        for law in [harder, softer] {
            for (friction, before, slip) in [(3.0, 0.0, 0.1), (3.0, 0.1, 0.6), (1.5, 0.0, 0.1)] {
                let here = law.carried(friction, before, slip);
                let (later, further) = (
                    law.carried(friction, before + small, slip),
                    law.carried(friction, before, slip + small),
                );
                for (change, expected) in [
                    (later.bound - here.bound, here.slope),
                    (further.bound - here.bound, here.slope),
                    (later.shift - here.shift + small, here.passes),
                    (further.shift - here.shift, here.grows),
                ] {
                    assert!((change / small - expected).abs() < 1e-6, "{law:?} {here:?}");
                }
            }
        }
    }
}
