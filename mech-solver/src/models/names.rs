//! Names of the models in the case file, which effects refer to.

/// Hertz's ellipse and Carter's strips.
pub const HERTZ_CARTER: &str = "hertz-carter";
/// Simplified theory.
pub const FASTSIM: &str = "fastsim";
/// Elastic half-spaces by boundary elements.
pub const HALF_SPACE: &str = "half-space";
