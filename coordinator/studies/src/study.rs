//! A case run many times with values changed: what the commands `cost`, `ablate`,
//! `run --accuracy`, `stability` and `reproduce` have in common.
//!
//! [`Variant`] is what is changed, [`run`] performs it like any other run, processes and shared
//! memory included, [`quantity`] names the quantities of a summary that are compared, [`richardson`]
//! estimates their errors from grids, [`levels`] lists what the installed models offer for a case.
//! [`arguments`], [`folder`], [`output`] and [`table`] are what the commands ask, where they write, and
//! how they show what they have found.
//! Nothing here knows a model or an effect by name: what there is to vary is in the descriptions.

pub mod arguments;
pub mod axis;
pub mod folder;
pub mod levels;
pub mod output;
pub mod quantity;
mod range;
pub mod richardson;
pub mod spent;
pub mod table;

use axis::Axis;
use case::RawCase;
use console::case_arguments::read_case;
use run::error::RunError;
use run::perform::{self, RunStart};
use run::plan::{Plan, Planned, plan};
use run::progress::silent;
use run::results::{Existing, ResultFolder};
use run::signals;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
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
    /// Sets a key, replacing an earlier value.
    #[must_use]
    pub fn with(&self, key: &str, value: impl std::fmt::Display) -> Self {
        let mut more = self.clone();
        more.set.retain(|option| set_key(option) != key);
        more.set.push(format!("{key}={value}"));
        more
    }

    /// Returns the keys that are set, each as an axis of one value.
    pub fn axes(&self) -> impl Iterator<Item = Axis> {
        self.set.iter().filter_map(|option| {
            let (key, value) = option.split_once('=')?;
            Some(Axis { key: key.trim().to_owned(), values: vec![value.trim().to_owned()] })
        })
    }

    /// The options that make a `run` of it.
    #[must_use]
    pub fn options(&self) -> Vec<String> {
        let set = self.set.iter().flat_map(|option| ["--set".to_owned(), option.clone()]);
        let unset = self.unset.iter().flat_map(|key| ["--unset".to_owned(), key.clone()]);
        set.chain(unset).collect()
    }
}

/// The key of an option of `--set`.
fn set_key(option: &str) -> &str {
    option.split_once('=').map_or(option, |(key, _)| key).trim()
}

/// Plans a case with a variant's changes.
///
/// # Errors
/// Whatever is wrong with the case, or with the programs it names.
pub fn planned(case: &Path, variant: &Variant) -> Result<Planned, RunError> {
    let mut raw = read(case)?;
    raw.apply(&variant.set, &variant.unset)?;
    plan(raw)
}

/// Reads a case once in the life of this process: all runs of a study are of the same text, also if
/// the file is edited meanwhile.
fn read(case: &Path) -> Result<RawCase, RunError> {
    static READ: Mutex<BTreeMap<PathBuf, RawCase>> = Mutex::new(BTreeMap::new());
    let mut known = READ.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(raw) = known.get(case) {
        return Ok(raw.clone());
    }
    // A pipe that nobody writes to. Otherwise a signal ends the study in order, with what it keeps.
    let reading = (case == Path::new("-")).then(signals::end_at_once);
    let raw = read_case(case)?;
    drop(reading);
    known.insert(case.to_owned(), raw.clone());
    Ok(raw)
}

/// Refuses to vary a key that nothing reads: every run would give the same answer.
///
/// # Errors
/// The key, and what would read it, with the place of the option.
pub fn refuse_unread(standing: &Planned, key: &str, option: &str) -> Result<(), RunError> {
    let within = |other: &str| {
        other == key || other.strip_prefix(key).is_some_and(|rest| rest.starts_with('.'))
    };
    let Some(unread) = standing.case.unread.iter().find(|unread| within(&unread.key)) else {
        return Ok(());
    };
    let fix = match unread.readers.as_slice() {
        [] => "name its entry where it is to be used".to_owned(),
        readers => format!("choose {}", readers.join(" or ")),
    };
    Err(RunError::Usage(format!(
        "{option} {key}: nothing in this case reads it, and all runs would be the same; {fix}"
    )))
}

/// Runs a case with a variant's changes into a folder; its summary.
///
/// # Errors
/// Those of the command `run`.
pub fn run(case: &Path, variant: &Variant, folder: &Path) -> Result<Value, RunError> {
    let since = Instant::now();
    perform(case, &planned(case, variant)?, since, folder)
}

/// Runs what has been planned since `since`, from a case file into a folder, in which it replaces an
/// earlier run; its summary.
///
/// # Errors
/// Those of the command `run`.
pub fn perform(
    case: &Path,
    planned: &Planned,
    since: Instant,
    folder: &Path,
) -> Result<Value, RunError> {
    let start = RunStart { since, plan_seconds: since.elapsed().as_secs_f64() };
    let folder = ResultFolder::prepare(folder, case, Existing::Replace)?;
    let outcome = perform::run(planned, &folder, &silent(), start, None, None);
    outcome.error.map_or(Ok(outcome.summary), Err)
}

/// Iterations of a window that an implicit scheme is expected to take.
const EXPECTED_ITERATIONS: f64 = 10.0;

/// What the participants of a plan expect it to take in all \[s\].
#[must_use]
pub fn expected_seconds(plan: &Plan) -> f64 {
    let solves = if plan.scheme.scheme.is_implicit() { EXPECTED_ITERATIONS } else { 1.0 };
    plan.participants.iter().map(|one| one.expected_seconds(&plan.windows, solves)).sum()
}

/// Seconds of a run besides what its participants expect of their work: processes that start and end.
const OVERHEAD: f64 = 0.06;

/// How long a run of a variant is expected to take \[s\]; one that cannot be planned ends at once.
#[must_use]
pub fn expected_run_seconds(planned: Option<&Planned>) -> f64 {
    planned.map_or(0.0, |planned| OVERHEAD + expected_seconds(&planned.plan))
}

/// Whether an error ends the whole study, and not only the run that it ended.
#[must_use]
pub fn ends_study(error: &RunError) -> bool {
    error.is_interrupt()
}
