//! Partition of unity: overlapping interpolants on clusters of a large source.
//!
//! A k-d tree splits the points at the median along the widest side of their box, until at most
//! [`LEAF`] points are left. Each leaf gives a ball: its centre is that of the leaf's box, and its
//! radius ϱ is [`OVERLAP`] half diagonals. The cluster consists of all points in the ball. With the
//! interpolants u_k of the clusters and Wendland's C2 function φ,
//!
//! u(x) = Σ_k φ(|x − x_k|/ϱ_k) u_k(x) / Σ_k φ(|x − x_k|/ϱ_k)
//!
//! is as smooth as the interpolants, has the values at the points, and reproduces linear functions.
//! A target in no ball has the interpolant of the cluster with the least |x − x_k|/ϱ_k. A ball
//! whose points lie on a line, as on a stretched mesh, grows while it has fewer than [`MOST`]
//! points.
//!
//! Leaves do not depend on the numbering of the points. Source: H. Wendland, *Scattered Data
//! Approximation*, Cambridge University Press (2005), chapter 15.

use super::error::MapError;
use super::interpolant::Source;
use super::nodes::Target;
use super::operator::SparseOperator;
use super::patch::{Row, Vector};
use crate::settings::Basis;
use rstar::{AABB, RTree, RTreeObject};

/// Largest number of points in a leaf.
const LEAF: usize = 32;

/// Radius of a ball over half the diagonal of its leaf's box.
const OVERLAP: f64 = 1.5;

/// Number of points at which a ball stops growing.
const MOST: usize = 4 * LEAF;

/// Growth of a ball at a time.
const GROWTH: f64 = 1.5;

/// Number of targets whose rows are computed together; it bounds the memory.
const BATCH: usize = 1 << 16;

/// Overlapping clusters of a source.
pub(super) struct Partition<'a> {
    source: &'a Source<'a>,
    clusters: Vec<Cluster>,
    tree: RTree<Ball>,
}

struct Cluster {
    centre: Vector,
    radius: f64,
    points: Vec<u32>,
}

/// The ball of a cluster in a search tree.
struct Ball {
    cluster: usize,
    bounds: AABB<[f64; 3]>,
}

impl RTreeObject for Ball {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        self.bounds
    }
}

impl<'a> Partition<'a> {
    /// Clusters the points of a source.
    pub(super) fn new(source: &'a Source<'a>) -> Self {
        let mut all: Vec<u32> = (0..source.places.len() as u32).collect();
        let directions = source.axes(&all).count.min(2);
        let mut clusters = Vec::new();
        split(source.places, &mut all, &mut |[low, high]| {
            clusters.push(Cluster::new(source, low, high, directions));
        });
        let ball = |(cluster, of): (usize, &Cluster)| {
            let reach = Vector::repeat(of.radius);
            let corners = [of.centre - reach, of.centre + reach].map(Into::into);
            Ball { cluster, bounds: AABB::from_corners(corners[0], corners[1]) }
        };
        let tree = RTree::bulk_load(clusters.iter().enumerate().map(ball).collect());
        Self { source, clusters, tree }
    }

    /// Adds the rows of all targets to a matrix.
    pub(super) fn push_rows(
        &self,
        targets: &[Target],
        operator: &mut SparseOperator,
    ) -> Result<(), MapError> {
        for batch in targets.chunks(BATCH) {
            for (mut row, target) in self.rows(batch)?.into_iter().zip(batch) {
                operator.push_or_copy(&mut row, target);
            }
        }
        Ok(())
    }

    /// Returns the weights of some targets, up to a factor for each; none for a target at a node.
    fn rows(&self, targets: &[Target]) -> Result<Vec<Row>, MapError> {
        let mut members: Vec<Vec<(usize, f64)>> = vec![Vec::new(); self.clusters.len()];
        for (n, target) in targets.iter().enumerate().filter(|(_, target)| !target.at_node) {
            for (cluster, share) in self.shares(target.foot.point) {
                members[cluster].push((n, share));
            }
        }
        let mut rows = vec![Row::new(); targets.len()];
        for (cluster, members) in self.clusters.iter().zip(members) {
            if members.is_empty() {
                continue;
            }
            let feet: Vec<Vector> = members.iter().map(|(n, _)| targets[*n].foot.point).collect();
            let interpolant = self.source.interpolant(cluster.points.clone())?;
            let weights = interpolant.rows(&feet).ok_or_else(|| self.source.singular())?;
            for ((n, share), row) in members.iter().zip(weights) {
                rows[*n].extend(row.into_iter().map(|(column, weight)| (column, share * weight)));
            }
        }
        Ok(rows)
    }

    /// Returns the clusters of a point, with their shares up to a common factor.
    fn shares(&self, point: Vector) -> Vec<(usize, f64)> {
        let around = self.tree.locate_in_envelope_intersecting(AABB::from_point(point.into()));
        let share = |ball: &Ball| {
            let share = Basis::WendlandC2.value(self.clusters[ball.cluster].distance(point));
            (ball.cluster, share)
        };
        let mut shares: Vec<_> = around.map(share).filter(|(_, share)| *share > 0.0).collect();
        if shares.is_empty() {
            let distance = |n: &usize| self.clusters[*n].distance(point);
            let nearest =
                (0..self.clusters.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            shares.extend(nearest.map(|cluster| (cluster, 1.0)));
        }
        shares
    }
}

impl Cluster {
    /// Creates the cluster around a box, whose points should span a number of directions.
    fn new(source: &Source<'_>, low: Vector, high: Vector, directions: usize) -> Self {
        let centre = 0.5 * (low + high);
        let mut radius = OVERLAP * 0.5 * (high - low).norm();
        let within = |radius: f64| -> Vec<u32> {
            let here = source.tree.locate_within_distance(centre.into(), radius * radius);
            let mut points: Vec<u32> = here.map(|leaf| leaf.data).collect();
            points.sort_unstable();
            points
        };
        let mut points = within(radius);
        while points.len() < MOST && source.axes(&points).count < directions {
            radius *= GROWTH;
            points = within(radius);
        }
        Self { centre, radius, points }
    }

    /// Returns the distance of a point from the centre, in radii.
    fn distance(&self, point: Vector) -> f64 {
        (point - self.centre).norm() / self.radius
    }
}

/// Calls `leaf` with the box of every leaf of the k-d tree.
fn split(places: &[Vector], points: &mut [u32], leaf: &mut impl FnMut([Vector; 2])) {
    let place = |n: u32| places[n as usize];
    let first = place(points[0]);
    let low = points.iter().fold(first, |low, n| low.inf(&place(*n)));
    let high = points.iter().fold(first, |high, n| high.sup(&place(*n)));
    if points.len() <= LEAF {
        return leaf([low, high]);
    }
    let axis = (high - low).imax();
    // Points differ in one of the coordinates: their order does not depend on their numbers.
    let key = |n: u32| [0, 1, 2].map(|k| place(n)[(axis + k) % 3]);
    let middle = points.len() / 2;
    points.select_nth_unstable_by(middle, |a, b| {
        let pairs = key(*a).into_iter().zip(key(*b));
        pairs.map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne()).unwrap_or(a.cmp(b))
    });
    let (lower, upper) = points.split_at_mut(middle);
    split(places, lower, leaf);
    split(places, upper, leaf);
}
