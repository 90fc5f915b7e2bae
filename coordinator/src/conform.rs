//! `coordinator conform`: any executable, put through the whole participant contract.
//!
//! [`CHECKS`] is the list: what the contract demands, one entry a demand. The participant runs as a
//! process of its own over real shared memory ([`life`]); what a check leaves in order the next one
//! goes on with, everything else has a fresh process ([`lives`]). Nothing is waited for without a
//! deadline; a process that hangs or dies spoils no other check. What a participant is
//! configured with comes from a case ([`setting`]), for every model and mode that it offers.
//!
//! ```text
//! Request ──Bench::prepare──► Bench ──each of CHECKS──► CheckResult ──► Report
//! ```

mod accepting;
mod bench;
mod check;
mod cli;
mod describing;
mod fault;
mod faulty_inputs;
mod given;
mod grids;
mod leaving;
mod life;
mod lives;
mod recorded;
mod refusing;
mod request;
mod setting;
mod shared;
mod show;
mod solving;
mod state;
mod subject;
mod unruly;
mod volumes;

pub(crate) use check::{CheckOutcome, CheckResult};
pub(crate) use cli::{Arguments, main};
pub(crate) use request::Request;

use bench::Bench;
use check::Check;
use fault::{Fault, Seen};
use run::error::RunError;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

/// Everything that is checked, in the order in which a participant is best written.
const CHECKS: &[&Check] = &[
    &describing::DESCRIBE,
    &describing::ESTIMATE,
    &refusing::VERSION,
    &describing::CONFIGURE,
    &refusing::UNKNOWN_MODEL,
    &refusing::UNKNOWN_EFFECT,
    &refusing::MISSING_KEY,
    &refusing::UNKNOWN_FIELD,
    &solving::INITIALISE,
    &solving::SOLVE,
    &solving::HEAT,
    &solving::REPEAT,
    &solving::OTHER_END,
    &solving::NO_DURATION,
    &accepting::ACCEPT,
    &accepting::OBSERVE,
    &state::RESTORE,
    &state::DAMAGED_STATE,
    &grids::GROWING_GRIDS,
    &volumes::VOLUMES,
    &faulty_inputs::MISSING_SAMPLE,
    &faulty_inputs::WRONG_SAMPLE,
    &faulty_inputs::NOT_FINITE,
    &unruly::UNKNOWN_COMMAND,
    &unruly::MALFORMED,
    &unruly::OUT_OF_ORDER,
    &leaving::HEART,
    &leaving::COORDINATOR_DIES,
    &leaving::FIGURES,
    &leaving::REUSE,
    &leaving::FINISH,
];

/// How often a participant may try to be in time.
const TRIES: usize = 3;

/// How a participant went through the contract.
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

/// What there is to tell while checks are made.
#[derive(Clone, Copy, Debug)]
pub(crate) enum News<'a> {
    /// Everything is prepared for so many checks.
    Prepared(&'a Report, usize),
    /// The check of this name begins.
    Begins(&'static str),
    /// A check was made.
    Made(&'a CheckResult),
}

/// Makes the checks; `tell` is called for each as it begins and as soon as it is made.
///
/// # Errors
/// The request cannot be, or the user has stopped it. A check that fails is no error here.
pub(crate) fn conform(
    request: &Request,
    tell: &mut dyn FnMut(News<'_>),
) -> Result<Report, RunError> {
    let begun = Instant::now();
    let checks = chosen(&request.only)?;
    let configures = checks.iter().any(|check| check.name != describing::DESCRIBE.name);
    let (bench, described) = Bench::prepare(request, configures)?;
    let mut report = Report {
        role: request.role.clone(),
        program: bench.program_name(),
        settings: bench.settings.iter().map(|setting| setting.label()).collect(),
        left_out: bench.left_out.clone(),
        ..Report::default()
    };
    tell(News::Prepared(&report, checks.len()));
    let mut causes: BTreeMap<String, &'static str> = BTreeMap::new();
    for check in checks {
        tell(News::Begins(check.name));
        let mut row = made(check, &bench, described.as_ref())?;
        if row.verdict == CheckOutcome::Failed {
            // One cause is reported once.
            row.same_as = causes.get(&row.seen).copied();
            causes.entry(row.seen.clone()).or_insert(check.name);
        }
        tell(News::Made(&row));
        report.checks.push(row);
        report.wall_s = begun.elapsed().as_secs_f64();
    }
    Ok(report)
}

/// Makes a check, if it can be made.
fn made(
    check: &Check,
    bench: &Bench,
    undescribed: Option<&Fault>,
) -> Result<CheckResult, RunError> {
    let since = Instant::now();
    let outcome = match undescribed {
        // Nothing can be asked of what does not say what it is.
        Some(fault) if check.name == describing::DESCRIBE.name => Err(fault.clone()),
        Some(_) => return Ok(CheckResult::not_made(check, "it does not describe itself")),
        None if bench.never_joined() => {
            return Ok(CheckResult::not_made(check, "it never joined a run"));
        }
        None => in_time(check, bench),
    };
    if let Err(Fault::Interrupted(signal)) = outcome {
        let when = format!("while `{}` was checked", check.name);
        return Err(RunError::Interrupted { signal, when });
    }
    Ok(CheckResult::new(check, outcome, since.elapsed()))
}

/// Makes a check, again if something was late: on a busy machine any process may have to wait.
fn in_time(check: &Check, bench: &Bench) -> Result<Seen, Fault> {
    let mut outcome = (check.run)(bench);
    for _ in 1..TRIES {
        if !matches!(outcome, Err(Fault::Late(_))) {
            break;
        }
        outcome = (check.run)(bench);
    }
    outcome
}

fn chosen(names: &[String]) -> Result<Vec<&'static Check>, RunError> {
    let unknown = names.iter().find(|name| CHECKS.iter().all(|check| check.name != **name));
    if let Some(name) = unknown {
        let known: Vec<&str> = CHECKS.iter().map(|check| check.name).collect();
        let known = known.join(", ");
        return Err(RunError::Usage(format!("unknown check `{name}`; known checks: {known}")));
    }
    let wanted = |check: &&&Check| names.is_empty() || names.iter().any(|n| n == check.name);
    Ok(CHECKS.iter().filter(wanted).copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_check_has_a_name_of_its_own_a_demand_and_a_fix() {
        for (index, check) in CHECKS.iter().enumerate() {
            assert!(CHECKS[..index].iter().all(|other| other.name != check.name), "{}", check.name);
            assert!(check.name.len() <= show::NAME_WIDTH, "{}", check.name);
            assert!(!check.demand.is_empty() && !check.fix.is_empty(), "{}", check.name);
        }
    }

    #[test]
    fn an_unknown_check_is_named_with_those_there_are() {
        assert_eq!(chosen(&["finish".to_owned()]).unwrap().len(), 1);
        assert_eq!(chosen(&[]).unwrap().len(), CHECKS.len());
        let error = chosen(&["finnish".to_owned()]).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("finnish") && error.to_string().contains("heart"));
    }
}
