//! What is asked for.

use run::programs::Program;
use std::path::PathBuf;
use std::time::Duration;

/// What is to be put through the contract, and with what.
#[derive(Clone, Debug)]
pub(crate) struct Request {
    /// The role that it plays.
    pub role: String,
    /// The executable.
    pub program: Program,
    /// The case that it is configured with; absent: the scene wheel-rail.
    pub case: Option<PathBuf>,
    /// Keys of the case to change.
    pub set: Vec<String>,
    /// Keys of the case to remove.
    pub unset: Vec<String>,
    /// A recording whose inputs are used in place of made-up ones.
    pub recording: Option<PathBuf>,
    /// Names of the checks to make; all if empty.
    pub only: Vec<String>,
    /// Only the cheapest model and mode, and small grids.
    pub quick: bool,
    /// Longest wait for an answer.
    pub patience: Duration,
}
