//! Results of a suite, as plain data: `stability.json`.

use crate::study::output::StudyFile;
use serde::{Deserialize, Serialize};

/// Results of a suite.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Report {
    /// Version of the file's layout.
    pub schema: u32,
    /// Whether the suite ran to its end.
    pub complete: bool,
    /// The suite file.
    pub suite: String,
    /// One entry per case.
    pub cases: Vec<CaseReport>,
    /// Total time of all runs \[s\].
    pub wall_s: f64,
}

impl StudyFile for Report {
    const COMMAND: &'static str = "stability";
    const FILE: &'static str = "stability.json";
    const SCHEMA: u32 = 2;
}

/// Results of a case and its sweeps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CaseReport {
    /// Number in the list of hard cases.
    pub number: u32,
    pub name: String,
    /// Title: the difficulty of the case.
    pub title: String,
    /// Name, bound and reason of every check.
    pub bounds: Vec<[String; 3]>,
    /// Expected outcome, in words.
    pub expected: String,
    /// Result of the case's own run.
    pub row: RunResult,
    /// Results of the sweeps.
    pub sweeps: Vec<SweepReport>,
}

/// Result of one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RunResult {
    /// Whether the outcome is as expected.
    pub as_expected: bool,
    /// Differences from the expected outcome.
    pub otherwise: Vec<String>,
    /// Exit code and message, if the run failed.
    pub error: Option<(u8, String)>,
    /// Whether every value sent is finite; `None` if the run failed.
    pub bounded: Option<bool>,
    /// Largest relative difference between heat sent and received \[-\].
    pub energy_imbalance: Option<f64>,
    /// Quantities compared with their bounds.
    pub findings: Vec<Finding>,
    /// Total coupling iterations.
    pub iterations: u64,
    /// Time from reading the case to the end of the last process \[s\].
    pub seconds: f64,
}

/// A quantity and its bound.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Finding {
    /// Name of the check.
    pub name: String,
    /// Value of the quantity; `None` if missing from the results or not finite.
    pub value: Option<f64>,
    /// Bound, in words.
    pub bound: String,
    /// Used share of the bound; above 1 the bound is violated \[-\].
    pub share: Option<f64>,
}

impl Finding {
    /// Returns whether the quantity is within its bound.
    #[must_use]
    pub(crate) fn holds(&self) -> bool {
        self.share.is_some_and(|share| share <= 1.0)
    }
}

/// A parameter varied up to its edge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SweepReport {
    /// Name of the parameter.
    pub parameter: String,
    /// Behaviour up to the edge.
    pub before: String,
    /// Expected outcome from the edge onwards; `None` without an edge.
    pub beyond: Option<String>,
    /// Reason for the edge.
    pub why: String,
    /// Values and the result of each.
    pub rows: Vec<(String, RunResult)>,
}

impl RunResult {
    /// Returns whether the run gave a result within every bound.
    #[must_use]
    pub(crate) fn answers(&self) -> bool {
        self.error.is_none()
            && self.bounded == Some(true)
            && self.findings.iter().all(Finding::holds)
    }

    /// The quantity that uses the largest share of its bound.
    #[must_use]
    pub(crate) fn worst(&self) -> Option<&Finding> {
        let share = |finding: &&Finding| finding.share.unwrap_or(f64::INFINITY);
        self.findings.iter().max_by(|a, b| share(a).total_cmp(&share(b)))
    }
}

impl SweepReport {
    /// Returns whether all runs are as expected.
    #[must_use]
    pub(crate) fn as_expected(&self) -> bool {
        self.rows.iter().all(|(_, row)| row.as_expected)
    }

    /// Index of the first value whose outcome differs from the outcome of the first value.
    #[must_use]
    pub(crate) fn edge(&self) -> Option<usize> {
        let ending = |row: &RunResult| (row.answers(), row.error.as_ref().map(|(code, _)| *code));
        let first = self.rows.first().map(|(_, row)| ending(row))?;
        self.rows.iter().position(|(_, row)| ending(row) != first)
    }
}

impl CaseReport {
    /// Returns whether the case and all its sweeps are as expected.
    #[must_use]
    pub(crate) fn as_expected(&self) -> bool {
        self.row.as_expected && self.sweeps.iter().all(SweepReport::as_expected)
    }

    /// All runs. Runs of a sweep come with their parameter and value.
    pub(crate) fn runs(&self) -> impl Iterator<Item = (Option<(&str, &str)>, &RunResult)> {
        let swept = self.sweeps.iter().flat_map(|sweep| {
            let at = |(value, row)| (Some((sweep.parameter.as_str(), value)), row);
            sweep.rows.iter().map(|(value, row)| (value.as_str(), row)).map(at)
        });
        std::iter::once((None, &self.row)).chain(swept)
    }
}

impl Report {
    /// Returns whether all cases are as expected.
    #[must_use]
    pub(crate) fn as_expected(&self) -> bool {
        self.cases.iter().all(CaseReport::as_expected)
    }

    /// Number of runs.
    #[must_use]
    pub(crate) fn runs(&self) -> usize {
        self.cases.iter().map(|case| case.runs().count()).sum()
    }
}
