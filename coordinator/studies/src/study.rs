//! Shared parts of the commands that run a case many times with changed values: `cost`, `ablate`,
//! `run --accuracy`, `stability` and `reproduce`.
//!
//! [`Changes`] are the changed values of a case. [`run`] performs a variant like any other run, in
//! the same processes and with the same shared memory. [`quantity`] names the quantities of a
//! summary that studies compare, [`richardson`] estimates their errors from several grids, and
//! [`levels`] lists the models and resolutions that are available for a case. [`arguments`],
//! [`folder`], [`output`] and [`table`] hold the common options, the result folder and the
//! presentation of results.
//!
//! The code is independent of particular models and effects: the descriptions of the participants
//! list the available variations.

pub mod arguments;
pub mod axis;
pub(crate) mod finished;
pub mod folder;
pub mod levels;
pub mod output;
pub mod quantity;
mod range;
pub mod richardson;
pub(crate) mod runner;
pub mod spent;
pub mod table;

use case::RawCase;
use console::case_arguments::{Changes, read_case};
use run::error::RunError;
use run::fleet::Fleet;
use run::perform::{self, RunOptions};
use run::plan::{Plan, Planned, plan};
use run::results::ResultFolder;
use run::signals;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Plans a case with the changes of a variant.
///
/// # Errors
/// The case is invalid, or a program that the case names cannot be used.
pub fn planned(case: &Path, variant: &Changes, fleet: &mut Fleet) -> Result<Planned, RunError> {
    let mut raw = read(case)?;
    raw.apply(&variant.set, &variant.unset)?;
    plan(raw, fleet)
}

/// Reads a case once per process, so that all runs of a study use the same text even if the file is
/// edited meanwhile.
fn read(case: &Path) -> Result<RawCase, RunError> {
    static READ: Mutex<BTreeMap<PathBuf, RawCase>> = Mutex::new(BTreeMap::new());
    let mut known = READ.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(raw) = known.get(case) {
        return Ok(raw.clone());
    }
    // Reading from standard input may block for ever, so a signal must end the process at once.
    // Anywhere else a signal ends the study in order, and finished runs are kept.
    let reading = (case == Path::new("-")).then(signals::end_at_once);
    let raw = read_case(case)?;
    drop(reading);
    known.insert(case.to_owned(), raw.clone());
    Ok(raw)
}

/// Refuses to vary a key that nothing in the case reads, because every run would give the same
/// result.
///
/// # Errors
/// Nothing reads the key. The error names the option, the key and the choices that would read the
/// key.
pub fn refuse_unread(standing: &Planned, key: &str, option: &str) -> Result<(), RunError> {
    let within = |other: &str| {
        other == key || other.strip_prefix(key).is_some_and(|rest| rest.starts_with('.'))
    };
    let Some(unread) = standing.case.unread.iter().find(|unread| within(&unread.key)) else {
        return Ok(());
    };
    let fix = match unread.readers.as_slice() {
        [] => "refer to its entry where it is to be used".to_owned(),
        readers => format!("choose {}", readers.join(" or ")),
    };
    Err(RunError::Usage(format!(
        "{option} {key}: nothing in this case reads it, so all runs would be the same; {fix}"
    )))
}

/// Runs a case with the changes of a variant into a folder and returns the summary.
///
/// # Errors
/// The case cannot be planned or run, as with the command `run`.
pub fn run(
    case: &Path,
    variant: &Changes,
    folder: &ResultFolder,
    fleet: &mut Fleet,
) -> Result<Value, RunError> {
    let since = Instant::now();
    let planned = planned(case, variant, fleet)?;
    perform(&planned, since, folder, fleet)
}

/// Runs a planned case into a folder and returns the summary. `since` is the time at which planning
/// began.
///
/// # Errors
/// The run fails, or the folder cannot be written.
pub fn perform(
    planned: &Planned,
    since: Instant,
    folder: &ResultFolder,
    fleet: &mut Fleet,
) -> Result<Value, RunError> {
    let outcome = perform::run(planned, fleet, folder, RunOptions::planned_since(since));
    outcome.error.map_or(Ok(outcome.summary), Err)
}

/// Assumed number of iterations per window for an implicit scheme.
const EXPECTED_ITERATIONS: f64 = 10.0;

/// Run time that the participants of a plan expect in total \[s\].
#[must_use]
pub fn expected_seconds(plan: &Plan) -> f64 {
    let solves = if plan.scheme.scheme.is_implicit() { EXPECTED_ITERATIONS } else { 1.0 };
    plan.participants.iter().map(|one| one.expected_seconds(&plan.windows, solves)).sum()
}

/// Time to start and end the processes of a run, on top of the work that the participants expect
/// \[s\].
const OVERHEAD: f64 = 0.06;

/// Expected time of a run of a variant \[s\]; zero for `None`, a variant that cannot be planned.
#[must_use]
pub fn expected_run_seconds(planned: Option<&Planned>) -> f64 {
    planned.map_or(0.0, |planned| OVERHEAD + expected_seconds(&planned.plan))
}

/// Returns whether an error ends the whole study rather than a single run.
#[must_use]
pub fn ends_study(error: &RunError) -> bool {
    error.is_interrupt()
}
