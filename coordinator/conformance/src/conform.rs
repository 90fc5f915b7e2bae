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
mod report;
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
pub(crate) use report::Report;
pub(crate) use request::Request;

use bench::Bench;
use check::Check;
use clap::Args;
use console::command::{Command, Context, Group};
use console::output::{Speaker, print};
use console::steps::Steps;
use contract::text::json;
use fault::{Fault, Seen};
use run::error::{Failure, RunError};
use run::programs::Program;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Options of `coordinator conform`.
#[derive(Debug, Args)]
pub struct ConformCommand {
    /// The role that it plays.
    #[arg(long, value_name = "ROLE")]
    role: String,
    /// The case that it is configured with, for every model and mode it offers [default: the scene
    /// wheel-rail].
    #[arg(long, value_name = "FILE")]
    case: Option<PathBuf>,
    /// Change a key of the case: dotted name and TOML value (a bare word is a text).
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Remove a key of the case.
    #[arg(long, value_name = "KEY")]
    unset: Vec<String>,
    /// Take the inputs from this recording [default: smooth fields of a likely magnitude].
    #[arg(long, value_name = "FILE")]
    recording: Option<PathBuf>,
    /// Make this check alone; may be given several times.
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// The cheapest model and mode alone, on small grids: for while a solver is written.
    #[arg(long)]
    quick: bool,
    /// Longest wait for an answer [s].
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0)]
    deadline: f64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    /// The program, with its arguments [default: ROLE-solver].
    #[arg(last = true, value_name = "COMMAND")]
    command: Vec<String>,
}

impl Command for ConformCommand {
    const NAME: &'static str = "conform";
    const GROUP: Group = Group::Solvers;
    const ABOUT: &'static str =
        "Put a participant through the whole contract, and print how it went";

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
            set: self.set.clone(),
            unset: self.unset.clone(),
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
                speaker.say(&show::head(report));
            }
            News::Begins(check) => progress.iter_mut().for_each(|steps| steps.step(check)),
            News::Made(row) if row.verdict == CheckOutcome::NotMade => {}
            News::Made(row) => {
                let mut say = || speaker.say(&show::line(row));
                match &progress {
                    Some(steps) => steps.aside(say),
                    None => say(),
                }
            }
        });
        progress.into_iter().for_each(Steps::finish);
        let report = report?;
        speaker.say(&show::tail(&report));
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
