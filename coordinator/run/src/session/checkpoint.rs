//! State of all participants, written to a folder and read back between two windows.
//!
//! Each participant writes its own file `ROLE.state`. The coordinator stores the values that the
//! participant sent last, as `FIELD.values`. On restoring, the participant publishes these values
//! again, so that a consumer that needs them a window later still receives them. If the grid of
//! these values moves, it is stored as `ROLE.GRID.geometry`, because the participant's own state
//! holds the grid of the next window.

use super::Session;
use super::fields::MovingIndex;
use super::geometry::MovingGrid;
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
    /// Writes the state after the accepted step into a folder and returns the names of the files.
    /// The path must lead to the folder from every process.
    pub fn save(&mut self, step: &Step, folder: &Path) -> Result<Vec<String>, RunError> {
        self.peers.phase = Phase::Saving(*step);
        let mut names = Vec::new();
        for participant in self.peers.all().keys() {
            let name = state_file(self.peers.all()[participant].role());
            let file =
                StateFile { path: folder.join(&name), outputs: Vec::new(), geometry: Vec::new() };
            self.command_about(participant, CommandKind::Save, step, &file)?;
            names.push(name);
        }
        for field in self.fields.iter().filter(|field| !field.observed_only) {
            let (name, values) =
                (values_file(&field.kind.name), field.values().unwrap_or_default());
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
        while let Some((participant, answer)) = self.peers.next_reply(&mut pending, |_| deadline)? {
            answer?;
            if !folder.join(state_file(self.peers.all()[participant].role())).is_file() {
                let what = "it replied to Save without a file of its state".to_owned();
                return Err(self.peers.misbehaved(participant, what));
            }
            self.record_state(participant, folder)?;
        }
        Ok(names)
    }

    /// Returns to the state that [`Session::save`] wrote after `step`, before the first window is
    /// solved. `iterate` holds the values sent last to the consumers that close the loop.
    pub fn restore(&mut self, step: &Step, folder: &Path, iterate: &[f64]) -> Result<(), RunError> {
        self.peers.phase = Phase::Restoring(*step);
        let exchanged = self.moving.iter_enumerated().filter(|(_, m)| m.is_exchanged());
        let last = exchanged.map(|(index, m)| Ok((index, m.participant, read(m, folder)?)));
        let last: Vec<(MovingIndex, ParticipantIndex, Grid)> =
            last.collect::<Result<_, RunError>>()?;
        for participant in self.peers.all().keys() {
            let sent = self.fields.iter().filter(|t| t.producer == participant && !t.observed_only);
            let output = |name: &String| OutputFile {
                field: name.clone(),
                path: folder.join(values_file(name)),
            };
            let outputs = sent.map(|field| output(&field.kind.name)).collect();
            self.record_state(participant, folder)?;
            let path = folder.join(state_file(self.peers.all()[participant].role()));
            let own = last.iter().filter(|(_, owner, _)| *owner == participant);
            let geometry = own.map(|(.., grid)| grid.clone()).collect();
            let file = StateFile { path, outputs, geometry };
            self.command_about(participant, CommandKind::Restore, step, &file)?;
        }
        let deadline = self.peers.deadlines().solve;
        let mut pending = self.peers.all().keys().collect();
        while let Some((participant, answer)) = self.peers.next_reply(&mut pending, |_| deadline)? {
            answer?;
            for (index, _, grid) in last.iter().filter(|(_, owner, _)| *owner == participant) {
                self.receive_last(*index, grid.revision, step)?;
            }
            self.collect(participant, step, false)?;
        }
        self.send_iterate(iterate, step)?;
        self.peers.all().keys().try_for_each(|participant| self.receive_geometry(participant, step))
    }

    fn record_state(&self, participant: ParticipantIndex, folder: &Path) -> Result<(), RunError> {
        let Some(recorder) = self.peers.recorder() else { return Ok(()) };
        let role = self.peers.all()[participant].role();
        recorder.state(role, &folder.join(state_file(role)))
    }

    fn command_about(
        &mut self,
        participant: ParticipantIndex,
        kind: CommandKind,
        step: &Step,
        file: &StateFile,
    ) -> Result<(), RunError> {
        let body = serde_json::to_vec(file).expect("a path through a handle is ASCII");
        self.peers.post(participant, Command::about(kind, step), &body)
    }

    /// Counts exchanged bytes from this number on.
    pub fn continue_counting(&mut self, bytes_exchanged: u64) {
        self.bytes_exchanged = bytes_exchanged;
    }
}

fn write_values(path: &Path, values: &[f64]) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    write_numbers(&mut file, values)?;
    file.flush()
}

/// Reads the grid of the values in a checkpoint.
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
