//! Reasons why a mapping cannot be built.

use crate::settings::{Kernel, shown_length};

/// Reason why a mapping cannot be built.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
pub enum MapError {
    /// The grid fails [`Grid::check`].
    #[error("no mapping from or to an invalid grid: {0}")]
    Grid(String),
    /// The grid is a volume, or of points in blocks; fields there are only written to files.
    #[error("no mapping from or to `{0}`: fields on volumes and at points are only written out")]
    OnlyWritten(String),
    /// Elements of a grid of vertices cannot be intersected.
    #[error(
        "no mapping by intersection from or to `{0}`: values belong to its vertices, not to elements; \
         use another method, or \"auto\""
    )]
    NoElements(String),
    /// The grid has more points than 32-bit indices can count.
    #[error("no mapping for grid `{grid}`: {points} points are more than 32 bits can count")]
    Size {
        /// Name of the grid.
        grid: String,
        /// Number of points.
        points: usize,
    },
    /// Two points at one place have two values, and no interpolant has both.
    #[error(
        "no interpolant by {kernel} on `{grid}`: its points {} and {} (counted from 0) are at the \
         same place; remove one of them, or use \"radial-basis\" without `basis`",
        .points[0],
        .points[1]
    )]
    SamePlace {
        /// Name of the grid with the points.
        grid: String,
        /// The function.
        kernel: Kernel,
        /// Indices of two points.
        points: [usize; 2],
    },
    /// The function is as good as zero at many targets: the mapping would have only the polynomial
    /// there.
    #[error(
        "{kernel} is too narrow on `{grid}`: at {outside} of {targets} mapped places the function \
         has fallen below a hundredth at the nearest point; set a radius of about {}",
        shown_length(*.radius)
    )]
    Narrow {
        /// Name of the grid with the interpolant.
        grid: String,
        /// The function.
        kernel: Kernel,
        /// Number of targets that are too far from any point.
        outside: usize,
        /// Number of all targets.
        targets: usize,
        /// Suggested radius \[m\].
        radius: f64,
    },
    /// The function hardly differs between neighbouring points: the linear system is singular to
    /// working precision.
    #[error(
        "{kernel} is too flat on `{grid}`: it hardly differs between neighbouring points, and the \
         linear system is singular to working precision; {}",
        remedy(kernel)
    )]
    Singular {
        /// Name of the grid with the interpolant.
        grid: String,
        /// The function.
        kernel: Kernel,
    },
}

/// Returns what to do about a singular system.
fn remedy(kernel: &Kernel) -> &'static str {
    match kernel.radius {
        Some(_) => "set a smaller radius, or a less smooth function such as \"wendland-c2\"",
        None => "set another function, such as \"wendland-c2\" with a radius",
    }
}
