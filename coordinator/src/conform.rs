//! `coordinator conform`: any executable, put through the whole participant contract.
//!
//! [`CHECKS`] is the list: what the contract demands, one entry a demand. The participant runs as a
//! process of its own over real shared memory ([`trial`]); what a check leaves in order the next one
//! goes on with, everything else has a fresh process ([`lives`]). Nothing is waited for without a
//! deadline; a process that hangs or dies spoils no other check. What a participant is
//! configured with comes from a case ([`setting`]), for every model and mode that it offers.
//!
//! ```text
//! Request ──Bench::prepare──► Bench ──each of CHECKS──► Row ──► Report
//! ```

mod accepting;
mod bench;
mod check;
mod cli;
mod describing;
mod faulty_inputs;
mod given;
mod grids;
mod leaving;
mod lives;
mod recorded;
mod refusing;
mod setting;
mod show;
mod solving;
mod state;
mod trial;
mod unruly;

pub use check::{Row, Verdict};
pub use cli::{Arguments, main};

use bench::Bench;
use check::{Check, Fault};
use run::error::RunError;
use run::programs::Program;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::{Duration, Instant};

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
    &faulty_inputs::MISSING_SAMPLE,
    &faulty_inputs::WRONG_SAMPLE,
    &faulty_inputs::NOT_FINITE,
    &unruly::UNKNOWN_COMMAND,
    &unruly::MALFORMED,
    &unruly::OUT_OF_ORDER,
    &leaving::HEART,
    &leaving::COORDINATOR_DIES,
    &leaving::FINISH,
];

/// What is to be put through the contract, and with what.
#[derive(Clone, Debug)]
pub struct Request {
    /// The role that it plays.
    pub role: String,
    /// The executable.
    pub program: Program,
    /// The case that it is configured with.
    pub case: PathBuf,
    /// Keys of the case to change.
    pub set: Vec<String>,
    /// Keys of the case to remove.
    pub unset: Vec<String>,
    /// A recording whose inputs are used in place of made-up ones.
    pub recording: Option<PathBuf>,
    /// Names of the checks to make; all if empty.
    pub only: Vec<String>,
    /// Only the cheapest model and mode, and small grids.
    pub quick: bool,
    /// Longest wait for an answer.
    pub patience: Duration,
}

/// How a participant went through the contract.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Report {
    /// Role that was asked for.
    pub role: String,
    /// Name and version of the program, as it describes itself; empty if it does not.
    pub program: String,
    /// Model and mode of every setting that it was checked in.
    pub settings: Vec<String>,
    /// Settings that the case does not give, and why.
    pub left_out: Vec<String>,
    /// One row a check.
    pub checks: Vec<Row>,
    /// Seconds of all checks.
    pub wall_s: f64,
}

impl Report {
    /// The checks that failed.
    pub fn failed(&self) -> impl Iterator<Item = &Row> {
        self.checks.iter().filter(|row| row.verdict == Verdict::Failed)
    }
}

/// What there is to tell while checks are made.
#[derive(Clone, Copy, Debug)]
pub enum News<'a> {
    /// Everything is prepared for so many checks.
    Prepared(&'a Report, usize),
    /// The check of this name begins.
    Begins(&'static str),
    /// A check was made.
    Made(&'a Row),
}

/// Makes the checks; `tell` hears of each as it begins and as soon as it is made.
///
/// # Errors
/// The request cannot be, or the user has stopped it. A check that fails is no error here.
pub fn conform(request: &Request, tell: &mut dyn FnMut(News<'_>)) -> Result<Report, RunError> {
    let begun = Instant::now();
    let checks = chosen(&request.only)?;
    let (bench, described) = Bench::prepare(request)?;
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
        if row.verdict == Verdict::Failed {
            // One cause is told once.
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
fn made(check: &Check, bench: &Bench, undescribed: Option<&Fault>) -> Result<Row, RunError> {
    let since = Instant::now();
    let outcome = match undescribed {
        // Nothing can be asked of what does not say what it is.
        Some(fault) if check.name == describing::DESCRIBE.name => Err(fault.clone()),
        Some(_) => return Ok(Row::not_made(check, "it does not describe itself")),
        None if bench.never_joined() => {
            return Ok(Row::not_made(check, "it never joined a run"));
        }
        None => (check.run)(bench),
    };
    if let Err(Fault::Interrupted(signal)) = outcome {
        let when = format!("while `{}` was checked", check.name);
        return Err(RunError::Interrupted { signal, when });
    }
    Ok(Row::new(check, outcome, since.elapsed()))
}

fn chosen(names: &[String]) -> Result<Vec<&'static Check>, RunError> {
    let unknown = names.iter().find(|name| CHECKS.iter().all(|check| check.name != **name));
    if let Some(name) = unknown {
        let known: Vec<&str> = CHECKS.iter().map(|check| check.name).collect();
        let known = known.join(", ");
        return Err(RunError::Usage(format!("there is no check `{name}`; there are: {known}")));
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
