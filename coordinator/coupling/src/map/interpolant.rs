//! Interpolants by a chosen radial basis function.
//!
//! The interpolant through the values at points x₁ … x_m is u(x) = Σ_i c_i φ(|x − x_i|/a) + b·p(x),
//! with Σ_i c_i p(x_i) = 0. The polynomial p = (1, ξ, η, ζ) is linear in the principal directions
//! along which the points extend further than [`FLAT`] of the distance between neighbours. The
//! weights of the values at a target x solve the symmetric system
//!
//! Σ_j φ(|x_i − x_j|/a) w_j + p(x_i)·μ = φ(|x − x_i|/a),   Σ_j p(x_j) w_j = p(x)
//!
//! Distances are true distances in space. The target x is the foot on the source, so that a gap
//! along the normal has no influence. Beyond the outermost points the interpolant tends to its
//! polynomial.
//!
//! Flat functions make the system ill-conditioned. The diagonal therefore has [`RIDGE`] in
//! addition. It bounds the weights, keeps constants and linear functions, and is far below the
//! error of an interpolant whose system is well conditioned. A function is refused if the ridge
//! takes more than [`SMOOTHED`] of a point's own value at its place, for some of the points. The
//! weights of every target must also be moderate, sum to one, and reproduce linear functions.
//!
//! Source of the ridge: G. Wahba, *Spline Models for Observational Data*, SIAM (1990).

use super::axes::{Axes, Place};
use super::dense::Factorised;
use super::error::MapError;
use super::nodes::{Nodes, Target};
use super::patch::{COINCIDENT, Row, Vector};
use crate::settings::Kernel;
use nalgebra::DMatrix;
use rstar::primitives::GeomWithData;
use rstar::{PointDistance, RTree};

/// Fraction of the distance between neighbours below which an extent counts as zero.
const FLAT: f64 = 0.1;

/// Ridge on the diagonal, over the largest value of the function: some hundred roundings.
const RIDGE: f64 = 1e-13;

/// Largest part of a point's own value that the ridge may take away at the place of the point.
const SMOOTHED: f64 = 0.5;

/// Number of points at which the ridge is checked.
const SAMPLES: usize = 16;

/// Error of a reproduced linear function above which weights are not sound.
const REPRODUCED: f64 = 1e-6;

/// Largest weight of a sound row, over one and the target's distance in extents.
const LARGEST: f64 = 1e3;

/// Suggested radius over the typical distance of neighbours.
const NEIGHBOURS: f64 = 3.0;

/// Search tree of points, with their indices.
pub(super) type PointTree = RTree<GeomWithData<[f64; 3], u32>>;

/// Points of a source that are interpolated by one function.
pub(super) struct Source<'a> {
    pub(super) places: &'a [Vector],
    pub(super) tree: PointTree,
    /// Median of the distances from each point to the nearest other one [m].
    pub(super) spacing: f64,
    kernel: Kernel,
    grid: &'a str,
}

impl<'a> Source<'a> {
    /// Prepares the nodes of a grid; refuses points at the same place.
    pub(super) fn new(
        nodes: &'a dyn Nodes,
        kernel: Kernel,
        grid: &'a str,
    ) -> Result<Self, MapError> {
        let places = nodes.places();
        let leaves = places.iter().enumerate();
        let leaves = leaves.map(|(n, place)| GeomWithData::new((*place).into(), n as u32));
        let tree = PointTree::bulk_load(leaves.collect());
        let mut gaps = Vec::with_capacity(places.len());
        for (n, place) in places.iter().enumerate() {
            let from: [f64; 3] = (*place).into();
            let mut near = tree.nearest_neighbor_iter(from);
            let Some(nearest) = near.find(|leaf| leaf.data as usize != n) else { break };
            let gap = nearest.distance_2(&from).sqrt();
            if gap <= COINCIDENT * nodes.size(n) {
                let points = [n, nearest.data as usize];
                return Err(MapError::SamePlace { grid: grid.to_owned(), kernel, points });
            }
            gaps.push(gap);
        }
        Ok(Self { places, tree, spacing: quantile(&mut gaps, 0.5), kernel, grid })
    }

    /// Refuses a function that is as good as zero at more than one target in a hundred.
    pub(super) fn check_radius(&self, targets: &[Target]) -> Result<(), MapError> {
        let distance = |target: &Target| (target.foot.point - self.places[target.foot.node]).norm();
        let mut distances: Vec<f64> = targets.iter().map(distance).collect();
        let outside = distances.iter().filter(|distance| self.kernel.is_small_at(**distance));
        let outside = outside.count();
        if 100 * outside <= targets.len() {
            return Ok(());
        }
        Err(MapError::Narrow {
            grid: self.grid.to_owned(),
            kernel: self.kernel,
            outside,
            targets: targets.len(),
            radius: rounded_up(NEIGHBOURS * quantile(&mut distances, 0.99).max(self.spacing)),
        })
    }

    /// Returns the interpolant through some of the points; refuses a function that is too flat.
    pub(super) fn interpolant(&self, points: Vec<u32>) -> Result<Interpolant, MapError> {
        let axes = self.axes(&points);
        let places = points.iter().map(|n| self.places[*n as usize]).collect();
        let interpolant = Interpolant::new(points, Functions::new(places, axes, self.kernel));
        if interpolant.separates_points() { Ok(interpolant) } else { Err(self.singular()) }
    }

    /// Returns the principal axes of some of the points.
    pub(super) fn axes(&self, points: &[u32]) -> Axes {
        let places = points.iter().map(|n| self.places[*n as usize]);
        Axes::longer_than(places, FLAT * self.spacing)
    }

    pub(super) fn singular(&self) -> MapError {
        MapError::Singular { grid: self.grid.to_owned(), kernel: self.kernel }
    }
}

/// Returns the value below which this part of the values lies; 0 of no values.
fn quantile(values: &mut [f64], part: f64) -> f64 {
    let Some(last) = values.len().checked_sub(1) else { return 0.0 };
    *values.select_nth_unstable_by((part * last as f64) as usize, f64::total_cmp).1
}

/// Rounds a length up to two significant digits.
fn rounded_up(length: f64) -> f64 {
    if length <= 0.0 {
        return length;
    }
    let digits = 1 - length.log10().floor() as i32;
    let unit = 10_f64.powi(digits);
    (length * unit).ceil() / unit
}

/// The interpolant through the values at some points, with its factorised system.
pub(super) struct Interpolant {
    points: Vec<u32>,
    functions: Functions,
    system: Factorised,
}

/// The functions of an interpolant: a radial one at each point, and the polynomial.
struct Functions {
    places: Vec<Vector>,
    axes: Axes,
    /// Coordinates of the places along the axes.
    coordinates: Vec<Place>,
    kernel: Kernel,
    /// Length a of the radial function [m].
    length: f64,
    /// Factor of the radial function, so that its values are of size one.
    factor: f64,
}

impl Interpolant {
    fn new(points: Vec<u32>, functions: Functions) -> Self {
        let (count, size) = (functions.places.len(), functions.len());
        let ridge = RIDGE * functions.kernel.basis.sign();
        let columns = functions.at(&functions.places);
        let matrix = DMatrix::from_fn(size, size, |m, n| match (m < count, n < count) {
            (_, true) if m == n => columns[(m, n)] + ridge,
            (_, true) => columns[(m, n)],
            (true, false) => columns[(n, m)],
            (false, false) => 0.0,
        });
        Self { points, functions, system: Factorised::new(matrix) }
    }

    /// Solves for the weights of targets at these points, with a column for each target. The rows
    /// after the weights have the multipliers of the polynomial.
    fn solve(&self, targets: &[Vector]) -> DMatrix<f64> {
        let mut weights = self.functions.at(targets);
        self.system.solve(&mut weights);
        weights
    }

    /// Returns whether points keep their own values in spite of the ridge, for a sample of points.
    fn separates_points(&self) -> bool {
        let places = &self.functions.places;
        let step = places.len().div_ceil(SAMPLES);
        let sample: Vec<usize> = (0..places.len()).step_by(step).collect();
        let weights = self.solve(&sample.iter().map(|n| places[*n]).collect::<Vec<_>>());
        // A comparison with NaN is false.
        sample.iter().enumerate().all(|(column, n)| (weights[(*n, column)] - 1.0).abs() < SMOOTHED)
    }

    /// Returns the weights of targets at these points; `None` if some are not sound.
    pub(super) fn rows(&self, targets: &[Vector]) -> Option<impl Iterator<Item = Row>> {
        let weights = self.solve(targets);
        let count = self.points.len();
        let sound = targets.iter().enumerate().all(|(column, target)| {
            self.functions.are_sound(weights.column(column).rows(0, count).as_slice(), *target)
        });
        let row = move |column: usize| -> Row {
            self.points.iter().copied().zip(weights.column(column).iter().copied()).collect()
        };
        sound.then(|| (0..targets.len()).map(row))
    }
}

impl Functions {
    fn new(places: Vec<Vector>, axes: Axes, kernel: Kernel) -> Self {
        let offsets = places.iter().map(|place| (place - axes.mean).norm());
        let extent = 2.0 * offsets.fold(0.0, f64::max);
        let length = kernel.radius.unwrap_or(if extent > 0.0 { extent } else { 1.0 });
        let peak = kernel.basis.value(0.0).max(kernel.basis.value(extent / length));
        let factor = if peak > 0.0 { 1.0 / peak } else { 1.0 };
        let coordinates = places.iter().map(|place| axes.place(*place)).collect();
        Self { places, axes, coordinates, kernel, length, factor }
    }

    /// Returns the number of functions.
    fn len(&self) -> usize {
        self.places.len() + 1 + self.axes.count
    }

    /// Returns the values of all functions, with a column for each target.
    fn at(&self, targets: &[Vector]) -> DMatrix<f64> {
        let mut values = DMatrix::zeros(self.len(), targets.len());
        for (mut column, target) in values.column_iter_mut().zip(targets) {
            let (radial, polynomial) = column.as_mut_slice().split_at_mut(self.places.len());
            for (value, place) in radial.iter_mut().zip(&self.places) {
                let p = (target - place).norm() / self.length;
                *value = self.factor * self.kernel.basis.value(p);
            }
            polynomial[0] = 1.0;
            polynomial[1..].copy_from_slice(&self.axes.place(*target)[..self.axes.count]);
        }
        values
    }

    /// Returns whether weights are moderate, sum to one, and reproduce linear functions.
    fn are_sound(&self, weights: &[f64], target: Vector) -> bool {
        let at = self.axes.place(target);
        let scale = 1.0 + at.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let mut left = [1.0, at[0], at[1], at[2]];
        for (weight, [x, y, z]) in weights.iter().zip(&self.coordinates) {
            for (left, value) in left.iter_mut().zip([1.0, *x, *y, *z]) {
                *left -= weight * value;
            }
        }
        // A comparison with NaN is false.
        let reproduced = left.iter().all(|left| left.abs() < REPRODUCED * scale);
        reproduced && weights.iter().all(|weight| weight.abs() < LARGEST * scale)
    }
}
