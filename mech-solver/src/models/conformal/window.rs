//! A window and its solution.

use super::case::Row;
use half_space::conformal::contact::Conformal;

/// A solved time window.
pub(super) struct Window {
    pub(super) row: Row,
    pub(super) contact: Conformal,
    /// Slip velocity, along x and s [m/s].
    pub(super) slip_velocity: [Vec<f64>; 2],
    /// Friction power of every element [W/m²].
    pub(super) power: Vec<f64>,
}
