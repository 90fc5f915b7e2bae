//! The subcommand.

use super::{CheckOutcome, News, Report, Request, conform, show};
use crate::output::{Speaker, print};
use crate::study::progress::Steps;
use clap::Args;
use contract::text::json;
use run::error::{Failure, RunError};
use run::programs::Program;
use std::path::PathBuf;
use std::time::Duration;

/// What `coordinator conform` is asked.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The role that it plays.
    #[arg(long, value_name = "ROLE")]
    role: String,
    /// The case that it is configured with, for every model and mode it offers [default: the scene wheel-rail].
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

/// Puts the participant through the contract and prints how it went.
///
/// # Errors
/// What is asked for cannot be, or a check failed.
pub(crate) fn main(asked: &Arguments, quiet: bool) -> Result<(), RunError> {
    if !(asked.deadline > 0.0 && asked.deadline <= 1e6) {
        return Err(RunError::Usage("--deadline must be a number of seconds above 0".to_owned()));
    }
    let command = (!asked.command.is_empty()).then_some(asked.command.as_slice());
    let request = Request {
        role: asked.role.clone(),
        program: Program::of_role(&asked.role, command),
        case: asked.case.clone(),
        set: asked.set.clone(),
        unset: asked.unset.clone(),
        recording: asked.recording.clone(),
        only: asked.only.clone(),
        quick: asked.quick,
        patience: Duration::from_secs_f64(asked.deadline),
    };
    let silent = quiet || asked.json;
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
    if asked.json {
        print(&json(&report))?;
    }
    speaker.end(verdict(&request, &report))
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
