//! Elastic constants of a pair of bodies.

use crate::Material;

/// Elastic constants of a pair of half-spaces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Elasticity {
    /// Mean shear compliance 1/G = ½(1/G₁ + 1/G₂) [1/Pa].
    pub shear_compliance: f64,
    /// Poisson's part ν/G = ½(ν₁/G₁ + ν₂/G₂) [1/Pa].
    pub poisson_compliance: f64,
    /// Coupling K/G = ¼((1 − 2ν₁)/G₁ − (1 − 2ν₂)/G₂) of normal and tangential displacement
    /// [1/Pa]; zero for bodies of the same material.
    pub coupling_compliance: f64,
}

impl Elasticity {
    /// Constants of body 1 on body 2.
    #[must_use]
    pub fn of_pair(body_1: &Material, body_2: &Material) -> Self {
        let shear = |body: &Material| 2.0 * (1.0 + body.poisson_ratio) / body.youngs_modulus;
        let dilation = |body: &Material| (1.0 - 2.0 * body.poisson_ratio) * shear(body);
        let poisson = |body: &Material| body.poisson_ratio * shear(body);
        Self {
            shear_compliance: 0.5 * (shear(body_1) + shear(body_2)),
            poisson_compliance: 0.5 * (poisson(body_1) + poisson(body_2)),
            coupling_compliance: 0.25 * (dilation(body_1) - dilation(body_2)),
        }
    }

    /// Constants of each body with the other rigid: body 1, and body 2 below it.
    #[must_use]
    pub fn of_bodies(bodies: &[Material; 2]) -> [Self; 2] {
        let rigid = Material { youngs_modulus: f64::INFINITY, poisson_ratio: 0.0 };
        [Self::of_pair(&bodies[0], &rigid), Self::of_pair(&rigid, &bodies[1])]
    }

    /// Returns the compliances times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            shear_compliance: factor * self.shear_compliance,
            poisson_compliance: factor * self.poisson_compliance,
            coupling_compliance: factor * self.coupling_compliance,
        }
    }

    /// Returns the sum of both compliances.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            shear_compliance: self.shear_compliance + other.shear_compliance,
            poisson_compliance: self.poisson_compliance + other.poisson_compliance,
            coupling_compliance: self.coupling_compliance + other.coupling_compliance,
        }
    }

    /// Normal compliance (1 − ν)/G = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂ [1/Pa].
    #[must_use]
    pub fn contact_compliance(&self) -> f64 {
        self.shear_compliance - self.poisson_compliance
    }

    /// Returns true if normal and tangential displacements are coupled.
    #[must_use]
    pub fn is_coupled(&self) -> bool {
        self.coupling_compliance != 0.0
    }
}
