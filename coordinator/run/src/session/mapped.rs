//! Fields that are mapped: the coordinator takes them from their producer's grid to that of a
//! consumer, and sends them on.
//!
//! One topic for each such consumer, `field/coordinator/NAME/ROLE`, with sequence numbers of its own.
//! Coupling data are accelerated on their producer's grid and mapped thereafter. Everything else is
//! mapped when its consumer is about to solve, from the newest sample, once. Where the grid of either
//! side moves, the mapping is that between the grids as they are, and rebuilt only then.

use super::index::{MovingIndex, PartIndex, TapIndex};
use super::outlet::Outlet;
use super::tap::Consumer;
use crate::peers::COORDINATOR;
use contract::field::{FieldKind, Mapping};
use contract::grid::Grid;
use contract::step::Step;
use coupling::map::{Coverage, CurrentMapping, MapError, Method};
use proto::transport::TransportError;

/// One field for one consumer.
#[derive(Debug)]
pub(super) struct Mapped {
    /// Index of its tap.
    pub(super) tap: TapIndex,
    /// Index within the coupling data, if the consumer subscribes to the iterates.
    pub(super) part: Option<PartIndex>,
    pub(super) reader: Consumer,
    /// What the last sample has of a field whose integral is kept.
    pub(super) heat: Option<Heat>,
    /// Index of the consumer's grid among those that move, if it does.
    pub(super) moving: Option<MovingIndex>,
    pub(super) grid: Grid,
    pub(super) mapping: CurrentMapping,
    /// Its coverage was reported when it had been built so many times.
    pub(super) reported: (u64, Coverage),
    /// Sequence number of the producer's sample that was mapped last.
    pub(super) seen: u64,
    outlet: Outlet,
}

/// A conservative field before and after.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Heat {
    /// Surface integral on the producer's grid.
    pub(super) sent: f64,
    /// What the mapping has changed of it, see [`coupling::map::GridMapping::imbalance`].
    pub(super) imbalance: f64,
}

/// Why a field could not be mapped and sent.
#[derive(Debug, thiserror::Error)]
pub(super) enum MappingError {
    #[error(transparent)]
    Map(#[from] MapError),
    #[error(transparent)]
    Transport(#[from] TransportError),
}

impl Mapped {
    pub(super) fn new(
        (tap, part): (TapIndex, Option<PartIndex>),
        (kind, grid, moving): (&FieldKind, &Grid, Option<MovingIndex>),
        method: Method,
        reader: Consumer,
        outlet: Outlet,
    ) -> Self {
        let mapping = CurrentMapping::new(method, kind.mapping);
        let (grid, reported) = (grid.clone(), (0, Coverage::default()));
        Self { tap, part, reader, heat: None, moving, grid, mapping, reported, seen: 0, outlet }
    }

    /// The consumer's grid has moved.
    pub(super) fn moved(&mut self, grid: &Grid) {
        self.grid.clone_from(grid);
        self.outlet.moved(grid);
    }

    /// The service on which a field travels to the role that it is mapped for.
    pub(super) fn service(field: &str, role: &str) -> String {
        format!("field/{COORDINATOR}/{field}/{role}")
    }

    pub(super) fn outlet(&self) -> &Outlet {
        &self.outlet
    }

    /// Maps values of the field on this grid and sends them; how many bytes that were.
    pub(super) fn send(
        &mut self,
        (kind, source): (&FieldKind, &Grid),
        values: &[f64],
        step: &Step,
    ) -> Result<u64, MappingError> {
        let mapping = self.mapping.between(source, &self.grid)?;
        let mut loan = self.outlet.loan()?;
        let target = loan.values();
        mapping.apply(values, target);
        let bytes = std::mem::size_of_val(target) as u64;
        self.heat = (kind.mapping == Mapping::Conservative).then(|| Heat {
            sent: source.integrate(values),
            imbalance: mapping.imbalance(values, target),
        });
        self.outlet.publish(loan, step)?;
        Ok(bytes)
    }
}
