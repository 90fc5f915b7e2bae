//! Radial basis functions of compact support, with a linear polynomial, on the stencil of a target.
//!
//! The stencil x₁ … x_m surrounds the target's foot x on the source. It consists of the element
//! with the foot (all of them, if the foot is on a side or vertex) and [`RINGS`] rings of elements
//! that share a vertex: 25 elements inside a structured grid. On vertices it consists of the
//! corners of the triangle or edge with the foot and two rings of their neighbours or, without
//! connectivity, of the 25 nearest points. The interpolant u(x) = Σ_i c_i φ(|x − x_i|/R) + b·p(x),
//! with Σ_i c_i p(x_i) = 0 and p = (1, ξ, η), has the value Σ_i w_i u(x_i), whose weights solve the
//! symmetric system
//!
//! Σ_j φ(|x_i − x_j|/R) w_j + p(x_i)·μ = φ(|x − x_i|/R),   Σ_j p(x_j) w_j = p(x)
//!
//! with Wendland's φ(r) = (1 − r)⁴₊ (4r + 1), twice differentiable and positive definite in space.
//! Coordinates ξ and η are along the stencil's principal axes, each scaled by the stencil's extent
//! along it. Elements may therefore have any aspect ratio, and x needs to be only near the surface.
//! A stencil on a line has ξ only, and a single element has the weight 1. A stencil of points in
//! space has a third coordinate ζ. [`Span`] says which extents count as zero: the polynomial has
//! only the directions that the stencil spans.
//!
//! The support radius R is [`SUPPORT`] times the stencil's largest distance. Larger radii gain
//! nothing and cost digits; see the figures in `docs/theory/mapping.md`. The foot is within the
//! source's elements, so extrapolation is at most half an element. Among vertices a point beyond
//! the stencil's box along the principal axes takes the value at the box.

use super::axes::{Axes, Place};
use super::nodes::{MappingWeights, Nodes, Span, Target};
use super::patch::{Row, Vector};
use crate::settings::Basis;
use nalgebra::{DMatrix, DVector, Dyn, LU};

/// Number of rings of elements around the element with the foot.
const RINGS: usize = 2;

/// Support radius over the stencil's largest distance from its mean.
const SUPPORT: f64 = 4.0;

/// Interpolants on one grid.
pub(super) struct RadialBasis<'a> {
    nodes: &'a dyn Nodes,
    /// For each node, the last target whose stencil contains the node, counted from 1.
    seen: Vec<u32>,
    count: u32,
    stencil: Vec<u32>,
    ring: Vec<u32>,
    /// The stencil of the newest interpolant: neighbouring targets often share it.
    fitted: Vec<u32>,
    fit: Option<Fit>,
}

impl<'a> RadialBasis<'a> {
    pub(super) fn new(nodes: &'a dyn Nodes) -> Self {
        let (seen, ring) = (vec![0; nodes.places().len()], Vec::new());
        Self { nodes, seen, count: 0, stencil: Vec::new(), ring, fitted: Vec::new(), fit: None }
    }

    fn gather(&mut self, target: &Target) {
        self.count += 1;
        self.stencil.clear();
        self.ring.clear();
        self.nodes.seeds(&target.foot, &mut self.ring);
        self.enter_ring();
        let mut done = 0;
        for _ in 0..RINGS {
            for n in std::mem::replace(&mut done, self.stencil.len())..self.stencil.len() {
                self.nodes.ring(self.stencil[n], &mut self.ring);
                self.enter_ring();
            }
        }
    }

    /// Moves the nodes of the ring that are new into the stencil.
    fn enter_ring(&mut self) {
        for node in self.ring.drain(..) {
            if std::mem::replace(&mut self.seen[node as usize], self.count) != self.count {
                self.stencil.push(node);
            }
        }
    }
}

impl MappingWeights for RadialBasis<'_> {
    fn weigh(&mut self, target: &Target, row: &mut Row) {
        self.gather(target);
        if self.stencil != self.fitted {
            let place = |node: &u32| self.nodes.places()[*node as usize];
            self.fit = Some(Fit::of(self.stencil.iter().map(place), self.nodes.span()));
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
    places: Vec<Place>,
    /// Lower and upper corner of the box within which the interpolant is evaluated.
    bounds: Option<[Place; 2]>,
    support: f64,
    system: LU<f64, Dyn, Dyn>,
}

impl Fit {
    fn of(stencil: impl ExactSizeIterator<Item = Vector> + Clone, span: Span) -> Self {
        let axes = Axes::of(stencil.clone(), span);
        let places: Vec<Place> = stencil.map(|point| axes.place(point)).collect();
        let radius = places.iter().map(|place| distance(*place, [0.0; 3])).fold(0.0, f64::max);
        let support = if radius > 0.0 { SUPPORT * radius } else { 1.0 };
        let (points, size) = (places.len(), places.len() + 1 + axes.count);
        let matrix = DMatrix::from_fn(size, size, |m, n| match (m < points, n < points) {
            (true, _) => entry(&places, support, places[m], n),
            (false, true) => entry(&places, support, places[n], m),
            (false, false) => 0.0,
        });
        let bounds = span.bounded.then(|| {
            let corner = |pick: fn(f64, f64) -> f64| -> Place {
                std::array::from_fn(|k| places.iter().map(|p| p[k]).fold(places[0][k], pick))
            };
            [corner(f64::min), corner(f64::max)]
        });
        Self { axes, places, bounds, support, system: matrix.lu() }
    }

    /// Returns the weights of the stencil's values at a point; `None` if the system is singular.
    fn weights(&self, point: Vector) -> Option<DVector<f64>> {
        let mut at = self.axes.place(point);
        if let Some([low, high]) = self.bounds {
            at = std::array::from_fn(|k| at[k].clamp(low[k], high[k]));
        }
        let (points, size) = (self.places.len(), self.places.len() + 1 + self.axes.count);
        let right = DVector::from_fn(size, |n, _| entry(&self.places, self.support, at, n));
        let weights = self.system.solve(&right)?.remove_rows(points, 1 + self.axes.count);
        // Two nodes that coincide along the stencil's normal make the system singular.
        let sound = (weights.sum() - 1.0).abs() < 1e-6 && weights.amax() < 1e3;
        sound.then_some(weights)
    }
}

/// Returns the value of the n-th function, radial or polynomial, at a point.
fn entry(places: &[Place], support: f64, at: Place, n: usize) -> f64 {
    match n.checked_sub(places.len()) {
        None => Basis::WendlandC2.value(distance(at, places[n]) / support),
        Some(0) => 1.0,
        Some(k) => at[k - 1],
    }
}

fn distance(a: Place, b: Place) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}
