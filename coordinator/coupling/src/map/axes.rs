//! Principal axes of points, scaled by the extents of the points.

use super::nodes::Span;
use super::patch::Vector;
use nalgebra::{Matrix3, SymmetricEigen};

/// Coordinates along principal axes, in extents.
pub(super) type Place = [f64; 3];

/// Principal axes, scaled by extents: the root mean square distances from the mean.
pub(super) struct Axes {
    /// Mean of the points [m].
    pub(super) mean: Vector,
    axes: [Vector; 3],
    /// Number of directions that the points span; coordinates along further axes are zero.
    pub(super) count: usize,
}

impl Axes {
    /// Returns the axes of a stencil, with the directions of `span`.
    pub(super) fn of(points: impl ExactSizeIterator<Item = Vector> + Clone, span: Span) -> Self {
        Self::new(points, span.directions, |largest| span.flat * largest)
    }

    /// Returns the axes along which the points extend further than a length [m].
    pub(super) fn longer_than(
        points: impl ExactSizeIterator<Item = Vector> + Clone,
        length: f64,
    ) -> Self {
        Self::new(points, 3, |_| length)
    }

    /// Returns at most `directions` axes with extents above a limit that depends on the largest.
    fn new(
        points: impl ExactSizeIterator<Item = Vector> + Clone,
        directions: usize,
        limit: impl Fn(f64) -> f64,
    ) -> Self {
        let count = points.len() as f64;
        let mean = points.clone().sum::<Vector>() / count;
        let spread = |p: Vector| (p - mean) * (p - mean).transpose() / count;
        let eigen = SymmetricEigen::new(points.map(spread).sum::<Matrix3<f64>>());
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let extents = order.map(|k| eigen.eigenvalues[k].max(0.0).sqrt());
        let spanned = |n: usize| n < directions && extents[n] > limit(extents[0]);
        let axis = |n: usize| match spanned(n) {
            true => eigen.eigenvectors.column(order[n]) / extents[n],
            false => Vector::zeros(),
        };
        let axes = [axis(0), axis(1), axis(2)];
        Self { mean, axes, count: (0..3).filter(|n| spanned(*n)).count() }
    }

    /// Returns the coordinates of a point.
    pub(super) fn place(&self, point: Vector) -> Place {
        self.axes.map(|axis| axis.dot(&(point - self.mean)))
    }
}
