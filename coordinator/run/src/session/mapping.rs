//! Mapped fields: the coordinator maps them from their producer's grid to that of a consumer, and
//! sends them on.
//!
//! Each such consumer has one topic, `field/coordinator/NAME/ROLE`, with its own sequence numbers.
//! Coupling data are accelerated on their producer's grid and then mapped. All other fields are
//! mapped once, from the newest sample, when their consumer is about to solve. If either grid
//! moves, the mapping is rebuilt between the current grids, and only then.

use super::fields::{Consumer, FieldIndex, FieldPublisher, MovingIndex, PartIndex};
use crate::peers::COORDINATOR;
use contract::field::FieldKind;
use contract::grid::Grid;
use contract::step::Step;
use coupling::map::{Coverage, CurrentMapping, MapError};
use proto::transport::TransportError;

/// A field that is mapped for one consumer.
#[derive(Debug)]
pub(super) struct FieldMapping {
    /// Field that the producer sends.
    pub(super) field: FieldIndex,
    /// Index in the coupling data, if the consumer subscribes to the iterates.
    pub(super) part: Option<PartIndex>,
    pub(super) reader: Consumer,
    /// Surface integral of the last sample, if the mapping conserves it.
    pub(super) integral: Option<Integral>,
    /// Index of the consumer's grid among the moving grids, if it moves.
    pub(super) moving: Option<MovingIndex>,
    pub(super) grid: Grid,
    pub(super) mapping: CurrentMapping,
    /// Number of builds at the last report of the coverage, and this coverage.
    pub(super) reported: (u64, Coverage),
    /// Sequence number of the producer's sample that was mapped last.
    pub(super) seen: u64,
    pub(super) publisher: FieldPublisher,
}

/// Surface integral of a conservative field that has been mapped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Integral {
    /// Integral on the producer's grid, the power; `None` for a vector.
    pub(super) sent: Option<f64>,
    /// Relative change of the integral by the mapping, see
    /// [`coupling::map::GridMapping::imbalance`].
    pub(super) imbalance: f64,
}

/// Reason why a field could not be mapped and sent.
#[derive(Debug, thiserror::Error)]
pub(super) enum MappingError {
    #[error(transparent)]
    Map(#[from] MapError),
    #[error(transparent)]
    Transport(#[from] TransportError),
}

impl FieldMapping {
    /// Maps the next samples to this grid, the consumer's current one.
    pub(super) fn move_to(&mut self, grid: &Grid) {
        self.grid.clone_from(grid);
        self.publisher.move_to(grid);
    }

    /// Returns the name of the service for a field that is mapped for a role.
    pub(super) fn service(field: &str, role: &str) -> String {
        format!("field/{COORDINATOR}/{field}/{role}")
    }

    pub(super) fn publisher(&self) -> &FieldPublisher {
        &self.publisher
    }

    /// Maps values of the field on this grid, sends them, and returns their size [byte].
    pub(super) fn send(
        &mut self,
        kind: &FieldKind,
        source: &Grid,
        values: &[f64],
        step: &Step,
    ) -> Result<u64, MappingError> {
        let mapping = self.mapping.between(source, &self.grid)?;
        let mut loan = self.publisher.loan()?;
        let target = loan.values();
        mapping.apply(values, target);
        let bytes = std::mem::size_of_val(target) as u64;
        self.integral = mapping.conserves().then(|| Integral {
            sent: (kind.components == 1).then(|| source.integrate(values)),
            imbalance: mapping.imbalance(values, target),
        });
        self.publisher.publish(loan, step)?;
        Ok(bytes)
    }
}
