//! Points in space, and when two of them are the same.

/// A point or a vector in space [m].
pub(super) type Vector = nalgebra::Vector3<f64>;

/// Distances below this fraction of an element's size are taken for zero: coordinates [m] of doubles
/// are exact to some 1e-12 of an element.
pub(super) const COINCIDENT: f64 = 1e-10;
