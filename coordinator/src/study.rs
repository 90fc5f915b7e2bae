//! A case run many times with values changed: what the commands `cost`, `run --accuracy`,
//! `stability` and `reproduce` have in common.
//!
//! [`Variant`] is what is changed, [`run`] performs it like any other run, processes and shared
//! memory included, [`quantity`] names the figures of a summary that are compared, [`richardson`]
//! estimates their errors from grids, [`levels`] lists what the installed models offer for a case.
//! Nothing here knows a model or an effect by name: what there is to vary is in the descriptions.

pub mod axis;
pub mod levels;
pub mod quantity;
pub mod richardson;

use crate::case::RawCase;
use crate::error::RunError;
use crate::plan::{Planned, plan};
use crate::progress::Progress;
use crate::results::ResultFolder;
use crate::run::{self, Clock};
use serde_json::Value;
use std::path::Path;
use std::time::Instant;

/// What is changed in a case.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Variant {
    /// Keys that are set, `key=value` as for `--set`.
    pub set: Vec<String>,
    /// Keys that are removed.
    pub unset: Vec<String>,
}

impl Variant {
    /// The same with one more key set.
    #[must_use]
    pub fn with(&self, key: &str, value: impl std::fmt::Display) -> Self {
        let mut more = self.clone();
        more.set.push(format!("{key}={value}"));
        more
    }

    /// The options that make a `run` of it.
    #[must_use]
    pub fn options(&self) -> Vec<String> {
        let set = self.set.iter().flat_map(|option| ["--set".to_owned(), option.clone()]);
        let unset = self.unset.iter().flat_map(|key| ["--unset".to_owned(), key.clone()]);
        set.chain(unset).collect()
    }
}

/// Plans a case with a variant's changes.
///
/// # Errors
/// Whatever is wrong with the case, or with the programs it names.
pub fn planned(case: &Path, variant: &Variant) -> Result<Planned, RunError> {
    let mut raw = RawCase::read(case)?;
    raw.apply(&variant.set, &variant.unset)?;
    plan(raw)
}

/// Runs a case with a variant's changes into a folder; its summary.
///
/// # Errors
/// Those of the command `run`.
pub fn run(case: &Path, variant: &Variant, folder: &Path) -> Result<Value, RunError> {
    let since = Instant::now();
    let planned = planned(case, variant)?;
    let plan_seconds = since.elapsed().as_secs_f64();
    let folder = ResultFolder::prepare(folder, case)?;
    let mut progress = Progress::Silent;
    let clock = Clock { since, plan_seconds };
    let outcome = run::run(&planned, &folder, &mut progress, clock, None, None)?;
    outcome.error.map_or(Ok(outcome.summary), Err)
}

/// Whether an error ends the whole study, and not only the run that it ended.
#[must_use]
pub fn ends_study(error: &RunError) -> bool {
    matches!(error, RunError::Interrupted { .. })
}
