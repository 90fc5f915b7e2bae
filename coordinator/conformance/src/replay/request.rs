//! What is asked for, and how it went.

use super::compare::Comparison;
use run::programs::Program;
use serde::Serialize;
use std::path::PathBuf;

/// What is to be replayed.
#[derive(Clone, Debug)]
pub(crate) struct Request {
    /// The recording.
    pub recording: PathBuf,
    /// Role of the participant that is driven.
    pub only: String,
    /// The program to drive; by default our own solver of the role.
    pub program: Option<Program>,
    /// It is started by hand, and nothing has a deadline.
    pub serve: bool,
    /// Largest difference that passes, relative to the largest value of the sample; `None` for
    /// none, bit-identical.
    pub tolerance: Option<f64>,
    /// The first window to be solved; earlier ones are skipped as far as a state allows.
    pub from: Option<u64>,
    /// The last window to be solved.
    pub until: Option<u64>,
    /// Values of the recorded configuration to change: dotted key and SI value.
    pub set: Vec<(String, serde_json::Value)>,
    /// Ask before every command.
    pub step: bool,
}

/// How a replay went.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Replay {
    /// Role that was driven.
    pub role: String,
    /// Program and version that was driven.
    pub program: String,
    /// Program and version that was recorded.
    pub recorded_program: String,
    /// Solves asked for.
    pub solves: u64,
    /// First window that was solved, if not 0.
    pub from_window: u64,
    /// The last that was solved.
    pub last_window: u64,
    /// What was compared, and how it differs.
    pub comparison: Comparison,
    /// Remarks, one line each.
    pub remarks: Vec<String>,
    /// Seconds in the model, as recorded, of the solves that were replayed.
    pub recorded_model_s: f64,
    /// Seconds in the model now.
    pub model_s: f64,
    /// Seconds of the whole replay.
    pub wall_s: f64,
    /// The recording is cut, and the replay with it.
    pub cut: bool,
    /// The recording is damaged, and the replay ends there.
    pub damage: Option<String>,
}
