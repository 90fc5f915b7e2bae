//! Names of the models in the case file, for use by the effects.

/// Rods, end to end.
pub const ROD: &str = "rod";
/// Polynomial of Ertz and Knothe.
pub const ERTZ_KNOTHE: &str = "ertz-knothe";
/// Columns with the exact kernel.
pub const COLUMNS: &str = "columns";
/// Half-spaces under a moving flux, in three dimensions.
pub const MOVING_SOURCE: &str = "moving-source";
/// Finite elements of both bodies.
pub const FE: &str = "fe";
/// Half-spaces under a periodic flux.
pub const PERIODIC: &str = "periodic";
/// All models: those of a single contact, cheapest first, then those of periodic or finite bodies.
pub const ALL: [&str; 6] = [ERTZ_KNOTHE, COLUMNS, MOVING_SOURCE, FE, PERIODIC, ROD];
