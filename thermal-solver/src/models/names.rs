//! Names of the models in the case file, which effects refer to.

/// Rods end to end.
pub const ROD: &str = "rod";
/// Ertz and Knothe's polynomial.
pub const ERTZ_KNOTHE: &str = "ertz-knothe";
/// Columns with the exact kernel.
pub const COLUMNS: &str = "columns";
/// Half-spaces under a moving flux, in three dimensions.
pub const MOVING_SOURCE: &str = "moving-source";
/// Finite elements of both bodies.
pub const FE: &str = "fe";
/// Half-spaces under a flux that repeats.
pub const PERIODIC: &str = "periodic";
/// All of them: those of one contact, cheapest first, then those of bodies that repeat or end.
pub const ALL: [&str; 6] = [ERTZ_KNOTHE, COLUMNS, MOVING_SOURCE, FE, PERIODIC, ROD];
