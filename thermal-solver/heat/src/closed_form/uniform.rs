//! Uniform heat flux: constant in time (Jaeger), and over the contact in steady motion, in depth
//! (equations 13–15).
//!
//! Equations 13 and 14 in the form T = q/β · √(2a/V) · {i(ξ+1) − i(ξ−1)} with i(u) = √(2u/π)
//! exp(−ζ²/(2u)) − ζ erfc(ζ/√(2u)) for u > 0 and 0 otherwise. This form joins both equations:
//! inside the contact the second term is zero. ξ runs with the material from the leading edge −1;
//! ζ = z/δ. The speed is the body's own; the text prints V_w for both.

use std::f64::consts::PI;

/// Returns the surface temperature rise 2 q √(t/π)/β [K] of a half-space after a time t [s] under a
/// constant heat flux q [W/m²], with effusivity β [J/(m²·K·√s)] (Carslaw & Jaeger, 2.9).
#[must_use]
pub fn jaeger(heat_flux: f64, effusivity: f64, time: f64) -> f64 {
    2.0 * heat_flux * (time / PI).sqrt() / effusivity
}

/// Returns the braces of equations 13 and 14 [-] at ξ and depth ζ ≥ 0.
#[must_use]
pub fn in_depth(xi: f64, zeta: f64) -> f64 {
    let term = |u: f64| {
        if u <= 0.0 {
            return 0.0;
        }
        let root = (2.0 * u).sqrt();
        root / PI.sqrt() * (-zeta * zeta / (2.0 * u)).exp() - zeta * libm::erfc(zeta / root)
    };
    term(xi + 1.0) - term(xi - 1.0)
}

/// Returns the temperature rise [K] at (ξ, ζ) under a heat flux q [W/m²] into the body over a
/// contact of semi-axis a [m], at a speed V [m/s], with effusivity β: equations 13 and 14.
#[must_use]
pub fn rise(
    heat_flux: f64,
    semi_axis: f64,
    effusivity: f64,
    speed: f64,
    xi: f64,
    zeta: f64,
) -> f64 {
    heat_flux / effusivity * (2.0 * semi_axis / speed).sqrt() * in_depth(xi, zeta)
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::quadrature::integrate;

    #[test]
    fn surface_is_jaegers() {
        // On the surface the material at ξ has been heated for a(1 + ξ)/V.
        let (q, a, beta, v) = (3e6, 8e-3, 12_832.0, 40.0);
        for xi in [-0.5, 0.0, 0.9] {
            let expected = jaeger(q, beta, a * (1.0 + xi) / v);
            assert!((rise(q, a, beta, v, xi, 0.0) / expected - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn depth_agrees_with_the_quadrature_of_equation_8() {
        for (xi, zeta) in [(0.3, 0.5), (0.9, 1.5), (1.5, 0.7), (4.0, 2.0)] {
            let (low, high) = (f64::max(xi - 1.0, 0.0).sqrt(), (xi + 1.0_f64).sqrt());
            let panels = 200;
            let step = (high - low) / f64::from(panels);
            let integral: f64 = (0..panels)
                .map(|i| {
                    let from = low + step * f64::from(i);
                    integrate(from, from + step, |u| 2.0 * (-zeta * zeta / (2.0 * u * u)).exp())
                })
                .sum();
            // Kernel 1/√π against the factor √2 taken out in equation 13; tolerance: rounding.
            let expected = integral / (2.0 * PI).sqrt();
            assert!((in_depth(xi, zeta) - expected).abs() < 1e-14, "{xi} {zeta}");
        }
    }

    #[test]
    fn no_rise_ahead_of_the_contact() {
        assert_eq!(in_depth(-1.0, 0.0), 0.0);
        assert_eq!(in_depth(-3.0, 0.5), 0.0);
    }
}
