//! `coordinator conform`: checks any executable against the whole participant contract.
//!
//! [`CHECKS`] lists the demands of the contract, one entry for each. The participant runs as a
//! separate process over real shared memory ([`life`]). A check takes over the process of an
//! earlier check if that is still in order; otherwise it starts a fresh one ([`bench`]). Every wait
//! has a deadline, so that a process that hangs or dies does not spoil other checks. Configurations
//! come from a case ([`setting`]), for every model and mode that the participant offers. Inputs are
//! made up or recorded ([`input`]).
//!
//! ```text
//! Request ──Bench::prepare──► Bench ──each of CHECKS──► CheckResult ──► Report
//! ```
//!
//! | stage | checks |
//! |---|---|
//! | [`description`] | description of a participant |
//! | [`configuration`] | runs and configurations that it accepts, or refuses with a reason |
//! | [`solve`] | first outputs, solves from the accepted state, `Accept`, grids of any size, volumes |
//! | [`state`] | `Save` and `Restore`, and damaged states |
//! | [`robustness`] | samples and commands that are missing, wrong or out of order |
//! | [`finish`] | heartbeats, the death of the coordinator, figures, another run, the end |

mod bench;
mod check;
mod configuration;
mod description;
mod fault;
mod finish;
mod input;
mod life;
mod robustness;
mod setting;
mod solve;
mod state;

use bench::TestBench;
use check::{Check, CheckOutcome, CheckResult, Report};
use clap::Args;
use console::case_arguments::Changes;
use console::command::{Command, Context, Group};
use console::output::{Speaker, print};
use console::steps::Steps;
use contract::text::json;
use fault::{CheckFailure, Finding};
use run::error::{Failure, RunError};
use run::program::Program;
use setting::Request;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Options of `coordinator conform`.
#[derive(Debug, Args)]
pub struct ConformCommand {
    /// Role of the participant.
    #[arg(long, value_name = "ROLE")]
    role: String,
    /// Case that configures the participant, for every model and mode it offers [default: the scene
    /// wheel-rail].
    #[arg(long, value_name = "FILE")]
    case: Option<PathBuf>,
    #[command(flatten)]
    changes: Changes,
    /// Take the inputs from this recording [default: smooth fields of a likely magnitude].
    #[arg(long, value_name = "FILE")]
    recording: Option<PathBuf>,
    /// Make only this check; may be given several times.
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Check only the cheapest model and mode, on small grids; for use while a solver is written.
    #[arg(long)]
    quick: bool,
    /// Longest wait for an answer [s].
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0)]
    deadline: f64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    /// Program of the participant, with its arguments [default: ROLE-solver].
    #[arg(last = true, value_name = "COMMAND")]
    command: Vec<String>,
}

impl Command for ConformCommand {
    const NAME: &'static str = "conform";
    const GROUP: Group = Group::Solvers;
    const ABOUT: &'static str = "Check a participant against the whole contract";
    const EXAMPLES: &'static [&'static str] =
        &["coordinator conform --quick --role thermal -- ./my-solver"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        if !(self.deadline > 0.0 && self.deadline <= 1e6) {
            return Err(RunError::Usage(
                "--deadline must be a number of seconds above 0".to_owned(),
            ));
        }
        let command = (!self.command.is_empty()).then_some(self.command.as_slice());
        let request = Request {
            role: self.role.clone(),
            program: Program::of_role(&self.role, command),
            case: self.case.clone(),
            changes: self.changes.clone(),
            recording: self.recording.clone(),
            only: self.only.clone(),
            quick: self.quick,
            patience: Duration::from_secs_f64(self.deadline),
        };
        let silent = context.quiet || self.json;
        let mut speaker = Speaker::new(silent);
        let mut progress: Option<Steps> = None;
        let report = conform(&request, &mut |news| match news {
            News::Prepared(report, count) => {
                progress = Some(Steps::new(silent, count));
                speaker.say(&check::head(report));
            }
            News::Begins(check) => progress.iter_mut().for_each(|steps| steps.step(check)),
            News::Made(row) if row.verdict == CheckOutcome::NotMade => {}
            News::Made(row) => {
                let mut say = || speaker.say(&check::line(row));
                match &progress {
                    Some(steps) => steps.aside(say),
                    None => say(),
                }
            }
        });
        progress.into_iter().for_each(Steps::finish);
        let report = report?;
        speaker.say(&check::tail(&report));
        if self.json {
            print(&json(&report))?;
        }
        speaker.end(verdict(&request, &report))
    }
}

fn verdict(request: &Request, report: &Report) -> Result<(), RunError> {
    let failed: Vec<&str> = report.failed().map(|row| row.name).collect();
    if failed.is_empty() {
        return Ok(());
    }
    Err(RunError::Failed(Failure {
        who: format!("{} ({})", request.role, request.program.name()),
        when: format!("{} of {} checks", failed.len(), report.checks.len()),
        what: failed.join(", "),
        fix: "docs/write-a-solver.md states what each requires".to_owned(),
    }))
}

/// All checks, in the order in which a participant is best written.
const CHECKS: &[&Check] = &[
    &description::DESCRIBE,
    &configuration::VERSION,
    &configuration::CONFIGURE,
    &configuration::UNKNOWN_MODEL,
    &configuration::UNKNOWN_EFFECT,
    &configuration::MISSING_KEY,
    &configuration::UNKNOWN_FIELD,
    &solve::INITIALISE,
    &solve::SOLVE,
    &solve::RECEIVED_POWER,
    &solve::REPEAT,
    &solve::OTHER_END,
    &solve::NO_DURATION,
    &solve::ACCEPT,
    &solve::OBSERVE,
    &state::RESTORE,
    &state::DAMAGED_STATE,
    &solve::GROWING_GRIDS,
    &solve::VOLUMES,
    &robustness::MISSING_SAMPLE,
    &robustness::WRONG_SAMPLE,
    &robustness::NOT_FINITE,
    &robustness::UNKNOWN_COMMAND,
    &robustness::MALFORMED,
    &robustness::OUT_OF_ORDER,
    &finish::HEART,
    &finish::COORDINATOR_DIES,
    &finish::FIGURES,
    &finish::REUSE,
    &finish::FINISH,
];

/// Number of attempts of a check in which the participant is late.
const TRIES: usize = 3;

/// Progress of the checks.
#[derive(Clone, Copy, Debug)]
pub(crate) enum News<'a> {
    /// Everything is prepared for this number of checks.
    Prepared(&'a Report, usize),
    /// The check of this name begins.
    Begins(&'static str),
    /// A check was made.
    Made(&'a CheckResult),
}

/// Makes the checks. Calls `tell` for each as it begins and after it is made.
///
/// # Errors
/// The request is invalid, or the user has interrupted it. A failed check is not an error here.
pub(crate) fn conform(
    request: &Request,
    tell: &mut dyn FnMut(News<'_>),
) -> Result<Report, RunError> {
    let begun = Instant::now();
    let checks = chosen(&request.only)?;
    let configures = checks.iter().any(|check| check.name != description::DESCRIBE.name);
    let (bench, described) = TestBench::prepare(request, configures)?;
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
            // A cause is reported once; later checks refer to it.
            row.same_as = causes.get(&row.seen).copied();
            causes.entry(row.seen.clone()).or_insert(check.name);
        }
        tell(News::Made(&row));
        report.checks.push(row);
        report.wall_s = begun.elapsed().as_secs_f64();
    }
    Ok(report)
}

/// Makes a check, if the participant allows it.
fn made(
    check: &Check,
    bench: &TestBench,
    undescribed: Option<&CheckFailure>,
) -> Result<CheckResult, RunError> {
    let since = Instant::now();
    let outcome = match undescribed {
        // All other checks need the description.
        Some(fault) if check.name == description::DESCRIBE.name => Err(fault.clone()),
        Some(_) => return Ok(CheckResult::not_made(check, "it does not describe itself")),
        None if bench.never_joined() => {
            return Ok(CheckResult::not_made(check, "it never joined a run"));
        }
        None => in_time(check, bench),
    };
    if let Err(CheckFailure::Interrupted(signal)) = outcome {
        let when = format!("while `{}` was checked", check.name);
        return Err(RunError::Interrupted { signal, when });
    }
    Ok(CheckResult::new(check, outcome, since.elapsed()))
}

/// Makes a check, and repeats it if the participant was late: on a busy machine any process may
/// have to wait.
fn in_time(check: &Check, bench: &TestBench) -> Result<Finding, CheckFailure> {
    let mut outcome = (check.run)(bench);
    for _ in 1..TRIES {
        if !matches!(outcome, Err(CheckFailure::Late(_))) {
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
            assert!(check.name.len() <= check::NAME_WIDTH, "{}", check.name);
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
