//! The mappings of a run: made, applied when their consumers are about to solve, and what they cover.

use super::Session;
use super::index::{MappedIndex, PartIndex};
use super::mapped::MappingError;
use crate::error::{Failure, RunError};
use crate::plan::warn_of_coverage;
use contract::step::Step;
use coupling::ParticipantIndex;

impl Session {
    /// Makes the mappings, and says what they cover.
    pub(super) fn make_mappings(&mut self) -> Result<(), RunError> {
        for index in self.mapped.keys() {
            let Self { mapped, taps, .. } = self;
            let one = &mut mapped[index];
            let made = one.mapping.between(taps[one.tap].grid(), &one.grid).map(|_| ());
            made.map_err(|error| self.not_mapped(index, &error.into()))?;
            self.tell_coverage(index);
        }
        Ok(())
    }

    /// Says what a mapping covers: when it is made, and when it has become poor.
    fn tell_coverage(&mut self, index: MappedIndex) {
        let Self { mapped, taps, peers, warnings, .. } = self;
        let one = &mut mapped[index];
        let (before, covered) = one.reported;
        let Some(coverage) = one.mapping.coverage().filter(|_| one.mapping.builds() != before)
        else {
            return;
        };
        one.reported = (one.mapping.builds(), coverage);
        let (field, role) =
            (&taps[one.tap].kind().name, peers.all()[one.reader.participant].role());
        match coverage.is_poor() {
            true if !covered.is_poor() => {
                let warning = warn_of_coverage(field, role, &coverage);
                tracing::warn!("{warning}");
                warnings.push(warning);
            }
            _ if before == 0 => tracing::info!("`{field}` mapped for {role}: {coverage}"),
            _ => tracing::debug!("`{field}` mapped for {role} again: {coverage}"),
        }
    }

    /// Says how many times the mappings were made that have followed their grids.
    pub(super) fn tell_mappings(&self) {
        for one in self.mapped.iter().filter(|one| one.mapping.builds() > 1) {
            let field = self.taps[one.tap].kind().name.as_str();
            let role = self.peers.all()[one.reader.participant].role();
            tracing::info!(field, role, times = one.mapping.builds(), "mapping made");
        }
    }

    /// Sends the participants that are about to solve the newest samples of what is mapped for
    /// them.
    pub(super) fn send_mapped(
        &mut self,
        participants: &[ParticipantIndex],
    ) -> Result<(), RunError> {
        for index in self.mapped.keys() {
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
        part: PartIndex,
        values: &[f64],
        step: &Step,
    ) -> Result<(), RunError> {
        for index in self.mapped.keys() {
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

    fn not_mapped(&self, index: MappedIndex, error: &MappingError) -> RunError {
        let one = &self.mapped[index];
        let (field, role) =
            (&self.taps[one.tap].kind.name, self.peers.all()[one.reader.participant].role());
        let fix = match error {
            MappingError::Map(_) => {
                let producer = &self.taps[one.tap].producer_role;
                format!("correct the grids of {producer} and {role}")
            }
            MappingError::Transport(error) => error.advice(role),
        };
        RunError::Failed(Failure {
            who: format!("the mapping of `{field}` for {role}"),
            when: self.peers.phase.to_string(),
            what: error.to_string(),
            fix,
        })
    }
}
