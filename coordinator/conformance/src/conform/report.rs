//! Results of all checks of a participant.

use super::check::{CheckOutcome, CheckResult};
use serde::Serialize;

/// Results of all checks of a participant.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Report {
    /// Role that was asked for.
    pub role: String,
    /// Name and version of the program, as it describes itself; empty if it does not.
    pub program: String,
    /// Model and mode of every setting that it was checked in.
    pub settings: Vec<String>,
    /// Settings that the case does not give, and why.
    pub left_out: Vec<String>,
    /// One row a check.
    pub checks: Vec<CheckResult>,
    /// Seconds of all checks.
    pub wall_s: f64,
}

impl Report {
    /// The checks that failed.
    pub(crate) fn failed(&self) -> impl Iterator<Item = &CheckResult> {
        self.checks.iter().filter(|row| row.verdict == CheckOutcome::Failed)
    }
}
