//! Friction that varies over the surfaces: factors on the friction coefficient over a coordinate.

use crate::case::piecewise_linear::PiecewiseLinear;

/// What the factors are a table of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Over {
    /// The lateral coordinate [m].
    Lateral,
    /// The inclination of the rail's surface in the axes of its profile, y to the field side and z up: positive on the
    /// gauge side [rad].
    Inclination,
    /// The place along the track [m].
    Track,
}

/// Where the coordinate is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum At {
    /// Every element has its own.
    Elements,
    /// All elements of a patch have that of its reference.
    Patches,
}

/// Factors over a coordinate, straight between the lines of a table and constant beyond them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bands {
    pub(crate) table: PiecewiseLinear<1>,
    pub(crate) over: Over,
    pub(crate) at: At,
}

impl Bands {
    /// The factor at a coordinate.
    pub(crate) fn factor(&self, coordinate: f64) -> f64 {
        self.table.at(coordinate).map_or(1.0, |[factor]| factor)
    }
}
