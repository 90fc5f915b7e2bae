//! Coupling data: the coordinator takes these fields from their producer, and sends its own
//! iterate of them to the participants that consume them.
//!
//! Only the consumers that close the loop subscribe to the coordinator; all others to the producer
//! directly. The topic is `field/coordinator/NAME`; its samples have sequence numbers of their own.
//! Consumers on a grid of their own have a topic of their own ([`super::mapped`]).

use super::index::TapIndex;
use super::outlet::Outlet;
use super::tap::Consumer;
use crate::peers::COORDINATOR;
use contract::grid::Grid;

/// One field of the coupling data.
#[derive(Debug)]
pub(super) struct Feedback {
    /// Index of its tap.
    pub(super) tap: TapIndex,
    /// The consumers which receive the iterates on the producer's grid.
    pub(super) readers: Vec<Consumer>,
    /// Surface integral of the last iterate, if its mapping conserves it.
    pub(super) heat: Option<f64>,
    /// Where they receive them; `None` if none does.
    pub(super) outlet: Option<Outlet>,
}

impl Feedback {
    pub(super) fn new(tap: TapIndex, readers: Vec<Consumer>, outlet: Option<Outlet>) -> Self {
        Self { tap, readers, heat: None, outlet }
    }

    /// The service on which the iterates of a field travel.
    pub(super) fn service(field: &str) -> String {
        format!("field/{COORDINATOR}/{field}")
    }

    /// The producer's grid has moved.
    pub(super) fn moved(&mut self, grid: &Grid) {
        if let Some(outlet) = &mut self.outlet {
            outlet.moved(grid);
        }
    }

    /// Sequence number of the newest iterate.
    pub(super) fn sequence(&self) -> u64 {
        self.outlet.as_ref().map_or(0, Outlet::sequence)
    }
}
