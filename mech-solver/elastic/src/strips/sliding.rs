//! Slip and friction power along a strip that slides everywhere, as integrals over u = 1 + X from
//! the trailing edge.

use super::StripDensity;
use super::semi_ellipse::segment_area;

/// Slip s + A ξ of a contact that slides everywhere.
pub struct SlidingSlip {
    /// Mean slip s [-].
    pub creep: f64,
    /// Gradient A [-].
    pub gradient: f64,
}

impl StripDensity for SlidingSlip {
    fn cumulative(&self, u: f64) -> f64 {
        u * (self.creep + self.gradient * (1.0 - 0.5 * u))
    }
}

/// Friction power (s + A ξ) √(1 − ξ²) of a contact that slides everywhere.
pub struct SlidingPower {
    /// Mean slip s [-].
    pub creep: f64,
    /// Gradient A [-].
    pub gradient: f64,
}

impl StripDensity for SlidingPower {
    fn cumulative(&self, u: f64) -> f64 {
        let root = (u * (2.0 - u)).sqrt();
        self.creep * segment_area(u) + self.gradient * root.powi(3) / 3.0
    }
}
