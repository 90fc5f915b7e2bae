//! The inputs of a participant as a recording holds them.

use crate::inspect;
use contract::grid::Grid;
use contract::message::{CommandKind, Topics};
use proto::recording::{Event, Item};
use run::error::RunError;
use std::path::Path;

/// The newest sample of each input, with its grid.
#[derive(Clone, Debug, Default)]
pub(super) struct Recorded(Vec<Input>);

#[derive(Clone, Debug)]
struct Input {
    field: String,
    service: String,
    grid: Grid,
    values: Option<Vec<f64>>,
}

impl Recorded {
    /// Reads what the participant of this role was given.
    ///
    /// # Errors
    /// The recording cannot be read, or nobody in it plays the role.
    pub(super) fn read(path: &Path, role: &str) -> Result<Self, RunError> {
        let mut recording = inspect::open(path)?;
        let participants = &recording.head().participants;
        let index = participants.iter().position(|p| p.role == role).ok_or_else(|| {
            RunError::Usage(format!("no participant in {} plays `{role}`", path.display()))
        })?;
        let mut recorded = Self::default();
        while let Some(entry) = recording.read().map_err(|error| inspect::failed(path, &error))? {
            match entry.item {
                Item::Event(Event::Command { participant, command, body })
                    if usize::from(participant) == index
                        && command.kind == CommandKind::Connect as u32 =>
                {
                    recorded =
                        serde_json::from_slice::<Topics>(&body).map(Self::of).unwrap_or_default();
                }
                Item::Sample { service, values, .. } => recorded.take(service, values),
                _ => {}
            }
        }
        Ok(recorded)
    }

    fn of(topics: Topics) -> Self {
        let input = |topic: contract::message::Topic| Input {
            field: topic.field,
            service: topic.service,
            grid: topic.grid,
            values: None,
        };
        Self(topics.inputs.into_iter().map(input).collect())
    }

    fn take(&mut self, service: &str, values: &[f64]) {
        for input in self.0.iter_mut().filter(|input| input.service == service) {
            input.values = Some(values.to_vec());
        }
    }

    /// Grid and values of a field.
    pub(super) fn field(&self, name: &str) -> Option<(&Grid, &[f64])> {
        let input = self.0.iter().find(|input| input.field == name)?;
        Some((&input.grid, input.values.as_deref()?))
    }
}
