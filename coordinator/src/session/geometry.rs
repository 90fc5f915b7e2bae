//! Grids that move: the coordinator subscribes to the geometry of every one that a field of the run
//! is on, or is mapped to, on `geometry/ROLE/GRID`.
//!
//! Geometry is part of the accepted state. A participant publishes it when it has accepted a window
//! (or has been restored), and replies; so it is known before anybody solves the next one, and holds
//! through all iterations of it. A run in which nothing moves has no such topic and no such reply.

use super::Session;
use crate::error::{Failure, RunError};
use crate::record::{Recorder, TopicNumber};
use proto::field::GEOMETRY;
use proto::grid::Grid;
use proto::model::Step;
use proto::transport::{Endpoint, FieldReader, FieldSample, TransportError};
use std::sync::Arc;

/// One grid that may move.
#[derive(Debug)]
pub(super) struct MovingGrid {
    /// Index of the participant whose grid it is.
    pub(super) participant: usize,
    /// As it is accepted, for the next window.
    pub(super) grid: Grid,
    /// As it was in the last window: its samples are on it.
    pub(super) last: Grid,
    /// Most points that its topics have room for.
    capacity: usize,
    role: String,
    reader: FieldReader,
    sequence: u64,
    recorded: Option<TopicNumber>,
}

impl MovingGrid {
    pub(super) fn open(
        endpoint: &Endpoint,
        (participant, role): (usize, &str),
        grid: &Grid,
        recorder: Option<&Arc<Recorder>>,
    ) -> Result<Self, TransportError> {
        let service = Self::service(role, &grid.name);
        let recorded = recorder.map(|recorder| recorder.listen(endpoint, &service)).transpose()?;
        Ok(Self {
            participant,
            grid: grid.clone(),
            last: grid.clone(),
            capacity: grid.points(),
            role: role.to_owned(),
            reader: endpoint.field_reader(&service)?,
            sequence: 0,
            recorded,
        })
    }

    /// The service on which the geometry of a role's grid travels.
    pub(super) fn service(role: &str, grid: &str) -> String {
        format!("geometry/{role}/{grid}")
    }

    /// The file of a checkpoint with the grid on which the values in it are.
    pub(super) fn file(&self) -> String {
        format!("{}.{}.geometry", self.role, self.grid.name)
    }

    /// The grid as a sample says; it has to be labelled for this step.
    fn moved(&self, sample: &FieldSample, step: &Step) -> Result<Grid, String> {
        let (header, grid) = (sample.header(), &self.grid);
        let about = format!("the geometry of grid `{}`", grid.name);
        if header.protocol != proto::PROTOCOL_VERSION {
            return Err(format!("{about} has protocol version {}", header.protocol));
        }
        let label = [&header.name.as_str(), &header.unit.as_str()];
        let place = [&header.producer.as_str(), &header.grid.as_str()];
        let expected = [&GEOMETRY.name, &GEOMETRY.unit];
        if label != expected || place != [&self.role.as_str(), &grid.name.as_str()] {
            let (label, place) = (label.map(|text| *text), place.map(|text| *text));
            return Err(format!("{about} is labelled {label:?} from {place:?}"));
        }
        if header.sequence != self.sequence + 1 {
            let (found, expected) = (header.sequence, self.sequence + 1);
            return Err(format!("{about} has sequence number {found}, not {expected}"));
        }
        let labelled = (header.window, header.iteration, header.start, header.end);
        if labelled != (step.window, step.iteration, step.start, step.end) {
            let (window, iteration) = (header.window, header.iteration);
            return Err(format!("{about} is labelled window {window}, iteration {iteration}"));
        }
        let shape = (header.components, header.points * u64::from(header.components));
        if shape != (GEOMETRY.components, sample.values().len() as u64) {
            let (components, points) = (header.components, header.points);
            let found = sample.values().len();
            return Err(format!(
                "{about} has {found} values ({components} components, {points} points)"
            ));
        }
        grid.with_geometry(sample.values(), header.grid_revision)
    }
}

impl Session {
    /// The moving grid of this name of a participant, if it is one.
    pub(super) fn moving_grid(&self, participant: usize, grid: &str) -> Option<usize> {
        let is = |m: &MovingGrid| m.participant == participant && m.grid.name == grid;
        self.moving.iter().position(is)
    }

    /// A participant has grids that move, and therefore answers `Accept`.
    pub(super) fn has_moving_grids(&self, participant: usize) -> bool {
        self.moving.iter().any(|moving| moving.participant == participant)
    }

    /// The grid on which a tap's field is in the next window.
    pub(super) fn current_grid(&self, tap: usize) -> &Grid {
        let tap = &self.taps[tap];
        tap.moving.map_or(&tap.grid, |index| &self.moving[index].grid)
    }

    /// A window is accepted: what its samples are on is kept.
    pub(super) fn keep_geometry(&mut self) {
        for MovingGrid { grid, last, .. } in &mut self.moving {
            if grid.revision != last.revision {
                last.clone_from(grid);
            }
        }
    }

    /// Receives what a participant has published of its grids, all of it.
    pub(super) fn receive_geometry(&mut self, one: usize, step: &Step) -> Result<(), RunError> {
        for index in 0..self.moving.len() {
            if self.moving[index].participant == one {
                while self.receive_one(index, step)? {}
            }
        }
        Ok(())
    }

    /// Receives the geometry of a grid up to this revision, which was that of the last window.
    pub(super) fn receive_last(
        &mut self,
        index: usize,
        revision: u64,
        step: &Step,
    ) -> Result<(), RunError> {
        while self.moving[index].grid.revision < revision && self.receive_one(index, step)? {}
        let MovingGrid { participant, grid, last, .. } = &mut self.moving[index];
        if grid.revision != revision {
            let (one, name, found) = (*participant, grid.name.clone(), grid.revision);
            let what = format!("it restored grid `{name}` in revision {found}, not {revision}");
            return Err(self.misbehaved(one, what));
        }
        last.clone_from(grid);
        Ok(())
    }

    fn receive_one(&mut self, index: usize, step: &Step) -> Result<bool, RunError> {
        let moving = &mut self.moving[index];
        let one = moving.participant;
        let received = moving.reader.receive();
        let Some(sample) = received.map_err(|e| self.transport_failed(one, &e))? else {
            return Ok(false);
        };
        let moving = &mut self.moving[index];
        let moved = moving.moved(&sample, step);
        moving.sequence += 1;
        if let (Some(recorder), Some(topic)) = (&self.recorder, moving.recorded) {
            recorder.sample(topic, sample.header().sequence);
        }
        self.bytes_exchanged += std::mem::size_of_val(sample.values()) as u64;
        let moved = moved.map_err(|fault| self.misbehaved(one, fault))?;
        self.move_grid(index, moved)?;
        Ok(true)
    }

    /// The grid is this one from here on, also for what the coordinator itself sends on it.
    fn move_grid(&mut self, index: usize, moved: Grid) -> Result<(), RunError> {
        if moved.points() != self.moving[index].grid.points() {
            self.check_growth(index, &moved)?;
        }
        let Self { moving, taps, feedback, mapped, .. } = self;
        for feedback in feedback.iter_mut().filter(|f| taps[f.tap].moving == Some(index)) {
            feedback.moved(&moved);
        }
        for mapped in mapped.iter_mut().filter(|m| m.moving == Some(index)) {
            mapped.moved(&moved);
        }
        let (role, grid, revision) = (&moving[index].role, &moved.name, moved.revision);
        tracing::debug!(role, grid, revision, points = moved.points(), "grid moved");
        moving[index].grid = moved;
        Ok(())
    }

    /// Coupling data keep their length, and everything else must have room in shared memory.
    fn check_growth(&mut self, index: usize, moved: &Grid) -> Result<(), RunError> {
        let MovingGrid { participant, grid, capacity, .. } = &self.moving[index];
        let mut fed_back = self.feedback.iter().map(|feedback| &self.taps[feedback.tap]);
        if let Some(tap) = fed_back.find(|tap| tap.moving == Some(index)) {
            let (name, from, to) = (&grid.name, grid.points(), moved.points());
            return Err(RunError::Failed(Failure {
                who: self.links[*participant].who(),
                when: self.phase.to_string(),
                what: format!(
                    "grid `{name}` has gone from {from} to {to} elements, but `{}` on it is \
                     coupling data",
                    tap.kind.name
                ),
                fix: "keep the number of its elements, or use a scheme in which the field is not \
                      coupling data"
                    .to_owned(),
            }));
        }
        if moved.points() <= *capacity {
            return Ok(());
        }
        // A segment that is too small is followed by one of twice the size or more.
        let capacity = moved.points().next_power_of_two();
        let sent = self.taps.iter().filter(|tap| tap.moving == Some(index)).map(|tap| &tap.kind);
        let mapped = self.mapped.iter().filter(|mapped| mapped.moving == Some(index));
        let kinds = sent.chain(mapped.map(|mapped| &self.taps[mapped.tap].kind));
        let components: Vec<u32> = kinds.map(|kind| kind.components).collect();
        self.memory.take(capacity, &components, &self.phase.to_string())?;
        self.moving[index].capacity = capacity;
        Ok(())
    }
}
