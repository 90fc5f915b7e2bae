//! What every method does: the weights of one target element.

use super::operator::Row;
use super::surface::Foot;
use super::vector::Vector;

/// One method on one source surface.
pub(super) trait Weigh {
    /// Adds the weights of one target element, up to a common factor; none if there is no answer.
    fn weigh(&mut self, target: &Target, row: &mut Row);

    /// Whether a target in the very centre of an element is no special case.
    const OF_POINTS: bool = true;
}

/// A target element, and where it lies on the source.
pub(super) struct Target {
    /// Index on its own grid.
    pub(super) index: usize,
    /// Its centre [m].
    pub(super) centre: Vector,
    /// What of the source is nearest to it.
    pub(super) foot: Foot,
}
