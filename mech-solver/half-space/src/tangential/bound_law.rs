//! Traction bounds that depend on the solution: on the creepages, or on the slip of the elements.

use super::state::Creepage;
use std::fmt::{self, Debug, Formatter};

/// Law of the traction bounds of a contact, apart from a yielding layer.
pub trait BoundLaw {
    /// Quantities on which the bounds depend.
    fn arguments(&self) -> Arguments;

    /// Writes the bound g of every element [Pa] at these creepages and at the slip distance |S| of
    /// every element in the step, 0 in adhesion [m].
    fn evaluate(&self, creepage: Creepage, slip: &[f64], bound: &mut [f64]);
}

impl Debug for dyn BoundLaw + '_ {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        write!(formatter, "bounds that depend on {:?}", self.arguments())
    }
}

/// Quantities on which traction bounds depend.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Arguments {
    /// Creepages, through the slip of rigid bodies.
    pub creepage: bool,
    /// Slip of each element.
    pub slip: bool,
}
