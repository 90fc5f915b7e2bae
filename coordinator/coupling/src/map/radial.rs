//! Radial basis functions of compact support, with a linear polynomial.
//!
//! Round the target's foot x on the source the stencil x₁ … x_m is taken: the element with the foot
//! (all of them, if it is on a side or vertex) and [`RINGS`] rings of elements that share a vertex,
//! 25 elements in the inside of a structured grid. The interpolant
//! u(x) = Σ_i c_i φ(|x − x_i|/R) + b·p(x), with Σ_i c_i p(x_i) = 0 and p = (1, ξ, η), has the value
//! Σ_i w_i u(x_i), whose weights solve the symmetric system
//!
//! Σ_j φ(|x_i − x_j|/R) w_j + p(x_i)·μ = φ(|x − x_i|/R),   Σ_j p(x_j) w_j = p(x)
//!
//! with Wendland's φ(r) = (1 − r)⁴₊ (4r + 1), twice differentiable and positive definite in space.
//! Coordinates ξ and η are along the stencil's principal axes, each scaled by the stencil's extent
//! along it: elements may be as long and thin as they like, and x needs to be on the surface only
//! about. A stencil in a line has ξ only, and one of a single element the weight 1.
//!
//! The support radius R is [`SUPPORT`] times the stencil's largest distance. Larger ones gain
//! nothing and cost digits; see the figures in `docs/theory/mapping.md`. The foot is within the
//! source's elements, so nothing is extrapolated by more than half an element.

use super::operator::Row;
use super::surface::Surface;
use super::vector::Vector;
use super::weigh::{Target, Weigh};
use nalgebra::{DMatrix, DVector, Dyn, LU, Matrix3, SymmetricEigen};

/// Rings of elements round that of the foot.
const RINGS: usize = 2;

/// Support radius over the stencil's largest distance from its mean.
const SUPPORT: f64 = 4.0;

/// Extents below this fraction of the largest are taken for none.
const FLAT: f64 = 1e-6;

/// The interpolants on one surface.
pub(super) struct RadialBasis<'a> {
    surface: &'a Surface,
    /// The last target whose stencil holds an element, counted from 1.
    seen: Vec<u32>,
    count: u32,
    stencil: Vec<u32>,
    /// The newest interpolant and its stencil: neighbouring targets often share it.
    fitted: Vec<u32>,
    fit: Option<Fit>,
}

impl<'a> RadialBasis<'a> {
    pub(super) fn new(surface: &'a Surface) -> Self {
        let seen = vec![0; surface.centres.len()];
        Self { surface, seen, count: 0, stencil: Vec::new(), fitted: Vec::new(), fit: None }
    }

    fn gather(&mut self, target: &Target) {
        self.count += 1;
        self.stencil.clear();
        let mut enter = |element: u32, stencil: &mut Vec<u32>| {
            if std::mem::replace(&mut self.seen[element as usize], self.count) != self.count {
                stencil.push(element);
            }
        };
        let at_foot = self.surface.at(&target.foot);
        at_foot.for_each(|element| enter(element, &mut self.stencil));
        let mut done = 0;
        for _ in 0..RINGS {
            for n in std::mem::replace(&mut done, self.stencil.len())..self.stencil.len() {
                let around = self.surface.around(self.stencil[n]);
                around.for_each(|element| enter(element, &mut self.stencil));
            }
        }
    }
}

impl Weigh for RadialBasis<'_> {
    fn weigh(&mut self, target: &Target, row: &mut Row) {
        self.gather(target);
        if self.stencil != self.fitted {
            let centre = |element: &u32| self.surface.centres[*element as usize];
            self.fit = Some(Fit::of(self.stencil.iter().map(centre)));
            self.fitted.clone_from(&self.stencil);
        }
        if let Some(weights) = self.fit.as_ref().and_then(|fit| fit.weights(target.foot.point)) {
            row.extend(self.stencil.iter().copied().zip(weights.iter().copied()));
        }
    }
}

/// The interpolant through the values on one stencil.
struct Fit {
    axes: Axes,
    places: Vec<[f64; 2]>,
    support: f64,
    system: LU<f64, Dyn, Dyn>,
}

impl Fit {
    fn of(stencil: impl ExactSizeIterator<Item = Vector> + Clone) -> Self {
        let axes = Axes::of(stencil.clone());
        let places: Vec<[f64; 2]> = stencil.map(|point| axes.place(point)).collect();
        let radius = places.iter().map(|place| distance(*place, [0.0; 2])).fold(0.0, f64::max);
        let support = if radius > 0.0 { SUPPORT * radius } else { 1.0 };
        let (points, size) = (places.len(), places.len() + 1 + axes.count);
        let matrix = DMatrix::from_fn(size, size, |m, n| match (m < points, n < points) {
            (true, _) => entry(&places, support, places[m], n),
            (false, true) => entry(&places, support, places[n], m),
            (false, false) => 0.0,
        });
        Self { axes, places, support, system: matrix.lu() }
    }

    /// Weights of the stencil's values at a point; `None` if the stencil does not determine them.
    fn weights(&self, point: Vector) -> Option<DVector<f64>> {
        let at = self.axes.place(point);
        let (points, size) = (self.places.len(), self.places.len() + 1 + self.axes.count);
        let right = DVector::from_fn(size, |n, _| entry(&self.places, self.support, at, n));
        let weights = self.system.solve(&right)?.remove_rows(points, 1 + self.axes.count);
        // Two elements in one place, seen along the stencil's normal, leave it undetermined.
        let sound = (weights.sum() - 1.0).abs() < 1e-6 && weights.amax() < 1e3;
        sound.then_some(weights)
    }
}

/// What the n-th function, radial or of the polynomial, is at a place.
fn entry(places: &[[f64; 2]], support: f64, at: [f64; 2], n: usize) -> f64 {
    match n.checked_sub(places.len()) {
        None => wendland(distance(at, places[n]) / support),
        Some(k) => [1.0, at[0], at[1]][k],
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt()
}

/// Principal axes of a stencil, scaled by its extents.
struct Axes {
    mean: Vector,
    axes: [Vector; 2],
    count: usize,
}

impl Axes {
    fn of(points: impl ExactSizeIterator<Item = Vector> + Clone) -> Self {
        let count = points.len() as f64;
        let mean = points.clone().sum::<Vector>() / count;
        let spread = |p: Vector| (p - mean) * (p - mean).transpose() / count;
        let eigen = SymmetricEigen::new(points.map(spread).sum::<Matrix3<f64>>());
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let extents = order.map(|k| eigen.eigenvalues[k].max(0.0).sqrt());
        let flat = |extent: &f64| *extent <= FLAT * extents[0];
        let axis = |n: usize| match extents[n] {
            extent if flat(&extent) => Vector::zeros(),
            extent => eigen.eigenvectors.column(order[n]) / extent,
        };
        let axes = [axis(0), axis(1)];
        Self { mean, axes, count: extents[..2].iter().filter(|extent| !flat(extent)).count() }
    }

    fn place(&self, point: Vector) -> [f64; 2] {
        self.axes.map(|axis| axis.dot(&(point - self.mean)))
    }
}

/// Wendland's function of smoothness C2.
fn wendland(r: f64) -> f64 {
    let beyond = (1.0 - r).max(0.0);
    beyond.powi(4) * (4.0 * r + 1.0)
}
