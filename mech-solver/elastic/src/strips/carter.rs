//! Carter's traction, slip and friction power along a strip ([`crate::carter`]), as
//! integrals.
//!
//! Over u = 1 + X from the trailing edge, with the slipping fraction m and k = 1 − m:
//!
//! - slip √((2 − u)(2m − u)): H(2m) − H(2m − u), H(d) = k²/4 (sinh 2t − 2t), cosh t = 1 + d/k;
//! - traction: the segment of the half ellipse in the slip zone. In the stick zone, the difference
//!   of two half ellipses, with the leading terms subtracted analytically to keep the relative
//!   accuracy for any size of the slip zone;
//! - friction power, in the slip zone u ∈ [0, 2m]: (2 − u) √(u(2m − u)), in units of
//!   f p_0 √(1 − y²/b²) and V A. With u = m(1 + τ) its integral from the trailing edge is
//!   m² [(2 − m)(½(τ√(1 − τ²) + asin τ) + π/4) + m/3 (1 − τ²)^{3/2}], in total π/2 m²(2 − m).

use super::StripDensity;
use super::semi_ellipse::{segment_area, sine_remainder};
use crate::carter;

/// Carter's traction along a strip, over f p_0 √(1 − y²/b²).
pub struct CarterTraction {
    /// Fraction m of the strip that slips, in (0, 1).
    fraction: f64,
    /// Integral over the slip zone, less the stick zone's antiderivative at its border.
    offset: f64,
}

impl CarterTraction {
    /// Creates the density for the slipping fraction m of the strip, in (0, 1).
    pub fn new(fraction: f64) -> Self {
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
pub struct CarterSlip {
    /// Fraction m of the strip that slips, in (0, 1).
    fraction: f64,
    /// Integral H(2m) over the whole strip.
    total: f64,
}

impl CarterSlip {
    /// Creates the density for the slipping fraction m of the strip, in (0, 1).
    pub fn new(fraction: f64) -> Self {
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

/// H(d): integral of the slip from the border of the stick zone, of half length k, over the length
/// d behind it.
fn slip_from_border(d: f64, k: f64) -> f64 {
    let root = (d * (d + 2.0 * k)).sqrt();
    let t = ((d + root) / k).ln_1p();
    if t < 0.5 {
        let double = 2.0 * t;
        return 0.25 * k * k * double.powi(3) * sine_remainder(double * double);
    }
    0.5 * ((d + k) * root - k * k * t)
}

/// Friction power of a strip with a stick zone.
pub struct CarterPower {
    /// Fraction m of the strip that slips, in (0, 1).
    pub fraction: f64,
}

impl StripDensity for CarterPower {
    fn cumulative(&self, u: f64) -> f64 {
        let m = self.fraction;
        let v = (u / m).min(2.0);
        let root = (v * (2.0 - v)).sqrt();
        m * m * ((2.0 - m) * segment_area(v) + m / 3.0 * root.powi(3))
    }

    fn kink(&self) -> Option<f64> {
        Some((2.0 * self.fraction - 1.0).abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::quadrature::simpson;

    /// The integrals agree with quadrature of their closed-form integrands. Tolerance: Simpson's
    /// rule, relative to the whole strip.
    #[test]
    fn integrals_of_the_closed_forms() {
        for m in [1e-3, 0.1, 0.5, 0.8, 0.99, 1.0 - 1e-9] {
            let (traction, slip) = (CarterTraction::new(m), CarterSlip::new(m));
            for from in [0.0, 0.3, 0.9] {
                let (start, border) = (from * 2.0 * m, 2.0 * m);
                let expected = simpson(start, border, |u| carter::slip_shape(u - 1.0, m));
                let value = slip.cumulative(border) - slip.cumulative(start);
                assert!((value - expected).abs() < 1e-9 * slip.total, "slip {m} {from}");

                let expected = simpson(start, border, |u| carter::traction_shape(u - 1.0, m));
                let value = traction.cumulative(border) - traction.cumulative(start);
                let whole = traction.cumulative(2.0);
                assert!((value - expected).abs() < 1e-9 * whole, "traction, slip zone {m} {from}");

                let start = border + from * (2.0 - border);
                let expected = simpson(start, 2.0, |u| carter::traction_shape(u - 1.0, m));
                let value = traction.cumulative(2.0) - traction.cumulative(start);
                assert!((value - expected).abs() < 1e-9 * whole, "traction, stick zone {m} {from}");
            }
        }
    }

    /// Tolerance: rounding, magnified by 1/√m through the slip zone's small share of the force.
    #[test]
    fn force_of_a_strip() {
        for m in [1e-12f64, 1e-9, 1e-3, 0.1, 0.5, 0.8, 0.99, 1.0 - 1e-9, 1.0 - 1e-15] {
            let expected = std::f64::consts::FRAC_PI_2 * carter::force_ratio(m);
            let value = CarterTraction::new(m).cumulative(2.0);
            assert!((value / expected - 1.0).abs() < 1e-15 / m.sqrt() + 1e-15, "{m}: {value}");
        }
    }
}
