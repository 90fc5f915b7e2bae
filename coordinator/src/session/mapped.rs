//! Fields that are mapped: the coordinator takes them from their producer's grid to that of a
//! consumer, and sends them on.
//!
//! One topic for each such consumer, `field/coordinator/NAME/ROLE`, with sequence numbers of its own.
//! Coupling data are accelerated on their producer's grid and mapped thereafter. Everything else is
//! mapped when its consumer is about to solve, from the newest sample, once. Where the grid of either
//! side moves, the mapping is that between the grids as they are, and rebuilt only then.

use super::outlet::Outlet;
use super::tap::Consumer;
use super::{COORDINATOR, Session};
use crate::error::{Failure, RunError};
use crate::map::{Coverage, CurrentMapping, MapError, Method};
use proto::field::{FieldKind, Mapping};
use proto::grid::Grid;
use proto::model::Step;
use proto::transport::TransportError;

/// One field for one consumer.
#[derive(Debug)]
pub(super) struct Mapped {
    /// Index of its tap.
    pub(super) tap: usize,
    /// Index within the coupling data, if the consumer subscribes to the iterates.
    pub(super) part: Option<usize>,
    pub(super) reader: Consumer,
    /// What the last sample has of a field whose integral is kept.
    pub(super) heat: Option<Heat>,
    /// Index of the consumer's grid among those that move, if it does.
    pub(super) moving: Option<usize>,
    grid: Grid,
    mapping: CurrentMapping,
    /// Its coverage was reported when it had been built so many times.
    reported: (u64, Coverage),
    /// Sequence number of the producer's sample that was mapped last.
    seen: u64,
    outlet: Outlet,
}

/// A conservative field before and after.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Heat {
    /// Surface integral on the producer's grid.
    pub(super) sent: f64,
    /// What the mapping has changed of it, see [`crate::map::GridMapping::imbalance`].
    pub(super) imbalance: f64,
}

/// Why a field could not be mapped and sent.
#[derive(Debug, thiserror::Error)]
enum MappingError {
    #[error(transparent)]
    Map(#[from] MapError),
    #[error(transparent)]
    Transport(#[from] TransportError),
}

impl Mapped {
    pub(super) fn new(
        (tap, part): (usize, Option<usize>),
        (kind, grid, moving): (&FieldKind, &Grid, Option<usize>),
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
    fn send(
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

impl Session {
    /// Makes the mappings, and says what they cover.
    pub(super) fn make_mappings(&mut self) -> Result<(), RunError> {
        for index in 0..self.mapped.len() {
            let Self { mapped, taps, .. } = self;
            let one = &mut mapped[index];
            let made = one.mapping.between(taps[one.tap].grid(), &one.grid).map(|_| ());
            made.map_err(|error| self.not_mapped(index, &error.into()))?;
            self.tell_coverage(index);
        }
        Ok(())
    }

    /// Says what a mapping covers: when it is made, and when it has become poor.
    fn tell_coverage(&mut self, index: usize) {
        let Self { mapped, taps, links, .. } = self;
        let one = &mut mapped[index];
        let (before, covered) = one.reported;
        let Some(coverage) = one.mapping.coverage().filter(|_| one.mapping.builds() != before)
        else {
            return;
        };
        one.reported = (one.mapping.builds(), coverage);
        let (field, role) = (&taps[one.tap].kind().name, links[one.reader.participant].role());
        match coverage.is_poor() {
            true if !covered.is_poor() => {
                tracing::warn!("`{field}` mapped for {role}: {coverage}");
            }
            _ if before == 0 => tracing::info!("`{field}` mapped for {role}: {coverage}"),
            _ => tracing::debug!("`{field}` mapped for {role} again: {coverage}"),
        }
    }

    /// Says how many times the mappings were made that have followed their grids.
    pub(super) fn tell_mappings(&self) {
        for one in self.mapped.iter().filter(|one| one.mapping.builds() > 1) {
            let field = self.taps[one.tap].kind().name.as_str();
            let role = self.links[one.reader.participant].role();
            tracing::info!(field, role, times = one.mapping.builds(), "mapping made");
        }
    }

    /// Sends the participants that are about to solve the newest samples of what is mapped for
    /// them.
    pub(super) fn send_mapped(&mut self, participants: &[usize]) -> Result<(), RunError> {
        for index in 0..self.mapped.len() {
            let Self { mapped, taps, .. } = self;
            let one = &mut mapped[index];
            let tap = &taps[one.tap];
            let due = one.part.is_none() && participants.contains(&one.reader.participant);
            let (Some(sample), true) = (&tap.sample, due && tap.sequence() != one.seen) else {
                continue;
            };
            let header = sample.header();
            let step = Step {
                window: header.window,
                iteration: header.iteration,
                start: header.start,
                end: header.end,
            };
            one.seen = header.sequence;
            let sent = one.send((tap.kind(), tap.grid()), sample.values(), &step);
            self.bytes_exchanged += sent.map_err(|error| self.not_mapped(index, &error))?;
            self.tell_coverage(index);
        }
        Ok(())
    }

    /// Maps an iterate of the coupling data for consumers with a non-matching grid.
    pub(super) fn send_mapped_iterate(
        &mut self,
        part: usize,
        values: &[f64],
        step: &Step,
    ) -> Result<(), RunError> {
        for index in 0..self.mapped.len() {
            if self.mapped[index].part != Some(part) {
                continue;
            }
            let Self { mapped, taps, moving, .. } = self;
            let one = &mut mapped[index];
            let tap = &taps[one.tap];
            let source = tap.moving.map_or(&tap.grid, |at| &moving[at].grid);
            let sent = one.send((tap.kind(), source), values, step);
            self.bytes_exchanged += sent.map_err(|error| self.not_mapped(index, &error))?;
            self.tell_coverage(index);
        }
        Ok(())
    }

    fn not_mapped(&self, index: usize, error: &MappingError) -> RunError {
        let one = &self.mapped[index];
        let (field, role) =
            (&self.taps[one.tap].kind.name, self.links[one.reader.participant].role());
        RunError::Failed(Failure {
            who: format!("the mapping of `{field}` for {role}"),
            when: self.phase.to_string(),
            what: error.to_string(),
            fix: "see log.jsonl; a participant may have left its inputs unread".to_owned(),
        })
    }
}
