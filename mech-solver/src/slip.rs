//! How a contact slips: what the models decide and the effects compute with.
//!
//! Slip velocities are V · s · g(ξ), with ξ = −X = −x/a_y of every strip, from −1 at the leading
//! to +1 at the trailing edge.

use crate::reference::carter;
use crate::strips::StripDensity;

/// Where the contact slips, and how fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Slip {
    /// Nowhere: no tangential motion, no traction.
    Adhesion,
    /// In the trailing fraction of every strip, after Carter.
    Partial {
        /// Fraction m of every strip that slips, in (0, 1) [-].
        fraction: f64,
        /// Prefactor A of the creep law [-].
        prefactor: f64,
    },
    /// Everywhere, with the slip s + A ξ; s ≥ A ≥ 0.
    Sliding {
        /// Mean slip s [-].
        creep: f64,
        /// Gradient A of the slip [-].
        gradient: f64,
    },
}

impl Slip {
    /// Share of the contact area that slips [-].
    pub(crate) fn area_ratio(&self) -> f64 {
        match *self {
            Self::Adhesion => 0.0,
            Self::Partial { fraction, .. } => fraction,
            Self::Sliding { .. } => 1.0,
        }
    }

    /// Force over friction bound, |F|/(f N) [-].
    pub(crate) fn force_ratio(&self) -> f64 {
        carter::force_ratio(self.area_ratio())
    }

    /// Magnitude of the creepage [-].
    pub(crate) fn creep(&self) -> f64 {
        match *self {
            Self::Adhesion => 0.0,
            Self::Partial { fraction, prefactor } => prefactor * fraction,
            Self::Sliding { creep, .. } => creep,
        }
    }

    /// Largest traction over f p_0 [-].
    pub(crate) fn largest_traction(&self) -> f64 {
        carter::largest_traction_shape(self.area_ratio())
    }

    /// Largest slip velocity over V [-].
    pub(crate) fn largest_velocity(&self) -> f64 {
        match *self {
            Self::Adhesion => 0.0,
            Self::Partial { fraction, prefactor } => {
                prefactor * carter::largest_slip_shape(fraction)
            }
            Self::Sliding { creep, gradient } => creep + gradient,
        }
    }
}

/// Slip s + A ξ of a contact that slides everywhere.
pub(crate) struct SlidingSlip {
    /// Mean slip s [-].
    pub(crate) creep: f64,
    /// Gradient A [-].
    pub(crate) gradient: f64,
}

impl StripDensity for SlidingSlip {
    fn cumulative(&self, u: f64) -> f64 {
        u * (self.creep + self.gradient * (1.0 - 0.5 * u))
    }
}
