//! What a suite has shown, as plain data: `stability.json`.

use crate::study::output::Kept;
use serde::{Deserialize, Serialize};

/// How a suite went.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Report {
    /// Version of this layout.
    pub schema: u32,
    /// The suite has been run to its end.
    pub complete: bool,
    /// The suite file.
    pub suite: String,
    /// One entry a case.
    pub cases: Vec<CaseReport>,
    /// Seconds of all runs.
    pub wall_s: f64,
}

impl Kept for Report {
    const COMMAND: &'static str = "stability";
    const FILE: &'static str = "stability.json";
    const SCHEMA: u32 = 2;
}

/// How one case and its sweeps went.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CaseReport {
    /// Its number in the list of hard cases.
    pub number: u32,
    /// Its name.
    pub name: String,
    /// What is hard about it.
    pub title: String,
    /// Name, bound and reason of every check.
    pub bounds: Vec<[String; 3]>,
    /// What is expected, in words.
    pub expected: String,
    /// How the run went.
    pub row: RunResult,
    /// How the sweeps went.
    pub sweeps: Vec<SweepReport>,
}

/// How one run went.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RunResult {
    /// It went as expected.
    pub as_expected: bool,
    /// What went otherwise than expected.
    pub otherwise: Vec<String>,
    /// Exit code and message, if it ended with an error.
    pub error: Option<(u8, String)>,
    /// Every value that was sent is finite; `None` if no answer came.
    pub bounded: Option<bool>,
    /// Largest relative difference of heat sent and received \[-\].
    pub energy_imbalance: Option<f64>,
    /// Every quantity that was held against a bound.
    pub findings: Vec<Finding>,
    /// Coupling iterations.
    pub iterations: u64,
    /// Seconds from reading the case to the last process's end.
    pub seconds: f64,
}

/// A quantity against its bound.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Finding {
    /// What it is.
    pub name: String,
    /// The quantity; `None` if the run does not give it, or gives none.
    pub value: Option<f64>,
    /// Where it has to be.
    pub bound: String,
    /// How much of what the bound allows it takes: above 1 it is beyond \[-\].
    pub share: Option<f64>,
}

impl Finding {
    /// It keeps its bound.
    #[must_use]
    pub(crate) fn holds(&self) -> bool {
        self.share.is_some_and(|share| share <= 1.0)
    }
}

/// A parameter driven to its edge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SweepReport {
    /// What it is.
    pub parameter: String,
    /// What is seen up to the edge.
    pub before: String,
    /// What is expected from the edge on; `None` if there is none.
    pub beyond: Option<String>,
    /// Why it is there.
    pub why: String,
    /// Its values, and how each went.
    pub rows: Vec<(String, RunResult)>,
}

impl RunResult {
    /// It came to an answer that keeps every bound.
    #[must_use]
    pub(crate) fn answers(&self) -> bool {
        self.error.is_none()
            && self.bounded == Some(true)
            && self.findings.iter().all(Finding::holds)
    }

    /// The quantity that takes most of what its bound allows.
    #[must_use]
    pub(crate) fn worst(&self) -> Option<&Finding> {
        let share = |finding: &&Finding| finding.share.unwrap_or(f64::INFINITY);
        self.findings.iter().max_by(|a, b| share(a).total_cmp(&share(b)))
    }
}

impl SweepReport {
    /// All its runs went as expected.
    #[must_use]
    pub(crate) fn as_expected(&self) -> bool {
        self.rows.iter().all(|(_, row)| row.as_expected)
    }

    /// Index of the first value that ends otherwise than the first one does.
    #[must_use]
    pub(crate) fn edge(&self) -> Option<usize> {
        let ending = |row: &RunResult| (row.answers(), row.error.as_ref().map(|(code, _)| *code));
        let first = self.rows.first().map(|(_, row)| ending(row))?;
        self.rows.iter().position(|(_, row)| ending(row) != first)
    }
}

impl CaseReport {
    /// The case and all its sweeps went as expected.
    #[must_use]
    pub(crate) fn as_expected(&self) -> bool {
        self.row.as_expected && self.sweeps.iter().all(SweepReport::as_expected)
    }

    /// All runs, with the parameter and value of those of a sweep.
    pub(crate) fn runs(&self) -> impl Iterator<Item = (Option<(&str, &str)>, &RunResult)> {
        let swept = self.sweeps.iter().flat_map(|sweep| {
            let at = |(value, row)| (Some((sweep.parameter.as_str(), value)), row);
            sweep.rows.iter().map(|(value, row)| (value.as_str(), row)).map(at)
        });
        std::iter::once((None, &self.row)).chain(swept)
    }
}

impl Report {
    /// Everything went as expected.
    #[must_use]
    pub(crate) fn as_expected(&self) -> bool {
        self.cases.iter().all(CaseReport::as_expected)
    }

    /// How many runs there were.
    #[must_use]
    pub(crate) fn runs(&self) -> usize {
        self.cases.iter().map(|case| case.runs().count()).sum()
    }
}
