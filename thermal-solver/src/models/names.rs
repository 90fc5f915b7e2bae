//! Names of the models in the case file, which effects refer to.

/// Ertz and Knothe's polynomial.
pub const ERTZ_KNOTHE: &str = "ertz-knothe";
/// Columns with the exact kernel.
pub const COLUMNS: &str = "columns";
/// All of them, cheapest first.
pub const ALL: [&str; 2] = [ERTZ_KNOTHE, COLUMNS];
