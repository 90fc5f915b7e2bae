//! Tangential loading of a circular Hertz contact without rolling.
//!
//! Under a tangential force F < f N the circle of radius c = a(1 − F/fN)^(1/3) sticks, and the ring
//! around it slips. The traction is the difference of two ellipsoids,
//! f p_0 [√(1 − r²/a²) − (c/a)√(1 − r²/c²)], with the second only within the stick circle. The
//! bodies shift by
//!
//! δ = 3 f N (2 − ν)/(8 a G) · [1 − (1 − F/fN)^(2/3)],
//!
//! with G and ν of the pair, 1/G = ½(1/G₁ + 1/G₂), ν/G = ½(ν₁/G₁ + ν₂/G₂).
//!
//! The slip is taken along the force everywhere; for ν ≠ 0 a small transverse part is neglected.
//! Source: Cattaneo (1938), Mindlin (1949); Johnson, *Contact Mechanics* (1985) §7.2, eqs.
//! 7.39–7.43.

use std::f64::consts::PI;

/// A circular contact under a tangential force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    /// F/(f N), in [0, 1].
    pub force_ratio: f64,
    /// Radius a of the contact [m].
    pub radius: f64,
    /// Traction bound f p_0 at the centre [Pa].
    pub bound: f64,
}

impl Shift {
    /// Radius c of the stick circle [m].
    #[must_use]
    pub fn stick_radius(&self) -> f64 {
        self.radius * (1.0 - self.force_ratio).cbrt()
    }

    /// Traction at the distance r from the centre [Pa].
    #[must_use]
    pub fn traction(&self, r: f64) -> f64 {
        let ellipsoid = |radius: f64| match r < radius {
            true => (1.0 - (r / radius).powi(2)).sqrt(),
            false => 0.0,
        };
        let stick = self.stick_radius();
        self.bound * (ellipsoid(self.radius) - stick / self.radius * ellipsoid(stick))
    }

    /// Rigid shift of the bodies [m] for the pair's shear modulus [Pa] and Poisson's ratio.
    #[must_use]
    pub fn rigid_shift(&self, shear_modulus: f64, poisson_ratio: f64) -> f64 {
        let most = 2.0 / 3.0 * PI * self.radius.powi(2) * self.bound;
        let slope = 3.0 * most * (2.0 - poisson_ratio) / (8.0 * self.radius * shear_modulus);
        slope * (1.0 - (1.0 - self.force_ratio).powf(2.0 / 3.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::quadrature::simpson;

    /// The traction carries the force. Tolerance: Simpson's rule at the roots at the ends.
    #[test]
    fn traction_carries_the_force() {
        for force_ratio in [0.1, 0.5, 0.875] {
            let shift = Shift { force_ratio, radius: 2.0, bound: 3.0 };
            let stick = shift.stick_radius();
            let ring = |r: f64| 2.0 * PI * r * shift.traction(r);
            let force = simpson(0.0, stick, ring) + simpson(stick, 2.0, ring);
            let most = 2.0 / 3.0 * PI * 4.0 * 3.0;
            assert!((force / most - force_ratio).abs() < 1e-6, "{force_ratio}: {}", force / most);
        }
    }

    /// For a small force, the stiffness of a sticking rigid punch, δ = F (2 − ν)/(4 a G).
    #[test]
    fn slope_of_a_small_force() {
        let shift = Shift { force_ratio: 1e-6, radius: 2.0, bound: 3.0 };
        let force = 1e-6 * 2.0 / 3.0 * PI * 4.0 * 3.0;
        let expected = force * 1.7 / (4.0 * 2.0 * 5.0);
        assert!((shift.rigid_shift(5.0, 0.3) / expected - 1.0).abs() < 1e-6);
    }
}
