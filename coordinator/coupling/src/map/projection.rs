//! Nearest projection: the value at the target's foot on the surface through the element centres,
//! which is the dual mesh of `surface`; bilinear on its quadrilaterals, barycentric on its
//! triangles. Beyond the outermost centres that foot is on the dual mesh's border: the value goes
//! on unchanged. Weights are never negative.

use super::operator::Row;
use super::patch::{Patch, nearest_of};
use super::surface::Surface;
use super::weigh::{Target, Weigh};
use rstar::RTree;

/// Patches of the dual mesh by place.
pub(super) struct Projection {
    tree: RTree<Patch>,
}

impl Projection {
    pub(super) fn new(surface: &Surface) -> Self {
        Self { tree: RTree::bulk_load(surface.dual()) }
    }
}

impl Weigh for Projection {
    fn weigh(&mut self, target: &Target, row: &mut Row) {
        if let Some((patch, nearest)) = nearest_of(&self.tree, target.centre) {
            patch.weigh(&nearest, row);
        }
    }
}
