//! `coordinator drive`: a run that is driven from outside, by lines on standard input and output.
//!
//! | file | what |
//! |---|---|
//! | `line.rs` | the language: one JSON object a line, each way |
//! | `ear.rs` | lines of standard input, which come when they come |
//! | `answers.rs` | lines of standard output, which are read when they are read |

mod answers;
mod ear;
mod line;

use answers::Answers;
use case::Case;
use clap::Args;
use console::case_arguments::CaseArguments;
use console::command::{Command, Context, Group};
use console::logging::{Logging, log_warnings};
use coupling::windows::Windows;
use ear::{Ear, Heard};
use line::{Answer, LiveKey, Request, VERSION};
use run::crew;
use run::error::{RunError, file_failure};
use run::perform::{self, Driven, Driver, Fault, RunStart};
use run::plan::Planned;
use run::progress::silent;
use run::results::{Existing, ResultFolder};
use run::scratch::Scratch;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Between two looks at processes and signals while nothing is asked for.
const LOOK: Duration = Duration::from_millis(20);
/// Looks after which the doorbell is emptied.
const LOOKS: u32 = 50;

/// Options of `coordinator drive`.
#[derive(Debug, Args)]
pub(crate) struct DriveCommand {
    #[command(flatten)]
    of: CaseArguments,
    /// Result directory [default: none, results are not kept].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace the results of an earlier run in DIR.
    #[arg(long)]
    replace: bool,
}

impl Command for DriveCommand {
    const NAME: &'static str = "drive";
    const GROUP: Group = Group::Connect;
    const ABOUT: &'static str =
        "Drive a run from outside, window by window: JSON lines on standard input and output";

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let answers = Answers::open();
        let ended = drive(self, context.log, context.since, &answers);
        if let Err(error) = &ended {
            // Whoever drives reads it there, whatever has ended the run.
            let answer = Answer::Failed { error: error.to_string(), kind: "ended" };
            answers.write_last(answer.line())?;
        }
        ended
    }
}

fn drive(
    asked: &DriveCommand,
    log: &Logging,
    since: Instant,
    answers: &Answers,
) -> Result<(), RunError> {
    if asked.of.case == Path::new("-") {
        let why = "standard input has the lines that drive the run; name a file of the case";
        return Err(RunError::Usage(why.to_owned()));
    }
    let _participants = crew::keep();
    let planned = planned(&asked.of)?;
    let plan_seconds = since.elapsed().as_secs_f64();
    let unkept = match &asked.out {
        Some(_) => None,
        None => Some(Scratch::new()?),
    };
    let unkept_path = unkept.as_ref().map(|folder| folder.path().join("results"));
    let path = asked.out.as_deref().or(unkept_path.as_deref()).unwrap_or(Path::new("results"));
    let ear = Ear::open(BufReader::new(std::io::stdin()));
    let mut lines = Lines { ear, answers, end: End::OfInput };
    let mut existing = Existing::option(asked.replace);
    let mut start = RunStart { since, plan_seconds };
    loop {
        let folder = ResultFolder::prepare(path, &asked.of.case, existing)?;
        log.write_to(folder.log()?, folder.shown_log())
            .map_err(|error| file_failure(&folder.shown_log(), &error))?;
        let outcome = perform::drive(&planned, &folder, &silent(), start, &mut lines);
        if unkept.is_some() || lines.end == End::Reset {
            log.release();
        }
        match (outcome.error, lines.end) {
            (Some(error), _) => return Err(error),
            (None, End::OfInput) => return Ok(()),
            (None, End::Finish) => return answers.write_last(Answer::DONE.line()),
            (None, End::Reset) => {
                existing = Existing::Replace;
                start = RunStart { since: Instant::now(), plan_seconds: 0.0 };
            }
        }
    }
}

/// Reason why a driven run ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    /// There are no more.
    OfInput,
    /// The end was asked for, and is to be confirmed.
    Finish,
    /// Another run was asked for.
    Reset,
}

/// The plan of a case that is driven.
///
/// # Errors
/// That of the case; windows that nobody can ask for.
pub(crate) fn planned(of: &CaseArguments) -> Result<Planned, RunError> {
    let mut planned = of.plan()?;
    log_warnings(&planned.plan.warnings);
    planned.plan.windows = open(&planned.case, &planned.plan.windows)?;
    Ok(planned)
}

/// The windows of a case, as they are asked for one by one.
fn open(case: &Case, windows: &Windows) -> Result<Windows, RunError> {
    let refuse = |key: &str, reason: &str, fix: &str| {
        let problem = case.problem_at(key, reason, fix);
        Err(case.report(vec![problem]).expect("there is a problem").into())
    };
    match windows {
        Windows::Steady => Ok(Windows::Open { window: None }),
        Windows::Fixed { window, .. } => Ok(Windows::Open { window: Some(*window) }),
        Windows::Sequence(_) => refuse(
            "time.mode",
            "a sequence has the windows of its table, and nobody can ask for others",
            "write time.mode = \"steady\", and live values in the place of columns",
        ),
        Windows::Adaptive { .. } | Windows::Open { .. } => refuse(
            "time.control",
            "adaptive windows are chosen by the run, and whoever drives it chooses them",
            "remove time.control",
        ),
    }
}

/// Who drives the run: the lines of standard input.
struct Lines<'a> {
    ear: Ear,
    answers: &'a Answers,
    end: End,
}

impl Driver for Lines<'_> {
    fn drive(&mut self, run: &mut Driven<'_, '_>) -> Result<(), RunError> {
        self.answers.write(ready(run), || run.idle(Duration::ZERO))?;
        let mut looks = 0;
        loop {
            let answer = match self.ear.hear(LOOK) {
                Heard::Nothing => {
                    looks += 1;
                    let time =
                        if looks % LOOKS == 0 { Duration::from_millis(1) } else { Duration::ZERO };
                    run.idle(time)?;
                    continue;
                }
                Heard::End => {
                    self.end = End::OfInput;
                    return Ok(());
                }
                Heard::Noise(what) => Answer::refused(what),
                Heard::Line(line) => match Request::read(&line) {
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

/// The first line.
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

fn act(run: &mut Driven<'_, '_>, request: Request) -> Result<Answer<'static>, Fault> {
    match request {
        Request::Set { values } => run.give(&values).map(|()| Answer::DONE),
        Request::Step { set, end, observe } => run.step(&set, end, observe).map(Answer::stepped),
        Request::Save {} => run.save().map(|state| Answer::Saved { state }),
        Request::Restore { state } => run.restore(state).map(|()| Answer::DONE),
        Request::Free { state } => run.free(state).map(|()| Answer::DONE),
        Request::Finish {} | Request::Reset {} => Ok(Answer::DONE),
    }
}
