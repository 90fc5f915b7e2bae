//! Slip of a contact, as determined by the strip models.
//!
//! Slip velocities are V · s · g(ξ), with ξ = −X = −x/a_y on every strip, from −1 at the leading to
//! +1 at the trailing edge.

use crate::carter;
use grids::Structured;

/// Rigid slip: relative motion of the bodies if they were rigid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidSlip {
    /// Longitudinal and lateral creepage [-], and spin [rad/m].
    pub creepage: [f64; 3],
    /// Rolling speed V [m/s].
    pub speed: f64,
}

impl RigidSlip {
    /// V |(ξ − φ y, η + φ x)| at an element [m/s].
    pub fn at(&self, grid: &Structured, index: usize) -> f64 {
        self.at_place([grid.x(index % grid.ni), grid.y(index / grid.ni)])
    }

    /// V |(ξ − φ y, η + φ x)| at a place [m/s].
    #[must_use]
    pub fn at_place(&self, [x, y]: [f64; 2]) -> f64 {
        let [xi, eta, phi] = self.creepage;
        self.speed * (xi - phi * y).hypot(eta + phi * x)
    }
}

/// Slip zone and slip velocity of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Slip {
    /// No slip: no tangential motion, no traction.
    Adhesion,
    /// Slip in the trailing fraction of every strip, after Carter.
    Partial {
        /// Fraction m of every strip that slips, in (0, 1) [-].
        fraction: f64,
        /// Prefactor A of the creep law [-].
        prefactor: f64,
    },
    /// Slip everywhere, s + A ξ; s ≥ A ≥ 0.
    Sliding {
        /// Mean slip s [-].
        creep: f64,
        /// Gradient A of the slip [-].
        gradient: f64,
    },
}

impl Slip {
    /// Slip at a prescribed force ratio r = |F|/(f N) in [0, 1].
    pub fn at_force_ratio(force_ratio: f64, prefactor: f64) -> Self {
        Self::at_fraction(carter::slip_fraction(force_ratio), prefactor)
    }

    /// Slip at a prescribed magnitude s of the creepage; s ≥ A is full slip, s + A ξ.
    pub fn at_creep(creep: f64, prefactor: f64) -> Self {
        if creep >= prefactor {
            Self::Sliding { creep, gradient: prefactor }
        } else {
            Self::at_fraction(creep / prefactor, prefactor)
        }
    }

    fn at_fraction(fraction: f64, prefactor: f64) -> Self {
        if fraction == 0.0 {
            Self::Adhesion
        } else if fraction < 1.0 {
            Self::Partial { fraction, prefactor }
        } else {
            Self::Sliding { creep: prefactor, gradient: prefactor }
        }
    }

    /// Share of the contact area that slips [-].
    pub fn area_ratio(&self) -> f64 {
        match *self {
            Self::Adhesion => 0.0,
            Self::Partial { fraction, .. } => fraction,
            Self::Sliding { .. } => 1.0,
        }
    }

    /// Force over friction bound, |F|/(f N) [-].
    pub fn force_ratio(&self) -> f64 {
        carter::force_ratio(self.area_ratio())
    }

    /// Magnitude of the creepage [-].
    pub fn creep(&self) -> f64 {
        match *self {
            Self::Adhesion => 0.0,
            Self::Partial { fraction, prefactor } => prefactor * fraction,
            Self::Sliding { creep, .. } => creep,
        }
    }

    /// Largest traction over f p_0 [-].
    pub fn largest_traction(&self) -> f64 {
        carter::largest_traction_shape(self.area_ratio())
    }

    /// Largest slip velocity over V [-].
    pub fn largest_velocity(&self) -> f64 {
        match *self {
            Self::Adhesion => 0.0,
            Self::Partial { fraction, prefactor } => {
                prefactor * carter::largest_slip_shape(fraction)
            }
            Self::Sliding { creep, gradient } => creep + gradient,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_of_creep_and_force() {
        assert_eq!(Slip::at_force_ratio(0.0, 0.01), Slip::Adhesion);
        assert_eq!(Slip::at_creep(0.0, 0.01), Slip::Adhesion);
        assert_eq!(Slip::at_force_ratio(1.0, 0.01), Slip::Sliding { creep: 0.01, gradient: 0.01 });
        assert_eq!(Slip::at_creep(0.01, 0.01), Slip::Sliding { creep: 0.01, gradient: 0.01 });
        assert_eq!(Slip::at_creep(0.03, 0.01), Slip::Sliding { creep: 0.03, gradient: 0.01 });
        assert_eq!(Slip::at_creep(0.005, 0.01), Slip::Partial { fraction: 0.5, prefactor: 0.01 });
    }
}
