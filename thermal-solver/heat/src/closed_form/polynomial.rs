//! Polynomial approximation of the elliptic heat flux: equations 9 to 12, and in depth.
//!
//! The flux f(ξ) = π/2048 · (645 − 210ξ² − 315ξ⁴) has the zeroth and second moments of √(1 − ξ²),
//! π/2 and π/8. The surface temperature is T = ε q₀/β · √(a/(πV)) · F(ξ) with
//!
//! - ahead (ξ ≤ −1): F = 0;
//! - inside (−1 < ξ ≤ 1): F = π/128 · √(ξ+1) · (71 + 12ξ − 20ξ² + 8ξ³ − 16ξ⁴);
//! - behind (ξ > 1): the same minus π/128 · √(ξ−1) · (71 − 12ξ − 20ξ² − 8ξ³ − 16ξ⁴).
//!
//! The paper prints both terms for the inside, where √(ξ−1) is not real, and one for the outside.
//!
//! In depth F(ξ, ζ) = ∫ f(ξ') exp(−ζ²/(2(ξ−ξ'))) dξ'/√(ξ−ξ') (equation 8). With s = ξ − ξ' the
//! flux is a polynomial in s, and with c = ζ/√2 the moments J_p(s) = ∫₀ˢ σ^(p−½) e^(−c²/σ) dσ are
//!
//! J₀ = 2√s e^(−c²/s) − 2c√π erfc(c/√s),  J_p = (s^(p+½) e^(−c²/s) − c² J_(p−1))/(p + ½).
//!
//! Behind the contact the closed forms are small differences of terms that grow like ξ^(9/2). From
//! ξ = 3 on they are replaced by Gauss quadrature of the integrand, which is smooth there.

use numerics::quadrature::integrate;
use numerics::search::maximum;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Place ξ from which quadrature replaces the difference of closed forms.
const FAR: f64 = 3.0;

/// Returns the heat flux f(ξ) [-] inside the contact, 0 outside: equation 9.
#[must_use]
pub fn flux(xi: f64) -> f64 {
    if xi.abs() > 1.0 {
        return 0.0;
    }
    let square = xi * xi;
    PI / 2048.0 * (645.0 - 210.0 * square - 315.0 * square * square)
}

/// Returns F(ξ) [-] on the surface: equations 11 and 12 with corrected labels.
#[must_use]
pub fn surface(xi: f64) -> f64 {
    let term = |sign: f64| {
        let polynomial = 71.0 + xi * (sign * 12.0 + xi * (-20.0 + xi * (sign * 8.0 - 16.0 * xi)));
        PI / 128.0 * (xi + sign).sqrt() * polynomial
    };
    if xi <= -1.0 {
        0.0
    } else if xi <= 1.0 {
        term(1.0)
    } else if xi < FAR {
        term(1.0) - term(-1.0)
    } else {
        far(xi, 0.0)
    }
}

/// Returns F(ξ, ζ) [-] at a depth ζ = z/δ ≥ 0, with an absolute error below 1e-12.
#[must_use]
pub fn in_depth(xi: f64, zeta: f64) -> f64 {
    if zeta == 0.0 {
        surface(xi)
    } else if xi <= -1.0 {
        0.0
    } else if xi < FAR {
        let c = zeta / 2_f64.sqrt();
        let upper = moments(xi + 1.0, c);
        let lower = if xi > 1.0 { moments(xi - 1.0, c) } else { [0.0; 5] };
        let powers = powers_of_distance(xi);
        (0..5).map(|p| powers[p] * (upper[p] - lower[p])).sum()
    } else {
        far(xi, zeta)
    }
}

/// Returns the temperature rise [K] on the surface at ξ: equation 10. `heat_flux` is q₀ = ε f V_s
/// p₀ [W/m²] into the body; `speed` is V, the body's own surface speed [m/s] (equations 6 and 8).
#[must_use]
pub fn rise(heat_flux: f64, semi_axis: f64, effusivity: f64, speed: f64, xi: f64) -> f64 {
    heat_flux / effusivity * (semi_axis / (PI * speed)).sqrt() * surface(xi)
}

/// Returns the position ξ = 0.647 and the value 2.197 of the maximum of F.
#[must_use]
pub fn peak() -> (f64, f64) {
    static PEAK: LazyLock<(f64, f64)> = LazyLock::new(|| maximum(0.5, 0.8, surface));
    *PEAK
}

fn far(xi: f64, zeta: f64) -> f64 {
    integrate(-1.0, 1.0, |at| {
        let s = xi - at;
        flux(at) * (-zeta * zeta / (2.0 * s)).exp() / s.sqrt()
    })
}

/// Returns the coefficients of s⁰ to s⁴ in f(ξ − s).
fn powers_of_distance(xi: f64) -> [f64; 5] {
    let square = xi * xi;
    [
        645.0 - 210.0 * square - 315.0 * square * square,
        xi * (420.0 + 1260.0 * square),
        -210.0 - 1890.0 * square,
        1260.0 * xi,
        -315.0,
    ]
    .map(|coefficient| PI / 2048.0 * coefficient)
}

/// Returns J₀ to J₄ for s > 0 and c > 0.
fn moments(s: f64, c: f64) -> [f64; 5] {
    let root = s.sqrt();
    let decay = (-c * c / s).exp();
    let mut all = [2.0 * root * decay - 2.0 * c * PI.sqrt() * libm::erfc(c / root); 5];
    let mut power = root;
    for p in 1..5 {
        power *= s;
        all[p] = (power * decay - c * c * all[p - 1]) / (p as f64 + 0.5);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed_form::scales;

    /// Equation 8 by quadrature in u = √(ξ − ξ'), in which the integrand is smooth.
    fn by_quadrature(xi: f64, zeta: f64) -> f64 {
        let (low, high) = (f64::max(xi - 1.0, 0.0).sqrt(), (xi + 1.0).sqrt());
        let panels = 100;
        let step = (high - low) / f64::from(panels);
        let panel = |i: i32| {
            let from = low + step * f64::from(i);
            integrate(from, from + step, |u| {
                2.0 * flux((xi - u * u).clamp(-1.0, 1.0)) * (-zeta * zeta / (2.0 * u * u)).exp()
            })
        };
        (0..panels).map(panel).sum()
    }

    #[test]
    fn moments_of_the_flux_are_those_of_the_ellipse() {
        // Tolerance: rounding; the rule is exact.
        assert!((integrate(-1.0, 1.0, flux) - PI / 2.0).abs() < 1e-14);
        assert!((integrate(-1.0, 1.0, |xi| xi * xi * flux(xi)) - PI / 8.0).abs() < 1e-14);
    }

    #[test]
    fn corrected_labels_agree_with_the_quadrature_of_equation_9() {
        let known =
            [(-0.5, 1.00659), (0.0, 1.74260), (0.647, 2.19716), (1.2, 1.56669), (5.0, 0.70515)];
        for (xi, value) in known {
            // The table has five decimals; the quadrature itself is exact to rounding.
            assert!((surface(xi) - value).abs() < 5.1e-6, "F({xi}) = {}", surface(xi));
            assert!((surface(xi) - by_quadrature(xi, 0.0)).abs() < 1e-12, "{xi}");
        }
    }

    #[test]
    fn printed_labels_do_not() {
        // Printed for ξ > 1: only the first root, which changes its sign.
        let printed = |xi: f64| {
            let polynomial = 71.0 + 12.0 * xi - 20.0 * xi * xi + 8.0 * xi.powi(3);
            PI / 128.0 * (xi + 1.0).sqrt() * (polynomial - 16.0 * xi.powi(4))
        };
        assert!((printed(1.2) - by_quadrature(1.2, 0.0)).abs() > 0.2);
        assert!(printed(5.0) < -100.0);
        // Printed for −1 < ξ < 1: the root of a negative number.
        assert!((0.5_f64 - 1.0).sqrt().is_nan() && surface(0.5).is_finite());
        // Printed for ξ < −1: also the root of a negative number; the rise there is zero.
        assert_eq!(surface(-1.2), 0.0);
    }

    #[test]
    fn depth_agrees_with_quadrature() {
        for xi in [-0.9, -0.2, 0.647, 1.0, 1.3, 2.9, 3.1, 40.0] {
            for zeta in [0.0, 0.1, 0.8, 2.0, 5.0] {
                let (got, expected) = (in_depth(xi, zeta), by_quadrature(xi, zeta));
                // Tolerance: the stated absolute error.
                assert!((got - expected).abs() < 1e-12, "{xi} {zeta}: {got} {expected}");
            }
        }
    }

    #[test]
    fn table_4_with_the_papers_own_inputs() {
        let (a, p0, friction) = (7.98e-3, 1352e6, 0.6);
        let (rail_speed, sliding) = (38.889, 0.012 * 38.889);
        let beta = scales::effusivity(50.0, 7850.0, 419.5);
        let heat_flux = 0.5 * friction * sliding * p0;
        let (xi, _) = peak();
        let rail = rise(heat_flux, a, beta, rail_speed, xi);
        // References have four figures: 261.9 K at 0.647 (the paper prints 287 degrees at 0.64).
        assert!((rail - 261.9).abs() < 0.05 && (xi - 0.647).abs() < 5e-4, "{rail} {xi}");
        // The wheel passes faster by the sliding speed and stays cooler by half the creepage. The
        // wheel's speed for the rail, as printed, would give 260.4 K for the rail.
        let wheel = rise(heat_flux, a, beta, rail_speed + sliding, xi);
        assert!((wheel / rail - 1.012_f64.powf(-0.5)).abs() < 1e-15);
        assert!((wheel - 261.9).abs() > 1.0);
    }
}
