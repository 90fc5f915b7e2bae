//! Recorded events: messages between coordinator and participants, and decisions of the
//! coordinator.

use super::{RecordingError, admit};
use crate::message::{Command, CommandKind, Reply, Topics};
use serde::{Deserialize, Serialize};

/// One event of a run. Participants are given by their index in [`super::Head::participants`]. `R`
/// is the fixed part of a reply.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Event<R = Reply> {
    /// The coordinator has sent a command.
    Command {
        /// Receiver of the command.
        participant: u16,
        /// Fixed part of the message.
        command: Command,
        /// Variable part of the message: empty for `Save`, only the grids for `Restore`. Their
        /// files are recorded as states and as the samples that follow.
        body: Vec<u8>,
    },
    /// A participant has replied.
    Reply {
        /// Sender of the reply.
        participant: u16,
        /// Fixed part of the message.
        reply: R,
        /// Variable part of the message.
        body: Vec<u8>,
    },
    /// An iteration is complete and its convergence has been checked.
    Iteration(Iteration),
    /// A window is solved again, with a different end.
    Repeated {
        /// Number of the window.
        window: u64,
        /// Reason for the repetition.
        cause: String,
    },
    /// The run has ended.
    Ended {
        /// Error that ended the run; `None` after success.
        error: Option<String>,
    },
}

impl Event {
    /// Returns the length of the variable part of a command or reply [byte].
    pub(super) fn text_length(&self) -> usize {
        match self {
            Self::Command { body, .. } | Self::Reply { body, .. } => body.len(),
            Self::Iteration(_) | Self::Repeated { .. } | Self::Ended { .. } => 0,
        }
    }

    /// Returns the topics given to a participant, with its index; `None` for other events.
    ///
    /// # Errors
    /// Fails if the body is malformed, or if a name or grid is not permitted in a recording.
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

/// Reads the topics in the body of a recorded command.
///
/// # Errors
/// Fails if the body is malformed, or if a name or grid is not permitted in a recording.
pub fn read_topics(body: &[u8]) -> Result<Topics, RecordingError> {
    let wrong =
        |fault: String| RecordingError::Content(format!("the topics of a participant: {fault}"));
    let topics = serde_json::from_slice(body).map_err(|error| wrong(error.to_string()))?;
    admit::topics(&topics).map_err(wrong)?;
    Ok(topics)
}

/// Convergence data of an iteration.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Iteration {
    /// Number of the window, from 0.
    pub window: u64,
    /// Iteration within the window, from 1.
    pub iteration: u32,
    /// Start of the window [s].
    pub start: f64,
    /// End of the window [s].
    pub end: f64,
    /// Largest relative residual of the coupling data; `None` in an explicit scheme.
    pub residual: Option<f64>,
    /// Residual of each field of the coupling data, by name.
    pub residuals: Vec<(String, f64)>,
    /// Relaxation factor ω of the next iterate, for relaxation steps.
    pub relaxation: Option<f64>,
    /// Number of secant columns used for the next iterate.
    pub columns: Option<u64>,
    /// Power sent through conservative fields [W].
    pub sent: Option<f64>,
    /// Power received [W].
    pub received: Option<f64>,
    /// Seconds in which no model computed.
    pub coupling_seconds: f64,
    /// Seconds in each participant's model.
    pub model_seconds: Vec<f64>,
}
