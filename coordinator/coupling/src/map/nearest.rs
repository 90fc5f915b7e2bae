//! Nearest neighbour: the value of the nearest element centre or vertex.
//!
//! Equally near nodes share the target equally. The mapping therefore does not depend on their
//! numbering, and a mirrored field stays mirrored when one grid halves the other.
//!
//! Nearest projection: the value at the target's foot on the surface through the nodes. For
//! elements this is the dual mesh of `surface`, for vertices the triangles and edges of `cloud`.
//! The value is bilinear on quadrilaterals, linear on triangles and edges. Beyond the outermost
//! nodes the foot is on the border of this surface: the value continues unchanged. Weights are
//! never negative.

use super::nodes::{MappingWeights, Nodes, Target};
use super::patch::{COINCIDENT, Patch, Row, nearest_of};
use rstar::primitives::GeomWithData;
use rstar::{PointDistance, RTree};

/// Search tree of nodes.
pub(super) struct Nearest<'a> {
    nodes: &'a dyn Nodes,
    tree: RTree<GeomWithData<[f64; 3], u32>>,
}

impl<'a> Nearest<'a> {
    pub(super) fn new(nodes: &'a dyn Nodes) -> Self {
        let places = nodes.places().iter().enumerate();
        let leaves = places.map(|(n, place)| GeomWithData::new((*place).into(), n as u32));
        Self { nodes, tree: RTree::bulk_load(leaves.collect()) }
    }
}

impl MappingWeights for Nearest<'_> {
    // Several nodes may be at one place.
    const OF_POINTS: bool = false;

    fn weigh(&mut self, target: &Target, row: &mut Row) {
        let from: [f64; 3] = target.place.into();
        let Some(leaf) = self.tree.nearest_neighbor(from) else { return };
        let reach =
            leaf.distance_2(&from).sqrt() + COINCIDENT * self.nodes.size(leaf.data as usize);
        let equal = self.tree.locate_within_distance(from, reach * reach);
        row.extend(equal.map(|leaf| (leaf.data, 1.0)));
    }
}

/// Search tree of the patches between nodes.
pub(super) struct Projection {
    tree: RTree<Patch>,
}

impl Projection {
    /// Returns the projection on nodes; `None` without connectivity.
    pub(super) fn new(nodes: &dyn Nodes) -> Option<Self> {
        nodes.patches().map(|patches| Self { tree: RTree::bulk_load(patches) })
    }
}

impl MappingWeights for Projection {
    fn weigh(&mut self, target: &Target, row: &mut Row) {
        if let Some((patch, nearest)) = nearest_of(&self.tree, target.place) {
            patch.weigh(&nearest, row);
        }
    }
}
