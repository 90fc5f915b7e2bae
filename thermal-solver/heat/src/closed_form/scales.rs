//! Scales of the flash temperature: equations 1, 2 and 6, and the rise of a body at rest.

use std::f64::consts::FRAC_PI_4;

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

    #[test]
    fn penetration_depth_of_tables_1_and_2() {
        let pe = peclet(38.889, 7.98e-3, DIFFUSIVITY);
        let delta = penetration_depth(7.98e-3, pe);
        // The reference has three figures: 78.9 micrometres.
        assert!((delta - 78.9e-6).abs() < 0.05e-6, "{delta}");
    }
}
