//! The geometry of the grids that move, and of volumes, as it is received.

use super::Session;
use super::index::{MovingIndex, TapIndex};
use super::moving::MovingGrid;
use crate::error::{Failure, RunError};
use contract::grid::Grid;
use contract::step::Step;
use coupling::ParticipantIndex;

impl Session {
    /// The moving grid of this name of a participant, if it is one.
    pub(super) fn moving_grid(
        &self,
        participant: ParticipantIndex,
        grid: &str,
    ) -> Option<MovingIndex> {
        let is = |m: &MovingGrid| m.participant == participant && m.grid.name == grid;
        self.moving.position(is)
    }

    /// The geometry of every volume of a participant has come.
    pub(super) fn check_volumes(&self, one: ParticipantIndex) -> Result<(), RunError> {
        let mut own = self.moving.iter().filter(|moving| moving.participant == one);
        own.find(|moving| moving.grid.is_announced()).map_or(Ok(()), |moving| {
            let what = format!("it did not send the geometry of its volume `{}`", moving.grid.name);
            Err(self.peers.misbehaved(one, what))
        })
    }

    /// A participant has grids whose geometry travels, and therefore answers `Accept`.
    pub(super) fn has_moving_grids(&self, participant: ParticipantIndex) -> bool {
        self.moving.iter().any(|moving| moving.participant == participant)
    }

    /// A grid of the run moves.
    #[must_use]
    pub fn has_moving_grid(&self) -> bool {
        !self.moving.is_empty()
    }

    /// The grid on which a tap's field is in the next window.
    pub(super) fn current_grid(&self, tap: TapIndex) -> &Grid {
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
    pub(super) fn receive_geometry(
        &mut self,
        one: ParticipantIndex,
        step: &Step,
    ) -> Result<(), RunError> {
        for index in self.moving.keys() {
            if self.moving[index].participant == one {
                while self.receive_one(index, step)? {}
            }
        }
        Ok(())
    }

    /// Receives the geometry of a grid up to this revision, which was that of the last window.
    pub(super) fn receive_last(
        &mut self,
        index: MovingIndex,
        revision: u64,
        step: &Step,
    ) -> Result<(), RunError> {
        while self.moving[index].grid.revision < revision && self.receive_one(index, step)? {}
        let MovingGrid { participant, grid, last, .. } = &mut self.moving[index];
        if grid.revision != revision {
            let (one, name, found) = (*participant, grid.name.clone(), grid.revision);
            let what = format!("it restored grid `{name}` in revision {found}, not {revision}");
            return Err(self.peers.misbehaved(one, what));
        }
        last.clone_from(grid);
        Ok(())
    }

    fn receive_one(&mut self, index: MovingIndex, step: &Step) -> Result<bool, RunError> {
        let moving = &mut self.moving[index];
        let one = moving.participant;
        let received = moving.reader.receive();
        let Some(sample) = received.map_err(|e| self.peers.transport_failed(one, e))? else {
            return Ok(false);
        };
        let moving = &mut self.moving[index];
        let moved = moving.moved(&sample, step);
        moving.sequence += 1;
        if let (Some(recorder), Some(topic)) = (self.peers.recorder(), moving.recorded) {
            recorder.sample(topic, sample.header().sequence);
        }
        self.bytes_exchanged += std::mem::size_of_val(sample.values()) as u64;
        let moved = moved.map_err(|fault| self.peers.misbehaved(one, fault))?;
        self.move_grid(index, moved)?;
        Ok(true)
    }

    /// The grid is this one from here on, also for what the coordinator itself sends on it.
    fn move_grid(&mut self, index: MovingIndex, moved: Grid) -> Result<(), RunError> {
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
    fn check_growth(&mut self, index: MovingIndex, moved: &Grid) -> Result<(), RunError> {
        let MovingGrid { participant, grid, capacity, .. } = &self.moving[index];
        let mut fed_back = self.feedback.iter().map(|feedback| &self.taps[feedback.tap]);
        if let Some(tap) = fed_back.find(|tap| tap.moving == Some(index)) {
            let (name, from, to) = (&grid.name, grid.points(), moved.points());
            return Err(RunError::Failed(Failure {
                who: self.peers.all()[*participant].who(),
                when: self.peers.phase.to_string(),
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
        self.memory.take(capacity, &components, &self.peers.phase.to_string())?;
        self.moving[index].capacity = capacity;
        Ok(())
    }
}
