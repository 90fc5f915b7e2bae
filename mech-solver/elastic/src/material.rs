//! Elastic constants of a body.

/// Elastic constants of one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Young's modulus E [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio ν [-].
    pub poisson_ratio: f64,
}

impl Material {
    /// Plane-strain compliance (1 − ν²)/E [1/Pa].
    #[must_use]
    pub fn compliance(&self) -> f64 {
        (1.0 - self.poisson_ratio.powi(2)) / self.youngs_modulus
    }

    /// Shear modulus E/(2(1 + ν)) [Pa].
    #[must_use]
    pub fn shear_modulus(&self) -> f64 {
        0.5 * self.youngs_modulus / (1.0 + self.poisson_ratio)
    }
}
