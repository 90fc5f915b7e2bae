//! Finished runs of an interrupted study. They are kept in the study's folder, and the same command
//! resumes with them.
//!
//! The file is append-only: a first line that identifies the request, then one line per run. An
//! incomplete last line is ignored, and its run is repeated.

use super::folder::StudyFolder;
use super::spent::RunCost;
use run::error::{RunError, file_failure};
use run::identity::{Identity, unseen};
use run::plan::Planned;
use run::results::read_file;
use run::results::summary::Summary;
use run::sealed::sum;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Write;
use std::path::Path;

const FILE: &str = "unfinished.jsonl";

/// The request of the study, stored in the first line of the file.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Request {
    /// CRC-64 of everything that determines the list of runs.
    request: u64,
    /// Programs, values and files of the case.
    identity: Identity,
    /// Changes that the identity does not see, as the end of a sentence.
    #[serde(skip)]
    unseen: String,
}

/// A finished run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Run {
    /// Contents of `summary.json`.
    pub(crate) summary: Summary,
    /// Time and memory used by the run.
    pub(crate) spent: RunCost,
    /// Quantities for which participants have a closed form.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) closed_forms: BTreeMap<String, f64>,
}

impl Run {
    /// Takes over the times of an earlier run of the same case where they are shorter.
    pub(super) fn with_least_times_of(mut self, earlier: Option<Self>) -> Self {
        if let Some(Self { spent, .. }) = earlier {
            let wall_s = spent.wall_s.min(self.spent.wall_s);
            if spent.solve_s <= self.spent.solve_s {
                self.spent = spent;
            }
            self.spent.wall_s = wall_s;
        }
        self
    }
}

/// One line of the file: a run and the options that produce the run.
#[derive(Serialize, Deserialize)]
struct Line<R> {
    options: Vec<String>,
    #[serde(flatten)]
    run: R,
}

/// Finished runs, keyed by the options that produce them.
#[derive(Debug)]
pub(crate) struct FinishedRuns<R = Run> {
    request: Request,
    runs: BTreeMap<Vec<String>, R>,
    /// Length of the complete lines in the file \[byte\]; 0 before the file exists.
    bytes: u64,
    file: Option<File>,
}

impl<R: Clone + Serialize + DeserializeOwned> FinishedRuns<R> {
    /// Returns an empty list of finished runs for a study of a case. `asked` holds everything
    /// besides the case that determines the list of runs.
    pub(crate) fn none(asked: &Value, standing: &Planned) -> Result<Self, RunError> {
        Ok(Self::of(asked, Identity::of(standing)?, unseen(&standing.plan)))
    }

    /// Returns an empty list of finished runs for a study of several cases. `asked` holds
    /// everything that determines the list of runs and their results.
    pub(crate) fn none_of_cases(asked: &Value) -> Self {
        Self::of(asked, Identity::default(), String::new())
    }

    fn of(asked: &Value, identity: Identity, unseen: String) -> Self {
        let request = Request { request: sum(asked.to_string().as_bytes()), identity, unseen };
        Self { request, runs: BTreeMap::new(), bytes: 0, file: None }
    }

    /// Returns whether the folder holds finished runs of the same request.
    pub(crate) fn are_in(&self, folder: &Path) -> bool {
        self.read(folder).is_some()
    }

    fn read(&self, folder: &Path) -> Option<Self> {
        let text = read_file(&folder.join(FILE)).ok()?;
        let mut lines = text.split_inclusive(|byte| *byte == b'\n');
        let head = lines.next()?;
        let request: Request = serde_json::from_slice(head).ok()?;
        if request.request != self.request.request {
            return None;
        }
        let mut found =
            Self { request, runs: BTreeMap::new(), bytes: head.len() as u64, file: None };
        for line in lines.take_while(|line| line.ends_with(b"\n")) {
            let Ok(Line { options, run }) = serde_json::from_slice(line) else { break };
            found.runs.insert(options, run);
            found.bytes += line.len() as u64;
        }
        (!found.runs.is_empty()).then_some(found)
    }

    /// Reads the finished runs of a folder. Returns `self` unchanged if the folder holds none of
    /// the same request.
    ///
    /// # Errors
    /// The finished runs belong to a different case. The error names the differences.
    pub(super) fn resume(self, folder: &Path) -> Result<Self, RunError> {
        let Some(found) = self.read(folder) else { return Ok(self) };
        let (fix, place) =
            ("--replace starts again, --out DIR leaves that study untouched", folder.display());
        let (known, new) = (&found.request.identity, &self.request.identity);
        known.require_same(new, &place.to_string(), fix)?;
        Ok(Self { request: self.request, ..found })
    }

    /// Changes that a comparison of identities does not see, as the end of a sentence; empty if
    /// there are none.
    pub(super) fn unseen(&self) -> &str {
        &self.request.unseen
    }

    /// Number of finished runs.
    pub(super) fn count(&self) -> usize {
        self.runs.len()
    }

    /// Looks up the run with these options.
    pub(super) fn run(&self, options: &[String]) -> Option<&R> {
        self.runs.get(options)
    }

    /// Appends a run to the file, unless the run is already there.
    pub(super) fn add(
        &mut self,
        options: Vec<String>,
        run: &R,
        folder: &StudyFolder,
    ) -> Result<(), RunError> {
        if self.runs.contains_key(&options) {
            return Ok(());
        }
        let shown = folder.path().join(FILE);
        let failed = |error: std::io::Error| file_failure(&shown, &error);
        let mut lines = Vec::new();
        let file = match &mut self.file {
            Some(file) => file,
            None => {
                if self.bytes == 0 {
                    write_line(&mut lines, &self.request);
                }
                self.file.insert(folder.grow(FILE, self.bytes)?)
            }
        };
        write_line(&mut lines, &Line { options: options.clone(), run });
        file.write_all(&lines).map_err(failed)?;
        self.bytes += lines.len() as u64;
        self.runs.insert(options, run.clone());
        Ok(())
    }

    /// Removes the file once the study is complete.
    pub(super) fn remove(folder: &StudyFolder) -> Result<(), RunError> {
        folder.remove(FILE)
    }
}

fn write_line(lines: &mut Vec<u8>, line: &impl Serialize) {
    serde_json::to_writer(&mut *lines, line).expect("plain data");
    lines.push(b'\n');
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn none() -> FinishedRuns<Run> {
        let request = Request { request: 7, identity: Identity::default(), unseen: String::new() };
        FinishedRuns { request, runs: BTreeMap::new(), bytes: 0, file: None }
    }

    fn run(seconds: f64) -> Run {
        let spent = RunCost { solve_s: seconds, wall_s: 2.0 * seconds, ..RunCost::default() };
        let summary = Summary::of_sections(serde_json::json!({"contact": {"a_m": seconds}}));
        Run { summary, spent, closed_forms: BTreeMap::new() }
    }

    /// A file with two runs may be cut anywhere: all runs on complete lines are recovered.
    #[test]
    fn a_cut_costs_the_run_that_it_is_in() {
        let place = tempfile::tempdir().unwrap();
        let mut text = Vec::new();
        write_line(&mut text, &none().request);
        let head = text.len();
        write_line(&mut text, &Line { options: vec!["--set".into(), "a=1".into()], run: run(1.0) });
        let first = text.len();
        write_line(&mut text, &Line { options: vec![], run: run(2.0) });
        for cut in 0..=text.len() {
            fs::write(place.path().join(FILE), &text[..cut]).unwrap();
            let count = none().read(place.path()).map_or(0, |found| found.count());
            let expected = usize::from(cut >= first) + usize::from(cut == text.len());
            assert_eq!(count, expected, "cut at {cut}, head {head}");
        }
        let found = none().read(place.path()).unwrap();
        assert_eq!(found.run(&[]).unwrap().spent, run(2.0).spent);
        let other = Request { request: 8, ..none().request };
        assert!(FinishedRuns { request: other, ..none() }.read(place.path()).is_none());
    }

    #[test]
    fn the_least_times_of_several_runs_are_taken() {
        let least = run(3.0).with_least_times_of(Some(run(1.0))).with_least_times_of(None);
        assert_eq!((least.spent.solve_s, least.spent.wall_s), (1.0, 2.0));
        assert_eq!(least.summary, run(3.0).summary);
    }
}
