//! Exchange of a window: receives and checks samples and geometry, and sends mapped fields and
//! iterates.

use super::Session;
use super::fields::{FieldIndex, FieldPublisher, MappingIndex, MovingIndex, PartIndex};
use super::geometry::MovingGrid;
use super::live::{ParticipantLiveValue, within};
use super::mapping::MappingError;
use crate::error::{Failure, RunError};
use crate::peers::Phase;
use crate::plan::{warn_of_coverage, warn_of_missing_areas};
use contract::field::Mapping;
use contract::grid::Grid;
use contract::step::Step;
use coupling::{Part, ParticipantIndex};
use proto::model::first_non_finite;
use proto::transport::TransportError;
use typed_index_collections::TiVec;

impl Session {
    /// Receives the samples that a participant has published for a step: its outputs, or its
    /// observed fields. Expects exactly one sample of each, on the current grid.
    pub(super) fn collect(
        &mut self,
        participant: ParticipantIndex,
        step: &Step,
        observed_only: bool,
    ) -> Result<(), RunError> {
        for index in self.fields.keys() {
            let field = &self.fields[index];
            if field.producer != participant || field.observed_only != observed_only {
                continue;
            }
            let received =
                field.reader.receive().map_err(|e| self.peers.transport_failed(participant, e))?;
            let Some(sample) = received else {
                let what = format!("it did not send `{}`", field.kind.name);
                return Err(self.peers.misbehaved(participant, what));
            };
            self.follow(index);
            let field = &self.fields[index];
            if let Some(fault) = field.fault(&sample, step) {
                return Err(self.peers.misbehaved(participant, fault));
            }
            self.bytes_exchanged += std::mem::size_of_val(sample.values()) as u64;
            if let (Some(recorder), Some(topic)) = (self.peers.recorder(), field.recorded) {
                recorder.sample(topic, sample.header().sequence);
            }
            self.fields[index].sample = Some(sample);
        }
        Ok(())
    }

    /// Moves a field to its current grid, before its sample is replaced.
    fn follow(&mut self, index: FieldIndex) {
        let Self { fields, moving, .. } = self;
        let field = &mut fields[index];
        if let Some(grid) = field.moving.map(|at| &moving[at].grid)
            && grid.revision != field.grid.revision
        {
            field.move_to(grid);
        }
    }

    /// Checks that every value of the newest sample is finite, once for each sample.
    pub(super) fn check_finite(&mut self, index: FieldIndex) -> Result<(), RunError> {
        let field = &mut self.fields[index];
        let Some(sample) = &field.sample else { return Ok(()) };
        let header = sample.header();
        if field.checked == header.sequence {
            return Ok(());
        }
        field.checked = header.sequence;
        match first_non_finite(sample.values()) {
            None => Ok(()),
            Some(at) => {
                let what = format!(
                    "field `{}` holds {} at index {at}",
                    field.kind.name,
                    sample.values()[at]
                );
                Err(RunError::Failed(Failure {
                    who: self.peers.all()[field.producer].who(),
                    when: Phase::Solving(header.step()).to_string(),
                    what,
                    fix: "see its messages in log.jsonl, and check the case's values".to_owned(),
                }))
            }
        }
    }

    /// Returns the moving grid of this name of a participant, if there is one.
    pub(super) fn moving_grid(
        &self,
        participant: ParticipantIndex,
        grid: &str,
    ) -> Option<MovingIndex> {
        let is = |m: &MovingGrid| m.participant == participant && m.grid.name == grid;
        self.moving.position(is)
    }

    /// Checks that the geometry of every volume of a participant has arrived.
    pub(super) fn check_volumes(&self, participant: ParticipantIndex) -> Result<(), RunError> {
        let mut own = self.moving.iter().filter(|moving| moving.participant == participant);
        own.find(|moving| moving.grid.is_announced()).map_or(Ok(()), |moving| {
            let what = format!("it did not send the geometry of its volume `{}`", moving.grid.name);
            Err(self.peers.misbehaved(participant, what))
        })
    }

    /// Returns the grid of a field in the next window.
    fn current_grid(&self, field: FieldIndex) -> &Grid {
        let field = &self.fields[field];
        field.moving.map_or(&field.grid, |index| &self.moving[index].grid)
    }

    /// Stores the grids of the samples of an accepted window.
    pub(super) fn keep_geometry(&mut self) {
        for MovingGrid { grid, last, .. } in &mut self.moving {
            if grid.revision != last.revision {
                last.clone_from(grid);
            }
        }
    }

    /// Receives all geometry that a participant has published.
    pub(super) fn receive_geometry(
        &mut self,
        participant: ParticipantIndex,
        step: &Step,
    ) -> Result<(), RunError> {
        for index in self.moving.keys() {
            if self.moving[index].participant == participant {
                while self.receive_one(index, step)? {}
            }
        }
        Ok(())
    }

    /// Receives the geometry of a grid up to this revision, which is that of the last window.
    pub(super) fn receive_last(
        &mut self,
        index: MovingIndex,
        revision: u64,
        step: &Step,
    ) -> Result<(), RunError> {
        while self.moving[index].grid.revision < revision && self.receive_one(index, step)? {}
        let MovingGrid { participant, grid, last, .. } = &mut self.moving[index];
        if grid.revision != revision {
            let (participant, name, found) = (*participant, grid.name.clone(), grid.revision);
            let what = format!("it restored grid `{name}` in revision {found}, not {revision}");
            return Err(self.peers.misbehaved(participant, what));
        }
        last.clone_from(grid);
        Ok(())
    }

    fn receive_one(&mut self, index: MovingIndex, step: &Step) -> Result<bool, RunError> {
        let moving = &mut self.moving[index];
        let participant = moving.participant;
        let received = moving.reader.receive();
        let Some(sample) = received.map_err(|e| self.peers.transport_failed(participant, e))?
        else {
            return Ok(false);
        };
        let moving = &mut self.moving[index];
        let moved = moving.moved(&sample, step);
        moving.sequence += 1;
        if let (Some(recorder), Some(topic)) = (self.peers.recorder(), moving.recorded) {
            recorder.sample(topic, sample.header().sequence);
        }
        self.bytes_exchanged += std::mem::size_of_val(sample.values()) as u64;
        let moved = moved.map_err(|fault| self.peers.misbehaved(participant, fault))?;
        self.move_grid(index, moved)?;
        Ok(true)
    }

    /// Replaces a grid, also for the fields that the coordinator itself sends on it.
    fn move_grid(&mut self, index: MovingIndex, moved: Grid) -> Result<(), RunError> {
        if moved.points() != self.moving[index].grid.points() {
            self.check_growth(index, &moved)?;
        }
        let Self { moving, fields, coupled, mapped, .. } = self;
        for coupled in coupled.iter_mut().filter(|f| fields[f.field].moving == Some(index)) {
            coupled.move_to(&moved);
        }
        for mapped in mapped.iter_mut().filter(|m| m.moving == Some(index)) {
            mapped.move_to(&moved);
        }
        let (role, grid, revision) = (&moving[index].role, &moved.name, moved.revision);
        tracing::debug!(role, grid, revision, points = moved.points(), "grid moved");
        moving[index].grid = moved;
        Ok(())
    }

    /// Checks that coupling data and measured data keep their length, and that all other fields
    /// have room in shared memory.
    fn check_growth(&mut self, index: MovingIndex, moved: &Grid) -> Result<(), RunError> {
        let MovingGrid { participant, grid, capacity, .. } = &self.moving[index];
        let compared = self
            .compared_fields()
            .map(|field| &self.fields[field])
            .find(|field| field.moving == Some(index));
        if let Some(field) = compared {
            let (name, from, to) = (&grid.name, grid.points(), moved.points());
            return Err(RunError::Failed(Failure {
                who: self.peers.all()[*participant].who(),
                when: self.peers.phase.to_string(),
                what: format!(
                    "grid `{name}` has changed from {from} to {to} elements, but `{}` on it is \
                     compared between iterations",
                    field.kind.name
                ),
                fix: "keep the number of its elements, or use a scheme that does not iterate the \
                      field, and no tolerance of its own"
                    .to_owned(),
            }));
        }
        if moved.points() <= *capacity {
            return Ok(());
        }
        // The transport replaces a segment that is too small by one of at least twice the size.
        let capacity = moved.points().next_power_of_two();
        let sent =
            self.fields.iter().filter(|field| field.moving == Some(index)).map(|field| &field.kind);
        let mapped = self.mapped.iter().filter(|mapped| mapped.moving == Some(index));
        let kinds = sent.chain(mapped.map(|mapped| &self.fields[mapped.field].kind));
        let components: Vec<u32> = kinds.map(|kind| kind.components).collect();
        self.memory.take(capacity, &components, &self.peers.phase.to_string())?;
        self.moving[index].capacity = capacity;
        Ok(())
    }

    /// Builds the mappings, and logs their coverage.
    pub(super) fn make_mappings(&mut self) -> Result<(), RunError> {
        for index in self.mapped.keys() {
            let Self { mapped, fields, .. } = self;
            let mapping = &mut mapped[index];
            let made =
                mapping.mapping.between(fields[mapping.field].grid(), &mapping.grid).map(|_| ());
            made.map_err(|error| self.not_mapped(index, &error.into()))?;
            self.tell_coverage(index);
        }
        Ok(())
    }

    /// Logs the coverage of a mapping after it has been built, and warns if it has become poor.
    fn tell_coverage(&mut self, index: MappingIndex) {
        let Self { mapped, fields, peers, warnings, .. } = self;
        let mapping = &mut mapped[index];
        let (before, covered) = mapping.reported;
        let Some(coverage) =
            mapping.mapping.coverage().filter(|_| mapping.mapping.builds() != before)
        else {
            return;
        };
        mapping.reported = (mapping.mapping.builds(), coverage);
        let kind = fields[mapping.field].kind();
        for grid in [fields[mapping.field].grid(), &mapping.grid] {
            if before == 0 && kind.mapping == Mapping::Conservative && !grid.has_areas() {
                let warning = warn_of_missing_areas(&kind.name, &grid.name);
                tracing::warn!("{warning}");
                warnings.push(warning);
            }
        }
        let (field, role) =
            (&fields[mapping.field].kind().name, peers.all()[mapping.reader.participant].role());
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

    /// Logs the number of builds of each mapping that has followed its grids.
    pub(super) fn tell_mappings(&self) {
        for mapping in self.mapped.iter().filter(|mapping| mapping.mapping.builds() > 1) {
            let field = self.fields[mapping.field].kind().name.as_str();
            let role = self.peers.all()[mapping.reader.participant].role();
            tracing::info!(field, role, times = mapping.mapping.builds(), "mapping made");
        }
    }

    /// Sends the newest mapped samples to the participants that are about to solve.
    pub(super) fn send_mapped(
        &mut self,
        participants: &[ParticipantIndex],
    ) -> Result<(), RunError> {
        for index in self.mapped.keys() {
            let Self { mapped, fields, .. } = self;
            let mapping = &mut mapped[index];
            let field = &fields[mapping.field];
            let due = mapping.part.is_none() && participants.contains(&mapping.reader.participant);
            let (Some(sample), true) = (&field.sample, due && field.sequence() != mapping.seen)
            else {
                continue;
            };
            let header = sample.header();
            mapping.seen = header.sequence;
            let sent = mapping.send(field.kind(), field.grid(), sample.values(), &header.step());
            self.bytes_exchanged += sent.map_err(|error| self.not_mapped(index, &error))?;
            self.tell_coverage(index);
        }
        Ok(())
    }

    /// Maps an iterate of the coupling data for consumers with a non-matching grid.
    fn send_mapped_iterate(
        &mut self,
        part: PartIndex,
        values: &[f64],
        step: &Step,
    ) -> Result<(), RunError> {
        for index in self.mapped.keys() {
            if self.mapped[index].part != Some(part) {
                continue;
            }
            let Self { mapped, fields, moving, .. } = self;
            let mapping = &mut mapped[index];
            let field = &fields[mapping.field];
            let source = field.moving.map_or(&field.grid, |at| &moving[at].grid);
            let sent = mapping.send(field.kind(), source, values, step);
            self.bytes_exchanged += sent.map_err(|error| self.not_mapped(index, &error))?;
            self.tell_coverage(index);
        }
        Ok(())
    }

    fn not_mapped(&self, index: MappingIndex, error: &MappingError) -> RunError {
        let mapping = &self.mapped[index];
        let (field, role) = (
            &self.fields[mapping.field].kind.name,
            self.peers.all()[mapping.reader.participant].role(),
        );
        let fix = match error {
            MappingError::Map(_) => {
                let producer = &self.fields[mapping.field].producer_role;
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

    /// Sends the live values of a window, once.
    pub(super) fn send_live(&mut self, step: &Step) -> Result<(), RunError> {
        let sent = self.live.send(step).map_err(|error| self.not_sent(&error))?;
        self.bytes_exchanged += sent;
        Ok(())
    }

    /// Notes the live values with which these participants are about to solve: iterates of the
    /// coupling where there are any, otherwise the newest samples.
    pub(super) fn note_live(&mut self, participants: &[ParticipantIndex]) {
        let Self { live, fields, coupled, .. } = self;
        for provided in &mut live.provided {
            if provided.readers.iter().any(|reader| participants.contains(reader)) {
                let iterate = coupled.iter().find(|coupled| coupled.field == provided.field);
                let newest = || fields[provided.field].values()?.first().copied();
                provided.used = iterate.and_then(|coupled| coupled.first).or_else(newest);
            }
        }
    }

    /// Checks that the live values sent by participants in a window are within the limits of the
    /// case.
    pub(super) fn check_live(&self) -> Result<(), RunError> {
        for ParticipantLiveValue { field, limits, .. } in &self.live.provided {
            let field = &self.fields[*field];
            let Some(value) = field.values().and_then(|values| values.first()) else { continue };
            if !within(*limits, *value) {
                let ([least, most], key) = (limits, &field.kind.name);
                return Err(RunError::Failed(Failure {
                    who: self.peers.all()[field.producer].who(),
                    when: self.peers.phase.to_string(),
                    what: format!(
                        "it sent the value {value} of `{key}`, which is not between {least} and {most}"
                    ),
                    fix: format!(
                        "widen the limits of `{key}`, or find out why it sends this value"
                    ),
                }));
            }
        }
        Ok(())
    }

    /// Waits until the consumers have subscribed to the topics of the coordinator.
    pub(super) fn wait_for_readers(&self) -> Result<(), RunError> {
        let deadline = std::time::Instant::now() + self.peers.deadlines().start;
        let iterates = self.coupled.iter().filter_map(|coupled| coupled.publisher.as_ref());
        let publishers = iterates.chain(self.mapped.iter().map(|mapped| mapped.publisher()));
        let mut publishers = publishers.chain(self.live.sent.iter().map(|sent| &sent.publisher));
        let waited = publishers.try_for_each(|publisher| publisher.wait_for_subscribers(deadline));
        waited.map_err(|error| self.not_sent(&error))
    }

    /// Returns the parts of the coupling vector: the fields of the coupling data, then those that
    /// are only measured, each in the order of the plan.
    pub(super) fn coupling_parts(&self) -> TiVec<PartIndex, Part> {
        let fields = self.compared_fields().map(|index| {
            let field = &self.fields[index];
            (field.kind.name.as_str(), field.values().map_or(0, <[f64]>::len))
        });
        coupling::parts(fields).into()
    }

    fn compared_fields(&self) -> impl Iterator<Item = FieldIndex> + '_ {
        self.coupled.iter().map(|coupled| coupled.field).chain(self.measured.iter().copied())
    }

    /// Sends the iterate of a step to all of its consumers.
    pub(super) fn send_iterate(&mut self, iterate: &[f64], step: &Step) -> Result<(), RunError> {
        for index in self.coupled.keys() {
            let field = self.coupled[index].field;
            let values = &iterate[self.parts[index].range.clone()];
            self.coupled[index].first = values.first().copied();
            if self.coupled[index].publisher.is_some() {
                let power = self.fields[field].is_power();
                let grid = self.current_grid(field);
                let integral = (power && grid.has_areas()).then(|| grid.integrate(values));
                self.coupled[index].integral = integral;
            }
            if let Some(publisher) = &mut self.coupled[index].publisher {
                let sent = publish(publisher, values, step);
                self.bytes_exchanged += sent.map_err(|error| self.not_sent(&error))?;
            }
            self.send_mapped_iterate(index, values, step)?;
        }
        Ok(())
    }

    /// Copies the newest samples of coupling data and measured data.
    pub(super) fn copy_returned(&self, returned: &mut [f64]) {
        for (field, part) in self.compared_fields().zip(&self.parts) {
            let values = self.fields[field].values();
            let values = values.expect("a compared field has its first values");
            returned[part.range.clone()].copy_from_slice(values);
        }
    }

    fn not_sent(&self, error: &TransportError) -> RunError {
        RunError::Failed(Failure {
            who: "the exchange of fields".to_owned(),
            when: self.peers.phase.to_string(),
            what: error.to_string(),
            fix: error.advice("a participant"),
        })
    }
}

/// Sends an iterate on its producer's grid and returns its size [byte].
fn publish(
    publisher: &mut FieldPublisher,
    values: &[f64],
    step: &Step,
) -> Result<u64, TransportError> {
    let mut loan = publisher.loan()?;
    loan.values().copy_from_slice(values);
    publisher.publish(loan, step)?;
    Ok(std::mem::size_of_val(values) as u64)
}
