//! Scales of the flash temperature: equations 1, 2 and 6.

/// Effusivity β = √(λρc) = λ/√κ [J/(m²·K·√s)] of a conductivity λ [W/(m·K)], a density ρ [kg/m³]
/// and a specific heat c [J/(kg·K)]: equation 6, printed as λ/κ.
#[must_use]
pub fn effusivity(conductivity: f64, density: f64, specific_heat: f64) -> f64 {
    (conductivity * density * specific_heat).sqrt()
}

/// Péclet number Pe = V a/(2κ) [-] of a speed V [m/s], a semi-axis a [m] and a diffusivity κ
/// [m²/s]: equation 2, with the factor 2.
#[must_use]
pub fn peclet(speed: f64, semi_axis: f64, diffusivity: f64) -> f64 {
    semi_axis * speed / (2.0 * diffusivity)
}

/// Thermal penetration depth δ = a/√Pe [m]: equation 1.
#[must_use]
pub fn penetration_depth(semi_axis: f64, peclet: f64) -> f64 {
    semi_axis / peclet.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIFFUSIVITY: f64 = 50.0 / (7850.0 * 419.5);

    #[test]
    fn effusivity_of_table_1_is_not_the_printed_quotient() {
        let beta = effusivity(50.0, 7850.0, 419.5);
        // Five figures are given.
        assert!((beta - 12_832.0).abs() < 0.5, "{beta}");
        // The same as lambda over the root of kappa, to rounding; far from lambda over kappa.
        assert!((beta / (50.0 / DIFFUSIVITY.sqrt()) - 1.0).abs() < 1e-15);
        assert!(50.0 / DIFFUSIVITY > 100.0 * beta);
    }

    #[test]
    fn penetration_depth_of_tables_1_and_2() {
        let pe = peclet(38.889, 7.98e-3, DIFFUSIVITY);
        let delta = penetration_depth(7.98e-3, pe);
        // Three figures are given: 78.9 micrometres.
        assert!((delta - 78.9e-6).abs() < 0.05e-6, "{delta}");
    }
}
