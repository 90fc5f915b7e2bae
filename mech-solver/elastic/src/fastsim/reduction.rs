//! Kalker's reduction factor: a creep curve with a lower slope at small creepage than smooth
//! elastic bodies have, and with slower saturation.
//!
//! All flexibilities are divided by
//!
//! k = k_0 (α + (1 − α)/(1 + β ε)),  ε = k_0 · G π a b C11 |w|/(4 f N),
//!
//! where k_0 is the factor at vanishing creepage, α the factor at large creepage over k_0, and ε
//! Polach's gradient of the tangential stress, a measure of the area of slip over the area of
//! adhesion. w is the creepage, with the spin at the leading edge where it adds to the lateral
//! creepage: |w|² = ξ² + ν², with ν the larger in magnitude of η and η + a φ.
//!
//! ε k rises with the creepage for every k_0, α > 0 and β, hence also the force.
//!
//! Source: Spiryagin, Polach, Cole, Creep force modelling for rail traction vehicles based on the
//! Fastsim algorithm, Vehicle System Dynamics 51 (2013) 1765–1783; ν as in CONTACT r2707.

use super::flexibility::Creepage;

/// Reduction of the slope of a creep curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reduction {
    /// Factor k_0 at vanishing creepage [-].
    factor: f64,
    /// Factor α at large creepage, over k_0 [-].
    ratio: f64,
    /// Decrease β of the factor with ε [-].
    decrease: f64,
}

impl Reduction {
    /// No reduction: smooth elastic bodies.
    pub const NONE: Self = Self { factor: 1.0, ratio: 1.0, decrease: 0.0 };

    /// Creates a reduction from the factor k_0 at small creepage and the parameters α and β of its
    /// decrease [-].
    #[must_use]
    pub fn new(factor: f64, ratio: f64, decrease: f64) -> Self {
        Self { factor, ratio, decrease }
    }

    /// Factor k at a creepage, with the semi-axis a [m]; ε/k_0 is `gradient` times |w|.
    pub fn at(&self, creepage: Creepage, semi_axis_a: f64, gradient: f64) -> f64 {
        let [xi, eta, phi] = creepage;
        let front = eta + semi_axis_a * phi;
        let lateral = if front.abs() < eta.abs() { eta } else { front };
        let slip = self.decrease * self.factor * gradient * xi.hypot(lateral);
        self.factor * (self.ratio + (1.0 - self.ratio) / (1.0 + slip))
    }

    /// The ξ > 0 at which k ξ = `value`. With s = β k_0 times the gradient it is the positive root
    /// of α k_0 s ξ² + (k_0 − s·value) ξ − value = 0.
    pub fn unreduced(&self, value: f64, gradient: f64) -> f64 {
        let Self { factor, ratio, decrease } = *self;
        let slip = decrease * factor * gradient;
        let linear = factor - slip * value;
        let square = ratio * factor * slip;
        let root = (linear * linear + 4.0 * square * value).sqrt();
        if linear > 0.0 { 2.0 * value / (linear + root) } else { (root - linear) / (2.0 * square) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRADIENT: f64 = 2e3;

    /// Limits of the factor, and the effect of spin.
    #[test]
    fn factor_between_its_limits() {
        let reduction = Reduction { factor: 0.54, ratio: 0.02, decrease: 0.62 };
        let at = |xi, eta, phi| reduction.at([xi, eta, phi], 1e-2, GRADIENT);
        assert_eq!(at(0.0, 0.0, 0.0), 0.54);
        assert!((at(1e9, 0.0, 0.0) / (0.54 * 0.02) - 1.0).abs() < 1e-9);
        // A creepage of 1e-3 has ε = 1.08: 0.54 (0.02 + 0.98/(1 + 0.62·1.08)).
        let expected = 0.54 * (0.02 + 0.98 / 1.6696);
        for value in
            [at(-1e-3, 0.0, 0.0), at(0.0, 1e-3, 0.0), at(0.0, 0.0, -0.1), at(0.0, 1e-3, -0.1)]
        {
            assert!((value - expected).abs() < 1e-15, "{value}");
        }
        assert_eq!(Reduction::NONE.at([1.0, 2.0, 3.0], 1e-2, GRADIENT), 1.0);
    }

    /// Tolerance: rounding.
    #[test]
    fn creepage_of_a_reduced_one() {
        for (factor, ratio, decrease) in [
            (1.0, 1.0, 0.0),
            (0.5, 1.0, 7.0),
            (0.54, 0.02, 0.62),
            (0.9, 1e-6, 50.0),
            (0.3, 0.2, 0.0),
        ] {
            let reduction = Reduction { factor, ratio, decrease };
            for value in [1e-9, 1e-3, 0.1, 3.0] {
                let creep = reduction.unreduced(value, GRADIENT);
                let reduced = creep * reduction.at([-creep, 0.0, 0.0], 1e-2, GRADIENT);
                assert!((reduced / value - 1.0).abs() < 1e-12, "{reduction:?} {value}: {creep}");
            }
        }
    }
}
