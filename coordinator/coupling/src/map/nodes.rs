//! Nodes of a grid, the places of its values: element centres of a surface, or vertices.

use super::patch::{Patch, Row, Vector};

/// The point of a grid nearest to a given point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    /// Node at the foot: the element that contains it, or the nearest corner.
    pub(super) node: usize,
    /// Position [m]. In a grid without connectivity it is the given point itself.
    pub(super) point: Vector,
    /// Distance of the given point beyond the border, along the surface [m]; 0 if the point is
    /// inside, or if the grid has no connectivity.
    pub(super) outside: f64,
}

/// Directions in which the interpolant on a stencil may vary.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    /// Maximum number of principal directions.
    pub(super) directions: usize,
    /// Fraction of the largest extent below which an extent counts as zero.
    pub(super) flat: f64,
    /// Whether a point beyond the stencil takes the value at the edge of the stencil's box.
    pub(super) bounded: bool,
}

/// Places of the values of a grid.
pub(super) trait Nodes {
    /// Returns the positions [m].
    fn places(&self) -> &[Vector];

    /// Returns the typical distance between the node and its neighbours [m].
    fn size(&self, node: usize) -> f64;

    /// Returns the nearest point of the grid.
    fn foot(&self, from: Vector) -> Foot;

    /// Adds the nodes from which the stencil of an interpolant grows.
    fn seeds(&self, foot: &Foot, stencil: &mut Vec<u32>);

    /// Adds the neighbours of a node; some may occur twice.
    fn ring(&self, node: u32, ring: &mut Vec<u32>);

    /// Returns the directions of interpolants.
    fn span(&self) -> Span;

    /// Returns the patches between the nodes; `None` in a grid without connectivity.
    fn patches(&self) -> Option<Vec<Patch>>;
}

/// Weights of one mapping method on one source grid.
pub(super) trait MappingWeights {
    /// Adds the weights of one target, up to a common factor; none if the method has no result.
    fn weigh(&mut self, target: &Target, row: &mut Row);

    /// Whether a target exactly at a node takes its value directly.
    const OF_POINTS: bool = true;
}

/// A target element or vertex with its position on the source.
pub(super) struct Target {
    /// Index on its own grid.
    pub(super) index: usize,
    /// Position [m].
    pub(super) place: Vector,
    /// Nearest point of the source.
    pub(super) foot: Foot,
    /// Whether the foot is exactly at its node.
    pub(super) at_node: bool,
}
