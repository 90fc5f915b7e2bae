//! Friction that varies over the surfaces: factors on the friction coefficient over a coordinate.

use crate::case::piecewise_linear::PiecewiseLinear;

/// Coordinate of the table of factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Over {
    /// The lateral coordinate [m].
    Lateral,
    /// Inclination of the rail's surface in the axes of its profile, y to the field side and z up;
    /// positive on the gauge side [rad].
    Inclination,
    /// Position along the track [m].
    Track,
}

/// Points at which the coordinate is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum At {
    /// Each element at its own coordinate.
    Elements,
    /// All elements of a patch at the coordinate of its reference.
    Patches,
}

/// Factors over a coordinate, linear between the rows of a table and constant beyond them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bands {
    pub(crate) table: PiecewiseLinear<1>,
    pub(crate) over: Over,
    pub(crate) at: At,
}

impl Bands {
    /// Factor at a coordinate.
    pub(crate) fn factor(&self, coordinate: f64) -> f64 {
        self.table.at(coordinate).map_or(1.0, |[factor]| factor)
    }
}
