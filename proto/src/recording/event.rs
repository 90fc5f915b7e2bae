//! What is recorded besides fields: the conversation, and what the coordinator made of it.

use super::{RecordingError, admit};
use crate::message::{Command, CommandKind, Reply, Topics};
use serde::{Deserialize, Serialize};

/// One event of a run. Participants are named by their index in [`super::Head::participants`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Event {
    /// The coordinator has sent a command.
    Command {
        /// The participant that it is sent to.
        participant: u16,
        /// The fixed part.
        command: Command,
        /// What stands behind it. `Save` has none and `Restore` its grids alone: their files are
        /// recorded as states, and as the samples that follow.
        body: Vec<u8>,
    },
    /// A participant has answered.
    Reply {
        /// The participant.
        participant: u16,
        /// The fixed part.
        reply: Reply,
        /// What stands behind it.
        body: Vec<u8>,
    },
    /// An iteration is complete and judged.
    Iteration(Iteration),
    /// A window is solved again, with another end.
    Repeated {
        /// Number of the window.
        window: u64,
        /// Why.
        cause: String,
    },
    /// The run is over.
    Ended {
        /// What ended it, if that was no success.
        error: Option<String>,
    },
}

impl Event {
    /// Bytes of what stands behind a command or reply.
    pub(super) fn text_length(&self) -> usize {
        match self {
            Self::Command { body, .. } | Self::Reply { body, .. } => body.len(),
            Self::Iteration(_) | Self::Repeated { .. } | Self::Ended { .. } => 0,
        }
    }

    /// The topics that a participant was given, and its index; `None` in any other event.
    ///
    /// # Errors
    /// They are none, or name what no recording holds.
    pub fn topics(&self) -> Result<Option<(u16, Topics)>, RecordingError> {
        match self {
            Self::Command { participant, command, body }
                if command.kind == CommandKind::Connect as u32 =>
            {
                read_topics(body).map(|topics| Some((*participant, topics)))
            }
            _ => Ok(None),
        }
    }
}

/// The topics in the body of a recorded command.
///
/// # Errors
/// They are none, or name what no recording holds.
pub fn read_topics(body: &[u8]) -> Result<Topics, RecordingError> {
    let wrong =
        |fault: String| RecordingError::Content(format!("the topics of a participant: {fault}"));
    let topics = serde_json::from_slice(body).map_err(|error| wrong(error.to_string()))?;
    admit::topics(&topics).map_err(wrong)?;
    Ok(topics)
}

/// What the coordinator says of an iteration.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Iteration {
    /// Number of the window, from 0.
    pub window: u64,
    /// Iteration within the window, from 1.
    pub iteration: u32,
    /// Start of the window [s].
    pub start: f64,
    /// End of it [s].
    pub end: f64,
    /// Largest relative residual of the coupling data; `None` in an explicit scheme.
    pub residual: Option<f64>,
    /// That of each field of the coupling data, by name.
    pub residuals: Vec<(String, f64)>,
    /// Relaxation of the next iterate, if there was one.
    pub relaxation: Option<f64>,
    /// Columns from which the next iterate was made.
    pub columns: Option<u64>,
    /// Heat sent through conservative fields [W].
    pub heat_sent: Option<f64>,
    /// Heat received [W].
    pub heat_received: Option<f64>,
    /// Seconds in which no model computed.
    pub coupling_seconds: f64,
    /// Seconds in each participant's model.
    pub model_seconds: Vec<f64>,
}
