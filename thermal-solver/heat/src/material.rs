//! Material of a body.

/// Thermal properties of a body, constant over temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Density ρ [kg/m³].
    pub density: f64,
    /// Specific heat c [J/(kg·K)].
    pub specific_heat: f64,
    /// Conductivity λ [W/(m·K)].
    pub conductivity: f64,
}

impl Material {
    /// Returns the diffusivity κ = λ/(ρc) [m²/s].
    #[must_use]
    pub fn diffusivity(&self) -> f64 {
        self.conductivity / (self.density * self.specific_heat)
    }

    /// Returns the effusivity β = √(λρc) [J/(m²·K·√s)], see [`crate::closed_form::scales`].
    #[must_use]
    pub fn effusivity(&self) -> f64 {
        (self.conductivity * self.density * self.specific_heat).sqrt()
    }
}
