//! Effect `partial_slip`: the leading part of the contact sticks.
//!
//! Coulomb's law with a stick zone: |p_t| ≤ f p_n, equal to it where the surfaces slip, against the
//! slip. For `hertz-carter` it is solved by Carter's strips ([`crate::reference::carter`]); without
//! the effect the whole contact slides.
//!
//! Integrals over u = 1 + X from the trailing edge, with the slipping fraction m and k = 1 − m:
//!
//! - slip √((2 − u)(2m − u)): H(2m) − H(2m − u), H(d) = k²/4 (sinh 2t − 2t), cosh t = 1 + d/k;
//! - traction: the segment of the half ellipse in the slip zone; in the stick zone the difference
//!   of two half ellipses, whose leading terms are subtracted analytically, so that it keeps its
//!   relative accuracy however small the slip zone is.

use crate::models::names::{FASTSIM, HALF_SPACE, HERTZ_CARTER};
use crate::reference::carter;
use crate::slip::Slip;
use crate::strips::StripDensity;
use crate::strips::semi_ellipse::{segment_area, sine_remainder};
use proto::description::EffectSpec;

/// Name in the case file.
pub const NAME: &str = "partial_slip";

/// What the description says of this effect.
#[must_use]
pub fn spec() -> EffectSpec {
    EffectSpec {
        name: NAME.to_owned(),
        law:
            "Coulomb friction with a stick zone: |p_t| <= f p_n, equal to it and against the slip \
              where the surfaces slip; absent: the whole contact slides with p_t = f p_n"
                .to_owned(),
        source: "Carter, Proc. R. Soc. Lond. A 112 (1926) 151-157; Kalker, Three-Dimensional \
                 Elastic Bodies in Rolling Contact (1990)"
            .to_owned(),
        models: [HERTZ_CARTER, FASTSIM, HALF_SPACE].map(str::to_owned).to_vec(),
        consumes: Vec::new(),
        provides: Vec::new(),
        keys: Vec::new(),
    }
}

/// The slip at a prescribed force ratio r = |F|/(f N) in [0, 1].
pub(crate) fn at_force_ratio(force_ratio: f64, prefactor: f64) -> Slip {
    at_slip_fraction(carter::slip_fraction(force_ratio), prefactor)
}

/// The slip at a prescribed magnitude s of the creepage; s ≥ A is full slip, s + A ξ.
pub(crate) fn at_creep(creep: f64, prefactor: f64) -> Slip {
    if creep >= prefactor {
        Slip::Sliding { creep, gradient: prefactor }
    } else {
        at_slip_fraction(creep / prefactor, prefactor)
    }
}

fn at_slip_fraction(fraction: f64, prefactor: f64) -> Slip {
    if fraction == 0.0 {
        Slip::Adhesion
    } else if fraction < 1.0 {
        Slip::Partial { fraction, prefactor }
    } else {
        Slip::Sliding { creep: prefactor, gradient: prefactor }
    }
}

/// Carter's traction along a strip, over f p_0 √(1 − y²/b²).
pub(crate) struct CarterTraction {
    /// Fraction m of the strip that slips, in (0, 1).
    fraction: f64,
    /// Integral over the slip zone, less the stick zone's antiderivative at its border.
    offset: f64,
}

impl CarterTraction {
    /// For the fraction m of the strip that slips, in (0, 1).
    pub(crate) fn new(fraction: f64) -> Self {
        let border = 2.0 * fraction;
        Self { fraction, offset: segment_area(border) - stick_antiderivative(border, fraction) }
    }
}

impl StripDensity for CarterTraction {
    fn cumulative(&self, u: f64) -> f64 {
        if u <= 2.0 * self.fraction {
            segment_area(u)
        } else {
            self.offset + stick_antiderivative(u, self.fraction)
        }
    }

    fn kink(&self) -> Option<f64> {
        Some((2.0 * self.fraction - 1.0).abs())
    }
}

/// Antiderivative of √(1 − X²) − √(k² − (X − m)²) for X = u − 1 ≥ 2m − 1.
///
/// With S₁ and S₂ the two roots it is ½[X S₁ + asin X − (X − m) S₂ − k² asin((X − m)/k)], where
/// asin X = atan2(X, S₁) and asin((X − m)/k) = atan2(X − m, S₂). For small m, where the two halves
/// cancel, S₁ − S₂ = 2m(1 − X)/(S₁ + S₂) and the difference of the angles is
/// atan2(m S₁ − X(S₁ − S₂), S₁ S₂ + X(X − m)), so that each term is proportional to m.
fn stick_antiderivative(u: f64, m: f64) -> f64 {
    let (x, ahead) = (u - 1.0, 2.0 - u);
    let s1 = (ahead * u).sqrt();
    let s2 = (ahead * (u - 2.0 * m)).sqrt();
    let inner_angle = (x - m).atan2(s2);
    let ratio = carter::force_ratio(m);
    if m > 0.5 {
        return 0.5 * (x * s1 - (x - m) * s2 + x.atan2(s1) - (1.0 - ratio) * inner_angle);
    }
    let difference = if s1 > 0.0 { 2.0 * m * ahead / (s1 + s2) } else { 0.0 };
    let angle = (m * s1 - x * difference).atan2(s1 * s2 + x * (x - m));
    0.5 * (x * difference + m * s2 + angle + ratio * inner_angle)
}

/// Carter's slip velocity along a strip, over V A.
pub(crate) struct CarterSlip {
    /// Fraction m of the strip that slips, in (0, 1).
    fraction: f64,
    /// H(2m), the integral over the whole strip.
    total: f64,
}

impl CarterSlip {
    /// For the fraction m of the strip that slips, in (0, 1).
    pub(crate) fn new(fraction: f64) -> Self {
        Self { fraction, total: slip_from_border(2.0 * fraction, 1.0 - fraction) }
    }
}

impl StripDensity for CarterSlip {
    fn cumulative(&self, u: f64) -> f64 {
        let to_border = (2.0 * self.fraction - u).max(0.0);
        self.total - slip_from_border(to_border, 1.0 - self.fraction)
    }

    fn kink(&self) -> Option<f64> {
        Some((2.0 * self.fraction - 1.0).abs())
    }
}

/// H(d): the integral of the slip from the border of the stick zone, of half length k, over the
/// length d behind it.
fn slip_from_border(d: f64, k: f64) -> f64 {
    let root = (d * (d + 2.0 * k)).sqrt();
    let t = ((d + root) / k).ln_1p();
    if t < 0.5 {
        let double = 2.0 * t;
        return 0.25 * k * k * double.powi(3) * sine_remainder(double * double);
    }
    0.5 * ((d + k) * root - k * k * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::integral;

    /// The integrals against quadrature of the closed forms they come from. Tolerance: Simpson's
    /// rule, relative to the whole strip.
    #[test]
    fn integrals_of_the_closed_forms() {
        for m in [1e-3, 0.1, 0.5, 0.8, 0.99, 1.0 - 1e-9] {
            let (traction, slip) = (CarterTraction::new(m), CarterSlip::new(m));
            for from in [0.0, 0.3, 0.9] {
                let (start, border) = (from * 2.0 * m, 2.0 * m);
                let expected = integral(start, border, |u| carter::slip_shape(u - 1.0, m));
                let value = slip.cumulative(border) - slip.cumulative(start);
                assert!((value - expected).abs() < 1e-9 * slip.total, "slip {m} {from}");

                let expected = integral(start, border, |u| carter::traction_shape(u - 1.0, m));
                let value = traction.cumulative(border) - traction.cumulative(start);
                let whole = traction.cumulative(2.0);
                assert!((value - expected).abs() < 1e-9 * whole, "traction, slip zone {m} {from}");

                let start = border + from * (2.0 - border);
                let expected = integral(start, 2.0, |u| carter::traction_shape(u - 1.0, m));
                let value = traction.cumulative(2.0) - traction.cumulative(start);
                assert!((value - expected).abs() < 1e-9 * whole, "traction, stick zone {m} {from}");
            }
        }
    }

    /// Tolerance: rounding, which the slip zone's small share of the force magnifies by 1/√m.
    #[test]
    fn force_of_a_strip() {
        for m in [1e-12f64, 1e-9, 1e-3, 0.1, 0.5, 0.8, 0.99, 1.0 - 1e-9, 1.0 - 1e-15] {
            let expected = std::f64::consts::FRAC_PI_2 * carter::force_ratio(m);
            let value = CarterTraction::new(m).cumulative(2.0);
            assert!((value / expected - 1.0).abs() < 1e-15 / m.sqrt() + 1e-15, "{m}: {value}");
        }
    }

    #[test]
    fn limits_of_creep_and_force() {
        assert_eq!(at_force_ratio(0.0, 0.01), Slip::Adhesion);
        assert_eq!(at_creep(0.0, 0.01), Slip::Adhesion);
        assert_eq!(at_force_ratio(1.0, 0.01), Slip::Sliding { creep: 0.01, gradient: 0.01 });
        assert_eq!(at_creep(0.01, 0.01), Slip::Sliding { creep: 0.01, gradient: 0.01 });
        assert_eq!(at_creep(0.03, 0.01), Slip::Sliding { creep: 0.03, gradient: 0.01 });
        assert_eq!(at_creep(0.005, 0.01), Slip::Partial { fraction: 0.5, prefactor: 0.01 });
    }
}
