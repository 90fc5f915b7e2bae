//! The state of all participants, written to a folder and read back between two windows.
//!
//! Each participant writes a file of its own, `ROLE.state`. What it sent last is the coordinator's
//! to keep, `FIELD.values`: on return the participant publishes it again, so that a participant
//! that needs it a window later finds it where it would have been. Where the grid of those values
//! moves, it is kept beside them, `ROLE.GRID.geometry`: the participant's own state has the grid of
//! the window that follows.

use super::Session;
use super::index::MovingIndex;
use super::moving::MovingGrid;
use crate::error::{RunError, file_failure};
use crate::peers::Phase;
use contract::grid::Grid;
use contract::message::{Command, CommandKind, OutputFile, StateFile};
use contract::step::Step;
use coupling::ParticipantIndex;
use proto::state::write_numbers;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

impl Session {
    /// Writes the state after the accepted step into a folder, given by a path that leads
    /// there from every process; the names of the files.
    pub fn save(&mut self, step: &Step, folder: &Path) -> Result<Vec<String>, RunError> {
        self.peers.phase = Phase::Saving(*step);
        let mut names = Vec::new();
        for one in self.peers.all().keys() {
            let name = state_file(self.peers.all()[one].role());
            let file =
                StateFile { path: folder.join(&name), outputs: Vec::new(), geometry: Vec::new() };
            self.command_about(one, CommandKind::Save, step, &file)?;
            names.push(name);
        }
        for tap in self.taps.iter().filter(|tap| !tap.observed_only) {
            let (name, values) = (values_file(&tap.kind.name), tap.values().unwrap_or_default());
            let path = folder.join(&name);
            write_values(&path, values).map_err(|error| file_failure(&path, &error))?;
            names.push(name);
        }
        for moving in self.moving.iter().filter(|moving| moving.is_exchanged()) {
            let (name, path) = (moving.file(), folder.join(moving.file()));
            let text = serde_json::to_vec(&moving.last).expect("a grid is plain data");
            std::fs::write(&path, text).map_err(|error| file_failure(&path, &error))?;
            names.push(name);
        }
        let deadline = self.peers.deadlines().solve;
        let mut pending = self.peers.all().keys().collect();
        while let Some((one, answer)) = self.peers.next_reply(&mut pending, |_| deadline)? {
            answer?;
            self.record_state(one, folder)?;
        }
        Ok(names)
    }

    /// Returns to the state that [`Session::save`] wrote after `step`, before the first window is
    /// solved; `iterate` is what was sent last to the consumers that close the loop.
    pub fn restore(&mut self, step: &Step, folder: &Path, iterate: &[f64]) -> Result<(), RunError> {
        self.peers.phase = Phase::Restoring(*step);
        let exchanged = self.moving.iter_enumerated().filter(|(_, m)| m.is_exchanged());
        let last = exchanged.map(|(index, m)| Ok((index, m.participant, read(m, folder)?)));
        let last: Vec<(MovingIndex, ParticipantIndex, Grid)> =
            last.collect::<Result<_, RunError>>()?;
        for one in self.peers.all().keys() {
            let sent = self.taps.iter().filter(|t| t.producer == one && !t.observed_only);
            let output = |name: &String| OutputFile {
                field: name.clone(),
                path: folder.join(values_file(name)),
            };
            let outputs = sent.map(|tap| output(&tap.kind.name)).collect();
            self.record_state(one, folder)?;
            let path = folder.join(state_file(self.peers.all()[one].role()));
            let own = last.iter().filter(|(_, owner, _)| *owner == one);
            let geometry = own.map(|(.., grid)| grid.clone()).collect();
            let file = StateFile { path, outputs, geometry };
            self.command_about(one, CommandKind::Restore, step, &file)?;
        }
        let deadline = self.peers.deadlines().solve;
        let mut pending = self.peers.all().keys().collect();
        while let Some((one, answer)) = self.peers.next_reply(&mut pending, |_| deadline)? {
            answer?;
            for (index, _, grid) in last.iter().filter(|(_, owner, _)| *owner == one) {
                self.receive_last(*index, grid.revision, step)?;
            }
            self.collect(one, step, false)?;
        }
        self.send_iterate(iterate, step)?;
        self.peers.all().keys().try_for_each(|one| self.receive_geometry(one, step))
    }

    fn record_state(&self, one: ParticipantIndex, folder: &Path) -> Result<(), RunError> {
        let Some(recorder) = self.peers.recorder() else { return Ok(()) };
        let role = self.peers.all()[one].role();
        recorder.state(role, &folder.join(state_file(role)))
    }

    fn command_about(
        &mut self,
        one: ParticipantIndex,
        kind: CommandKind,
        step: &Step,
        file: &StateFile,
    ) -> Result<(), RunError> {
        let body = serde_json::to_vec(file).expect("a path through a handle is ASCII");
        self.peers.post(one, Command::about(kind, step), &body, true)
    }

    /// Counts bytes exchanged from here on as if this many had been before.
    pub fn continue_counting(&mut self, bytes_exchanged: u64) {
        self.bytes_exchanged = bytes_exchanged;
    }
}

fn write_values(path: &Path, values: &[f64]) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    write_numbers(&mut file, values)?;
    file.flush()
}

/// The grid on which a checkpoint's values are.
fn read(moving: &MovingGrid, folder: &Path) -> Result<Grid, RunError> {
    let path = folder.join(moving.file());
    let grid = std::fs::read(&path).and_then(|text| {
        let grid: Grid = serde_json::from_slice(&text)?;
        grid.check().map_err(std::io::Error::other)?;
        Ok(grid)
    });
    grid.map_err(|error| file_failure(&path, &error))
}

fn state_file(role: &str) -> String {
    format!("{role}.state")
}

fn values_file(field: &str) -> String {
    format!("{field}.values")
}
