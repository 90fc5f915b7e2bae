//! The half ellipse √(u(2 − u)) along a strip, and the series that keep its integral and the
//! integral of the slip accurate near an end.

use super::StripDensity;
use std::f64::consts::FRAC_PI_2;

/// g(u) = √(u(2 − u)) = √(1 − X²): Hertz's pressure along a strip.
pub struct SemiEllipse;

impl StripDensity for SemiEllipse {
    fn cumulative(&self, u: f64) -> f64 {
        segment_area(u)
    }
}

/// ∫₀^u √(v(2 − v)) dv for u in [0, 2]: half a segment of the unit circle, with full relative
/// accuracy near u = 0.
///
/// With the angle φ = 2 asin √(u/2) it is (2φ − sin 2φ)/4.
pub fn segment_area(u: f64) -> f64 {
    if u > 1.0 {
        return FRAC_PI_2 - segment_area(2.0 - u);
    }
    let angle = 2.0 * (0.5 * u).sqrt().asin();
    if angle < 0.5 {
        let double = 2.0 * angle;
        return 0.25 * double.powi(3) * sine_remainder(-double * double);
    }
    0.5 * (angle - (1.0 - u) * (u * (2.0 - u)).sqrt())
}

/// Σ_{n≥0} zⁿ/(2n + 3)!, |z| ≤ 1: (x − sin x)/x³ for z = −x² and (sinh x − x)/x³ for z = x².
pub fn sine_remainder(z: f64) -> f64 {
    // Quotients (2n + 2)(2n + 3) of successive terms; the omitted term is below 1e-17.
    const QUOTIENTS: [f64; 7] = [272.0, 210.0, 156.0, 110.0, 72.0, 42.0, 20.0];
    QUOTIENTS.iter().fold(1.0, |sum, quotient| 1.0 + sum * z / quotient) / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tolerance: rounding.
    #[test]
    fn series_meets_the_functions() {
        for x in [0.9f64, 1.0] {
            assert!((sine_remainder(-x * x) * x.powi(3) / (x - x.sin()) - 1.0).abs() < 5e-15);
            assert!((sine_remainder(x * x) * x.powi(3) / (x.sinh() - x) - 1.0).abs() < 5e-15);
        }
    }

    /// Near an end the area is 2/3 √2 u^{3/2}(1 − 3u/20 − …); tolerance: the next term.
    #[test]
    fn segment_area_at_both_ends() {
        for u in [1e-12f64, 1e-6, 1e-4] {
            let expected = 2.0 / 3.0 * 2f64.sqrt() * u.powf(1.5) * (1.0 - 0.15 * u);
            assert!((segment_area(u) / expected - 1.0).abs() < 4e-15 + u * u);
        }
        assert_eq!(segment_area(0.0), 0.0);
        assert_eq!(segment_area(2.0), FRAC_PI_2);
        assert!((segment_area(1.0) - 0.5 * FRAC_PI_2).abs() < 4e-16);
    }
}
