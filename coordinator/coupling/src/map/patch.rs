//! Nearest points on points, segments, triangles, bilinear patches and fans.
//!
//! A patch is spanned by n corners in order around it. For n = 4 it is the bilinear surface
//! x(ξ, η) = a + ξ(b − a) + η(d − a) + ξη(a − b + c − d) on the unit square. For n ≥ 5 it consists
//! of the triangles from its sides to the mean of its corners. For n < 4 it is the point, segment
//! or triangle itself. All patches reproduce linear functions in the plane of the corners, with
//! weights that are ≥ 0 and sum to one.

use rstar::{AABB, PointDistance, RTree, RTreeObject};

/// A point or a vector in space [m].
pub(super) type Vector = nalgebra::Vector3<f64>;

/// Fraction of an element's size below which a distance counts as zero: coordinates [m] in double
/// precision are exact to some 1e-12 of an element.
pub(super) const COINCIDENT: f64 = 1e-10;

/// Columns and weights of one row; a column may occur several times.
pub(super) type Row = Vec<(u32, f64)>;

/// Largest number of Gauss–Newton steps to the foot on a bilinear patch: a parallelogram takes one,
/// and convergence on a plane patch is quadratic.
const STEPS: usize = 20;

/// Change of ξ and η below which the iteration has converged.
const CONVERGED: f64 = 1e-14;

/// Fraction of a patch's squared size below which a squared distance counts as zero.
const ON_SURFACE: f64 = 1e-24;

/// A patch with the indices of its nodes.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    /// Corners [m], in order.
    corners: Box<[Vector]>,
    /// Indices whose meaning the user of the patch defines: the element at each corner, or the
    /// patch itself.
    pub(super) nodes: Box<[u32]>,
    bounds: AABB<[f64; 3]>,
}

/// The nearest point of a patch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// The point [m].
    pub(super) point: Vector,
    /// Squared distance to the point [m²].
    pub(super) distance_2: f64,
    /// Corners and their weights; unused entries have the weight 0.
    pub(super) weights: [(usize, f64); 4],
    /// Weight of the mean of all corners.
    pub(super) mean: f64,
}

impl Nearest {
    fn new(from: Vector, point: Vector, weights: [(usize, f64); 4], mean: f64) -> Self {
        Self { point, distance_2: (point - from).norm_squared(), weights, mean }
    }

    fn or(self, other: Self) -> Self {
        if other.distance_2 < self.distance_2 { other } else { self }
    }
}

impl Patch {
    /// Creates the patch with these corners [m], at least one.
    pub(super) fn new(corners: Box<[Vector]>, nodes: Box<[u32]>) -> Self {
        let low = corners.iter().fold(corners[0], |low, corner| low.inf(corner));
        let high = corners.iter().fold(corners[0], |high, corner| high.sup(corner));
        Self { corners, nodes, bounds: AABB::from_corners(low.into(), high.into()) }
    }

    /// Returns the point of the patch nearest to `from`.
    pub(super) fn nearest(&self, from: Vector) -> Nearest {
        let corners = &self.corners;
        match corners.len() {
            1 => Nearest::new(from, corners[0], [(0, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)], 0.0),
            2 => self.on_side(from, 0),
            3 => triangle(from, [(corners[0], 0), (corners[1], 1), (corners[2], 2)]),
            4 => self.bilinear(from).unwrap_or_else(|| self.on_border(from)),
            _ => self.fan(from),
        }
    }

    /// Adds the node weights of a nearest point to a row.
    pub(super) fn weigh(&self, nearest: &Nearest, row: &mut Row) {
        let corners = nearest.weights.iter().filter(|(_, weight)| *weight > 0.0);
        row.extend(corners.map(|&(corner, weight)| (self.nodes[corner], weight)));
        if nearest.mean > 0.0 {
            let share = nearest.mean / self.nodes.len() as f64;
            row.extend(self.nodes.iter().map(|node| (*node, share)));
        }
    }

    /// Finds ξ and η by Gauss–Newton from the middle. `None` if the foot is outside the patch.
    fn bilinear(&self, from: Vector) -> Option<Nearest> {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.corners[k]);
        let (along, up, twist) = (b - a, d - a, (a - b) + (c - d));
        let (mut xi, mut eta) = (0.5_f64, 0.5_f64);
        for _ in 0..STEPS {
            let (x_xi, x_eta) = (along + eta * twist, up + xi * twist);
            let residual = from - (a + xi * along + eta * up + xi * eta * twist);
            let [step_xi, step_eta] = least_squares(x_xi, x_eta, residual)?;
            let old = (xi, eta);
            xi = (xi + step_xi).clamp(-0.5, 1.5);
            eta = (eta + step_eta).clamp(-0.5, 1.5);
            if (xi - old.0).abs().max((eta - old.1).abs()) < CONVERGED {
                break;
            }
        }
        let within = |v: f64| (-1e-12..=1.0 + 1e-12).contains(&v);
        if !within(xi) || !within(eta) {
            return None;
        }
        let (xi, eta) = (xi.clamp(0.0, 1.0), eta.clamp(0.0, 1.0));
        let weights = [(1.0 - xi) * (1.0 - eta), xi * (1.0 - eta), xi * eta, (1.0 - xi) * eta];
        let point = weights[0] * a + weights[1] * b + weights[2] * c + weights[3] * d;
        Some(Nearest::new(from, point, std::array::from_fn(|k| (k, weights[k])), 0.0))
    }

    fn on_side(&self, from: Vector, side: usize) -> Nearest {
        let next = (side + 1) % self.corners.len();
        segment(from, (self.corners[side], side), (self.corners[next], next))
    }

    fn on_border(&self, from: Vector) -> Nearest {
        let sides = (1..self.corners.len()).map(|side| self.on_side(from, side));
        sides.fold(self.on_side(from, 0), Nearest::or)
    }

    fn fan(&self, from: Vector) -> Nearest {
        let count = self.corners.len();
        let mean = self.corners.iter().sum::<Vector>() / count as f64;
        let one = |side: usize| {
            let next = (side + 1) % count;
            let corners = [(self.corners[side], side), (self.corners[next], next), (mean, count)];
            triangle(from, corners)
        };
        let mut nearest = (1..count).map(one).fold(one(0), Nearest::or);
        for (corner, weight) in &mut nearest.weights {
            if *corner == count {
                nearest.mean += *weight;
                (*corner, *weight) = (0, 0.0);
            }
        }
        nearest
    }
}

/// Returns the patch of a tree nearest to a point, and the nearest point; `None` without patches.
///
/// Most points lie on the surface. One of the few patches whose boxes contain the point then has
/// it, which saves the much slower search in order of distance.
pub(super) fn nearest_of(tree: &RTree<Patch>, from: Vector) -> Option<(&Patch, Nearest)> {
    let reached = |patch: &Patch, nearest: &Nearest| {
        let across = patch.corners[patch.corners.len() / 2] - patch.corners[0];
        nearest.distance_2 <= ON_SURFACE * across.norm_squared()
    };
    let here = tree.locate_in_envelope_intersecting(AABB::from_point(from.into()));
    here.map(|patch| (patch, patch.nearest(from)))
        .find(|(patch, nearest)| reached(patch, nearest))
        .or_else(|| tree.nearest_neighbor(from.into()).map(|patch| (patch, patch.nearest(from))))
}

impl RTreeObject for Patch {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        self.bounds
    }
}

impl PointDistance for Patch {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        self.nearest(Vector::from(*point)).distance_2
    }
}

/// Returns s and t that bring s u + t v nearest to w; `None` if u and v are parallel.
fn least_squares(u: Vector, v: Vector, w: Vector) -> Option<[f64; 2]> {
    let (uu, uv, vv) = (u.dot(&u), u.dot(&v), v.dot(&v));
    let determinant = uu * vv - uv * uv;
    let solvable = determinant > f64::EPSILON * uu * vv;
    let (wu, wv) = (w.dot(&u), w.dot(&v));
    solvable.then(|| [(wu * vv - wv * uv) / determinant, (wv * uu - wu * uv) / determinant])
}

fn segment(from: Vector, (a, first): (Vector, usize), (b, second): (Vector, usize)) -> Nearest {
    let length_2 = (b - a).norm_squared();
    let along = if length_2 > 0.0 { (from - a).dot(&(b - a)) / length_2 } else { 0.0 };
    let along = along.clamp(0.0, 1.0);
    let point = (1.0 - along) * a + along * b;
    let weights = [(first, 1.0 - along), (second, along), (0, 0.0), (0, 0.0)];
    Nearest::new(from, point, weights, 0.0)
}

fn triangle(from: Vector, corners: [(Vector, usize); 3]) -> Nearest {
    let [(a, i), (b, j), (c, k)] = corners;
    if let Some([s, t]) = least_squares(b - a, c - a, from - a)
        && s >= 0.0
        && t >= 0.0
        && s + t <= 1.0
    {
        let point = a + s * (b - a) + t * (c - a);
        return Nearest::new(from, point, [(i, 1.0 - s - t), (j, s), (k, t), (0, 0.0)], 0.0);
    }
    let [ab, bc, ca] = [(0, 1), (1, 2), (2, 0)].map(|(m, n)| segment(from, corners[m], corners[n]));
    ab.or(bc).or(ca)
}
