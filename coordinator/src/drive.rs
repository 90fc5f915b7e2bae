//! `coordinator drive`: a run driven by lines on standard input and output.

mod line;
mod streams;

use case::Case;
use clap::Args;
use console::case_arguments::CaseArguments;
use console::command::{Command, Context, Group};
use console::logging::{Logging, log_warnings};
use coupling::windows::Windows;
use line::{Answer, LiveKey, Request, VERSION};
use run::error::{RunError, file_failure};
use run::fleet::Fleet;
use run::perform::{self, Driven, Driver, DriverError, RunOptions};
use run::plan::Planned;
use run::results::{Existing, ResultFolder};
use run::scratch::Scratch;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use streams::{LineReader, LineWriter, Received};

/// Interval of checks of processes and signals while no request arrives.
const LOOK: Duration = Duration::from_millis(20);
/// Number of checks after which the doorbell is emptied.
const LOOKS: u32 = 50;

/// Options of `coordinator drive`.
#[derive(Debug, Args)]
pub(crate) struct DriveCommand {
    #[command(flatten)]
    of: CaseArguments,
    /// Result directory [default: none; results are discarded].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace the results of an earlier run in DIR.
    #[arg(long)]
    replace: bool,
}

impl Command for DriveCommand {
    const NAME: &'static str = "drive";
    const GROUP: Group = Group::Connect;
    const ABOUT: &'static str = "Run a case window by window, by JSON lines";
    const EXAMPLES: &'static [&'static str] = &["coordinator drive CASE"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let answers = LineWriter::open();
        let ended = drive(self, context.log, context.since, &answers);
        if let Err(error) = &ended {
            // The driving program reads errors from standard output, whatever ended the run.
            let answer = Answer::Failed { error: error.to_string(), kind: "ended" };
            answers.write_last(answer.line())?;
        }
        ended
    }
}

fn drive(
    command: &DriveCommand,
    log: &Logging,
    since: Instant,
    answers: &LineWriter,
) -> Result<(), RunError> {
    if command.of.case == Path::new("-") {
        let why = "standard input has the lines that drive the run; name a file of the case";
        return Err(RunError::Usage(why.to_owned()));
    }
    let mut fleet = Fleet::for_study();
    let planned = planned(&command.of, &mut fleet)?;
    let plan_seconds = since.elapsed().as_secs_f64();
    let unkept = match &command.out {
        Some(_) => None,
        None => Some(Scratch::new()?),
    };
    let unkept_path = unkept.as_ref().map(|folder| folder.path().join("results"));
    let path = command.out.as_deref().or(unkept_path.as_deref()).unwrap_or(Path::new("results"));
    let input = LineReader::open(BufReader::new(std::io::stdin()));
    let mut lines = Lines { input, answers, end: End::OfInput };
    let mut existing = Existing::option(command.replace);
    let (mut since, mut plan_seconds) = (since, plan_seconds);
    loop {
        let folder = ResultFolder::prepare(path, &command.of.case, existing)?;
        log.write_to(folder.log()?, folder.shown_log())
            .map_err(|error| file_failure(&folder.shown_log(), &error))?;
        let driver: &mut dyn Driver = &mut lines;
        let options =
            RunOptions { since, plan_seconds, driver: Some(driver), ..RunOptions::default() };
        let outcome = perform::run(&planned, &mut fleet, &folder, options);
        if unkept.is_some() || lines.end == End::Reset {
            log.release();
        }
        match (outcome.error, lines.end) {
            (Some(error), _) => return Err(error),
            (None, End::OfInput) => return Ok(()),
            (None, End::Finish) => return answers.write_last(Answer::DONE.line()),
            (None, End::Reset) => {
                existing = Existing::Replace;
                (since, plan_seconds) = (Instant::now(), 0.0);
            }
        }
    }
}

/// Reason why a driven run ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    /// End of standard input.
    OfInput,
    /// Request to end the run, which is to be confirmed.
    Finish,
    /// Request of another run.
    Reset,
}

/// Returns the plan of a driven case.
///
/// # Errors
/// The case is invalid, or its windows cannot be requested one by one.
pub(crate) fn planned(of: &CaseArguments, fleet: &mut Fleet) -> Result<Planned, RunError> {
    let mut planned = of.plan(fleet)?;
    log_warnings(&planned.plan.warnings);
    planned.plan.windows = open(&planned.case, &planned.plan.windows)?;
    // The end of the case is not that of the run, which a participant may rely on.
    for participant in &mut planned.plan.participants {
        participant.configuration.windows.iter_mut().for_each(|windows| windows.end = None);
    }
    Ok(planned)
}

/// Returns the windows of a case, which are requested one by one.
fn open(case: &Case, windows: &Windows) -> Result<Windows, RunError> {
    match windows {
        Windows::Steady => Ok(Windows::Open { window: None }),
        Windows::Fixed { window, .. } => Ok(Windows::Open { window: Some(*window) }),
        Windows::Sequence(_) => Err(refusal(
            case,
            "time.mode",
            "a sequence has the windows of its table, and nobody can ask for others",
            "write time.mode = \"steady\", and live values in the place of columns",
        )),
        Windows::Adaptive { .. } | Windows::Open { .. } => Err(refusal(
            case,
            "time.control",
            "adaptive windows are chosen by the run, and whoever drives it chooses them",
            "remove time.control",
        )),
    }
}

/// Returns the error for a case that cannot be driven.
pub(crate) fn refusal(case: &Case, key: &str, reason: &str, fix: impl Into<String>) -> RunError {
    let problem = case.problem_at(key, reason, fix);
    case.fail(problem).into()
}

/// Driver of a run, by lines of standard input.
struct Lines<'a> {
    input: LineReader,
    answers: &'a LineWriter,
    end: End,
}

impl Driver for Lines<'_> {
    fn drive(&mut self, run: &mut Driven<'_, '_>) -> Result<(), RunError> {
        self.answers.write(ready(run), || run.idle(Duration::ZERO))?;
        let mut looks = 0;
        loop {
            let answer = match self.input.receive(LOOK) {
                Received::Nothing => {
                    looks += 1;
                    let time =
                        if looks % LOOKS == 0 { Duration::from_millis(1) } else { Duration::ZERO };
                    run.idle(time)?;
                    continue;
                }
                Received::End => {
                    self.end = End::OfInput;
                    return Ok(());
                }
                Received::Invalid(what) => Answer::refused(what),
                Received::Line(line) => match Request::read(&line) {
                    Err(what) => Answer::refused(what),
                    Ok(Request::Finish {}) => {
                        self.end = End::Finish;
                        return Ok(());
                    }
                    Ok(Request::Reset {}) => {
                        self.end = End::Reset;
                        return Ok(());
                    }
                    Ok(request) => match act(run, request) {
                        Ok(answer) => answer,
                        Err(fault) => match Answer::of_fault(fault) {
                            (_, Some(error)) => return Err(error),
                            (answer, None) => answer,
                        },
                    },
                },
            };
            self.answers.write(answer.line(), || run.idle(Duration::ZERO))?;
        }
    }
}

/// Prints the first line: the layout of the run.
fn ready(run: &Driven<'_, '_>) -> String {
    let plan = run.plan();
    let own = plan.live.iter().filter(|live| live.provider.is_none());
    let live = own.map(|live| LiveKey {
        key: &live.kind.name,
        unit: &live.kind.unit,
        at: live.first,
        from: live.limits[0],
        to: live.limits[1],
    });
    let window = match plan.windows {
        Windows::Open { window } => window,
        _ => None,
    };
    let one_way = run.one_way();
    let (figures, one_way) = (run.figures().collect(), one_way.as_deref());
    let live = live.collect();
    Answer::Ready { ready: VERSION, case: &plan.name, window, live, figures, one_way }.line()
}

fn act(run: &mut Driven<'_, '_>, request: Request) -> Result<Answer<'static>, DriverError> {
    match request {
        Request::Set { values } => run.give(&values).map(|()| Answer::DONE),
        Request::Step { set, end, observe } => run.step(&set, end, observe).map(Answer::stepped),
        Request::Save {} => run.save().map(|state| Answer::Saved { state }),
        Request::Restore { state } => run.restore(state).map(|()| Answer::DONE),
        Request::Free { state } => run.free(state).map(|()| Answer::DONE),
        Request::Finish {} | Request::Reset {} => Ok(Answer::DONE),
    }
}
