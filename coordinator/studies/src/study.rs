//! Shared parts of the commands that run a case many times with changed values: `cost`, `ablate`,
//! `run --accuracy`, `stability` and `reproduce`.
//!
//! [`Changes`](console::case_arguments::Changes) are the changed values of a case. A
//! [`bench::Bench`] performs a variant like any other run, with the same programs and the same
//! shared memory. [`quantity`] names the quantities of a
//! summary that studies compare, [`richardson`] estimates their errors from several grids, and
//! [`levels`] lists the models and resolutions that are available for a case. [`arguments`],
//! [`folder`], [`output`] and [`table`] hold the common options, the result folder and the
//! presentation of results.
//!
//! The code is independent of particular models and effects: the descriptions of the participants
//! list the available variations.

pub mod arguments;
pub mod axis;
pub mod bench;
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
pub(crate) mod variants;

use run::error::RunError;
use run::plan::{Plan, Planned};

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
