//! The cases of a study, and the participants that run them.

use case::RawCase;
use console::case_arguments::{Changes, read_case};
use run::error::RunError;
use run::fleet::Fleet;
use run::perform::{self, RunOptions};
use run::plan::{Planned, plan};
use run::results::ResultFolder;
use run::results::summary::Summary;
use run::signals;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The cases of a study, and the participants that run them. Each case is read once, so that all
/// runs use the same text even if the file is edited meanwhile.
#[derive(Debug)]
pub struct Bench {
    cases: Cases,
    /// Participants of the runs.
    pub fleet: Fleet,
}

/// Cases by the paths of their files.
pub type Cases = BTreeMap<PathBuf, RawCase>;

impl Bench {
    /// Returns a bench without cases.
    #[must_use]
    pub fn new(fleet: Fleet) -> Self {
        Self::with(Cases::new(), fleet)
    }

    /// Returns a bench with cases that have been read.
    #[must_use]
    pub fn with(cases: Cases, fleet: Fleet) -> Self {
        Self { cases, fleet }
    }

    /// Returns the cases that have been read.
    #[must_use]
    pub fn cases(&self) -> &Cases {
        &self.cases
    }

    /// Plans a case with the changes of a variant.
    ///
    /// # Errors
    /// The case is invalid, or a program that the case names cannot be used.
    pub fn planned(&mut self, case: &Path, variant: &Changes) -> Result<Planned, RunError> {
        let mut raw = self.read(case)?.clone();
        raw.apply(&variant.set, &variant.unset)?;
        plan(raw, &mut self.fleet)
    }

    fn read(&mut self, case: &Path) -> Result<&RawCase, RunError> {
        if !self.cases.contains_key(case) {
            // Reading from standard input may block for ever, so a signal must end the process at
            // once. Anywhere else a signal ends the study in order, and finished runs are kept.
            let reading = (case == Path::new("-")).then(signals::end_at_once);
            let raw = read_case(case)?;
            drop(reading);
            self.cases.insert(case.to_owned(), raw);
        }
        Ok(&self.cases[case])
    }

    /// Runs a case with the changes of a variant into a folder and returns the summary.
    ///
    /// # Errors
    /// The case cannot be planned or run, as with the command `run`.
    pub fn run(
        &mut self,
        case: &Path,
        variant: &Changes,
        folder: &ResultFolder,
    ) -> Result<Summary, RunError> {
        let since = Instant::now();
        let planned = self.planned(case, variant)?;
        self.run_planned(&planned, since, folder)
    }

    /// Runs a planned case into a folder and returns the summary. `since` is the time at which
    /// planning began.
    ///
    /// # Errors
    /// The run fails, or the folder cannot be written.
    pub fn run_planned(
        &mut self,
        planned: &Planned,
        since: Instant,
        folder: &ResultFolder,
    ) -> Result<Summary, RunError> {
        let options = RunOptions::planned_since(since);
        let outcome = perform::run(planned, &mut self.fleet, folder, options);
        outcome.error.map_or(Ok(outcome.summary), Err)
    }
}
