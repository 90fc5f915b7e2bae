//! Scales of the flash temperature: equations 1, 2 and 6, and the rise of a body at rest.

use numerics::quadrature::integrate;
use std::f64::consts::{FRAC_2_SQRT_PI, FRAC_PI_2, FRAC_PI_4};

/// Returns the effusivity β = √(λρc) = λ/√κ [J/(m²·K·√s)] from a conductivity λ [W/(m·K)], a
/// density ρ [kg/m³] and a specific heat c [J/(kg·K)]: equation 6, printed as λ/κ.
#[must_use]
pub fn effusivity(conductivity: f64, density: f64, specific_heat: f64) -> f64 {
    (conductivity * density * specific_heat).sqrt()
}

/// Returns the Péclet number Pe = V a/(2κ) [-] from a speed V [m/s], a semi-axis a [m] and a
/// diffusivity κ [m²/s]: equation 2, with the factor 2.
#[must_use]
pub fn peclet(speed: f64, semi_axis: f64, diffusivity: f64) -> f64 {
    semi_axis * speed / (2.0 * diffusivity)
}

/// Returns the thermal penetration depth δ = a/√Pe [m]: equation 1.
#[must_use]
pub fn penetration_depth(semi_axis: f64, peclet: f64) -> f64 {
    semi_axis / peclet.sqrt()
}

/// Returns the rise at the centre of an ellipse with the semi-axes a and b [m] under the flux q₀
/// √(1 − x²/a² − y²/b²), steady and at rest, over q₀/λ \[m\].
///
/// T = (q₀/2πλ) ∬ √(…)/r dA = (q₀/8λ) ∮ R(φ) dφ = (q₀ b/2λ) K(k) with k² = 1 − b²/a², b the smaller
/// semi-axis. With the arithmetic–geometric mean M, K = π/(2 M(1, b/a)), the length is (π/4) a
/// b/M(a, b), and (π/4) a for a circle.
#[must_use]
pub fn rest_length([a, b]: [f64; 2]) -> f64 {
    let (mut arithmetic, mut geometric) = (a, b);
    // Each step doubles the digits, so any two axes converge to rounding.
    for _ in 0..MOST_MEANS {
        if (arithmetic - geometric).abs() <= 1e-15 * arithmetic {
            break;
        }
        (arithmetic, geometric) =
            (0.5 * (arithmetic + geometric), arithmetic.sqrt() * geometric.sqrt());
    }
    FRAC_PI_4 * a * (b / arithmetic)
}

/// Steps of the arithmetic–geometric mean; ten suffice for axes of 1 to 10¹⁰⁰.
const MOST_MEANS: usize = 20;

/// Returns the rise at the centre of a resting ellipse with the semi-axes a and b [m], over q₀/λ
/// \[m\], as [`rest_length`] but a time t after the flux q₀ √(1 − x²/a² − y²/b²) began; `spread` is
/// √(4κt) [m].
///
/// T = (q₀/2πλ) ∬ √(…)/r erfc(r/√(4κt)) dA = (q₀/2πλ) ∮ R F(√(4κt)/R) dφ with the radius R(φ) of
/// the ellipse. F(u) = ∫₀¹ √(1 − s²) erfc(s/u) ds grows from u/√π, conduction normal to the
/// surface, to π/4, the steady rise.
#[must_use]
pub fn rest_length_after([a, b]: [f64; 2], spread: f64) -> f64 {
    let (short, long) = (a.min(b), a.max(b));
    let radius = |angle: f64| {
        let (sine, cosine) = angle.sin_cos();
        short / (cosine * short / long).hypot(sine)
    };
    let of = |radius: f64| radius * risen(spread / radius);
    // The trapezoidal rule converges geometrically for periodic functions.
    let step = FRAC_PI_2 / DIRECTIONS as f64;
    let inner: f64 = (1..DIRECTIONS).map(|at| of(radius(at as f64 * step))).sum();
    (inner + 0.5 * (of(short) + of(long))) / DIRECTIONS as f64
}

/// Directions within a quarter of an ellipse.
const DIRECTIONS: usize = 128;
/// Argument from which on exp(−x²) is below rounding.
const FAR: f64 = 6.0;
/// Panels of the integral over exp(−x²), of one and a half at most: exact to rounding.
const PANELS: u32 = 4;

/// Returns ∫₀¹ √(1 − s²) erfc(s/u) ds, integrated by parts.
fn risen(u: f64) -> f64 {
    if u == f64::INFINITY {
        return FRAC_PI_4;
    }
    let end = 1.0 / u;
    // The integral of √(1 − s²) from 0.
    let area = |s: f64| 0.5 * (s * (1.0 - s * s).max(0.0).sqrt() + s.min(1.0).asin());
    let panel = end.min(FAR) / f64::from(PANELS);
    let inside: f64 = (0..PANELS)
        .map(|k| f64::from(k) * panel)
        .map(|from| integrate(from, from + panel, |x| area(u * x) * (-x * x).exp()))
        .sum();
    FRAC_PI_4 * libm::erfc(end) + FRAC_2_SQRT_PI * inside
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIFFUSIVITY: f64 = 50.0 / (7850.0 * 419.5);

    #[test]
    fn effusivity_of_table_1_is_not_the_printed_quotient() {
        let beta = effusivity(50.0, 7850.0, 419.5);
        // The reference has five figures.
        assert!((beta - 12_832.0).abs() < 0.5, "{beta}");
        // β equals λ/√κ to rounding, far from λ/κ.
        assert!((beta / (50.0 / DIFFUSIVITY.sqrt()) - 1.0).abs() < 1e-15);
        assert!(50.0 / DIFFUSIVITY > 100.0 * beta);
    }

    /// Tested with a circle, the paper's ellipse by an independent quadrature, and a long ellipse,
    /// K(k) → ln(4a/b).
    #[test]
    fn ellipses_at_rest() {
        assert!((rest_length([2.0, 2.0]) / (2.0 * FRAC_PI_4) - 1.0).abs() < 1e-15);
        // The reference has six figures.
        assert!((rest_length([7.98, 6.01]) / 7.98 - 0.678_185).abs() < 5e-7);
        assert!((rest_length([6.01, 7.98]) / rest_length([7.98, 6.01]) - 1.0).abs() < 1e-15);
        let long = rest_length([1.0, 1e-4]) / (0.5e-4 * 4e4_f64.ln());
        // The relative size of the next term is (b/a)².
        assert!((long - 1.0).abs() < 1e-7, "{long}");
    }

    /// Early, conduction normal to the surface, 2q₀√(κt/π)/λ, less u²/6 of it on a circle; late,
    /// the steady rise. In between, Gauss's rule for the integral over the radius.
    #[test]
    fn ellipses_at_rest_in_time() {
        for axes in [[2.0, 2.0], [7.98, 6.01], [1.0, 0.05], [0.05, 1.0]] {
            let early = rest_length_after(axes, 1e-6) / (1e-6 / std::f64::consts::PI.sqrt());
            assert!((early - 1.0).abs() < 1e-9, "{axes:?} {early}");
            // The deviation from the steady rise falls as the radius over the spread.
            let late = rest_length_after(axes, 1e9) / rest_length(axes);
            assert!((late - 1.0).abs() < 1e-7, "{axes:?} {late}");
        }
        let part = 1.0 - rest_length_after([1.0, 1.0], 0.1) * std::f64::consts::PI.sqrt() / 0.1;
        // The next term is of fourth order.
        assert!((part / (0.01 / 6.0) - 1.0).abs() < 0.01, "{part}");
        let direct =
            |u: f64| integrate(0.0, FRAC_PI_2, |t| t.cos().powi(2) * libm::erfc(t.sin() / u));
        for u in [0.3, 1.0, 5.0] {
            let found = rest_length_after([1.0, 1.0], u);
            assert!((found / direct(u) - 1.0).abs() < 1e-6, "{u} {found}");
        }
    }

    #[test]
    fn penetration_depth_of_tables_1_and_2() {
        let pe = peclet(38.889, 7.98e-3, DIFFUSIVITY);
        let delta = penetration_depth(7.98e-3, pe);
        // The reference has three figures: 78.9 micrometres.
        assert!((delta - 78.9e-6).abs() < 0.05e-6, "{delta}");
    }
}
