//! The participant under test.

use contract::description::Description;
use run::programs::Program;
use std::time::Duration;

/// The participant under test.
pub(super) struct Subject {
    /// The role that it plays.
    pub(super) role: String,
    /// The executable.
    pub(super) program: Program,
    /// What it said when it was asked first; empty if it did not.
    pub(super) description: Description,
    /// Longest wait for an answer.
    pub(super) patience: Duration,
}
