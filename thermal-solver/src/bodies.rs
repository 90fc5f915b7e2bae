//! The two bodies, as pairs of values are ordered.

/// Index of the wheel (body 1) in a pair.
pub const WHEEL: usize = 0;
/// Index of the rail (body 2) in a pair.
pub const RAIL: usize = 1;
