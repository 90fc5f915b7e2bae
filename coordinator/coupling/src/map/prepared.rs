//! A grid prepared for mappings: a surface of elements, or a cloud of vertices.

use super::cloud::Cloud;
use super::nodes::Nodes;
use super::surface::Surface;
use contract::grid::Grid;

/// A grid prepared for mappings.
#[derive(Debug)]
pub(super) enum Prepared {
    Surface(Surface),
    Cloud(Cloud),
}

impl Prepared {
    /// Prepares a grid that has passed its check; `None` for a volume and for points in blocks.
    pub(super) fn new(grid: &Grid) -> Option<Self> {
        Cloud::of(grid).map(Self::Cloud).or_else(|| Surface::of(grid).map(Self::Surface))
    }

    pub(super) fn nodes(&self) -> &dyn Nodes {
        match self {
            Self::Surface(surface) => surface,
            Self::Cloud(cloud) => cloud,
        }
    }
}
