//! Nearest neighbour: the value of the nearest element centre.
//!
//! Centres that are equally near share the target equally: the mapping does not depend on how the
//! elements are numbered, and a mirrored field stays mirrored when one grid halves the other.

use super::operator::Row;
use super::surface::Surface;
use super::vector::COINCIDENT;
use super::weigh::{Target, Weigh};
use rstar::primitives::GeomWithData;
use rstar::{PointDistance, RTree};

/// Element centres by place.
pub(super) struct Nearest<'a> {
    surface: &'a Surface,
    tree: RTree<GeomWithData<[f64; 3], u32>>,
}

impl<'a> Nearest<'a> {
    pub(super) fn new(surface: &'a Surface) -> Self {
        let centres = surface.centres.iter().enumerate();
        let leaves = centres.map(|(n, centre)| GeomWithData::new((*centre).into(), n as u32));
        Self { surface, tree: RTree::bulk_load(leaves.collect()) }
    }
}

impl Weigh for Nearest<'_> {
    fn weigh(&mut self, target: &Target, row: &mut Row) {
        let from: [f64; 3] = target.centre.into();
        let Some(leaf) = self.tree.nearest_neighbor(from) else { return };
        let reach =
            leaf.distance_2(&from).sqrt() + COINCIDENT * self.surface.size(leaf.data as usize);
        let equal = self.tree.locate_within_distance(from, reach * reach);
        row.extend(equal.map(|leaf| (leaf.data, 1.0)));
    }
}
