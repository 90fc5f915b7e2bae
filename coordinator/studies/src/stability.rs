//! `coordinator stability`: the hard cases, each with what is expected of it and why.
//!
//! A suite file lists cases, the bounds of their quantities with the physical reason of each, and
//! parameters that are driven to the edge where the answer ends. Every run is a run like any other,
//! with a recording, so that the ranges of whole fields are known.
//!
//! ```text
//! suite.toml ──Suite::read──► Suite ──each case and sweep──► CaseRun ──judge──► RunResult ──► Report
//! ```
//!
//! Nothing here knows a model or an effect by name: one that comes later joins by an entry in the
//! file.

mod case_run;
mod figure;
mod judge;
mod limits;
mod page;
mod report;
mod rows;
mod show;
mod suite;

pub(crate) use report::{CaseReport, Report, RunResult, SweepReport};
pub(crate) use suite::Suite;

use crate::study::arguments::StudyArguments;
use crate::study::output::{Kept, Shown};
use crate::study::{Variant, expected_run_seconds, planned};
use case_run::CaseRun;
use clap::Args;
use console::command::{Command, Context, Group};
use console::output::{Speaker, print};
use console::steps::Steps;
use contract::text::json;
use judge::judge;
use run::error::{Failure, RunError};
use run::results::write::replace;
use std::path::{Path, PathBuf};
use std::time::Instant;
use suite::{Entry, Expected, Sweep};

/// Options of `coordinator stability`.
#[derive(Debug, Args)]
pub struct StabilityCommand {
    /// The suite.
    #[arg(default_value = "cases/hard/suite.toml")]
    suite: PathBuf,
    /// Run this case alone; may be given several times.
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Run the cases alone, without driving parameters to their edges.
    #[arg(long)]
    no_sweep: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    folder: StudyArguments,
    /// Write the edges that were found, as Markdown.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["only", "no_sweep"])]
    write_limits: Option<PathBuf>,
}

impl Command for StabilityCommand {
    const NAME: &'static str = "stability";
    const GROUP: Group = Group::Study;
    const ABOUT: &'static str =
        "Run the hard cases, drive their parameters to the edge, and print what held";

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let _participants = self.folder.keep();
        let suite = Suite::read(&self.suite)?;
        // A case that the suite does not have is reported before anything is printed.
        suite.chosen(&self.only)?;
        let folder =
            self.folder.choose(Report::COMMAND, Report::COMMAND, &Report::is_unfinished)?;
        let request =
            Request { suite, only: self.only.clone(), sweeps: !self.no_sweep, out: folder.open()? };
        let mut speaker = Speaker::new(context.quiet || self.json);
        // What is interrupted can be begun again in the same folder.
        Report { schema: Report::SCHEMA, ..Report::default() }.write(&folder)?;
        speaker.say(&show::head());
        let report = stability(&request, &mut speaker)?;
        report.publish(&folder)?;
        if self.json {
            print(&json(&report))?;
        }
        speaker.say(&show::tail(&report, folder.path()));
        let written = verdict(&report).and_then(|()| match &self.write_limits {
            Some(path) => replace(path, limits::text(&report).as_bytes()),
            None => Ok(()),
        });
        speaker.end(written)
    }
}

fn verdict(report: &Report) -> Result<(), RunError> {
    let other = report.cases.iter().filter(|case| !case.as_expected());
    let names: Vec<&str> = other.map(|case| case.name.as_str()).collect();
    if names.is_empty() {
        return Ok(());
    }
    Err(RunError::Failed(Failure {
        who: report.suite.clone(),
        when: format!("in {} of {} cases", names.len(), report.cases.len()),
        what: format!("{} did not meet expectations", names.join(", ")),
        fix: "`coordinator stability --only NAME` runs one alone".to_owned(),
    }))
}

/// What is to be run.
#[derive(Clone, Debug)]
pub(crate) struct Request {
    /// The suite.
    pub suite: Suite,
    /// Names of the cases to run; all if empty.
    pub only: Vec<String>,
    /// Parameters are driven to their edges.
    pub sweeps: bool,
    /// Where the runs write.
    pub out: PathBuf,
}

/// Runs the cases, and says how each went as soon as it and its sweeps are done.
///
/// # Errors
/// A case that the suite does not have, a folder that cannot be written, or the user has stopped. A
/// case that goes otherwise than expected is no error here.
pub(crate) fn stability(request: &Request, speaker: &mut Speaker) -> Result<Report, RunError> {
    let begun = Instant::now();
    let mut report =
        Report { schema: Report::SCHEMA, suite: request.suite.name(), ..Report::default() };
    let chosen = request.suite.chosen(&request.only)?;
    let quiet = speaker.is_quiet();
    let expected = |entry: &&Entry| if quiet { 1.0 } else { expected_seconds(request, entry) };
    let mut steps = Steps::of_work(quiet, chosen.iter().map(expected).collect());
    for entry in chosen {
        steps.step(&entry.name);
        let case = run_entry(request, entry)?;
        steps.aside(|| speaker.say(&show::case(&case)));
        report.cases.push(case);
    }
    steps.finish();
    report.wall_s = begun.elapsed().as_secs_f64();
    report.complete = true;
    Ok(report)
}

/// What a case and its sweeps are expected to take \[s\]. The runs of a quick case's sweeps count like the case itself; it would
/// take longer to plan them.
fn expected_seconds(request: &Request, entry: &Entry) -> f64 {
    const QUICK: f64 = 0.5;
    let of = |variant: &Variant| expected_run_seconds(planned(&entry.case, variant).ok().as_ref());
    let base = entry.variant();
    let own = of(&base);
    let sweeps = if request.sweeps { entry.sweeps.as_slice() } else { &[] };
    let values = sweeps.iter().flat_map(|sweep| sweep.values.iter().map(move |one| (sweep, one)));
    let swept = values.map(|(sweep, value)| match own < QUICK {
        true => own,
        false => of(&sweep.at(&base, value)),
    });
    own + swept.sum::<f64>()
}

fn run_entry(request: &Request, entry: &Entry) -> Result<CaseReport, RunError> {
    let row = run_one(request, entry, &entry.variant(), &entry.name, &entry.expect)?;
    let sweeps = match request.sweeps {
        true => entry.sweeps.iter().map(|sweep| run_sweep(request, entry, sweep)).collect(),
        false => Ok(Vec::new()),
    };
    Ok(CaseReport {
        number: entry.number,
        name: entry.name.clone(),
        title: entry.title.clone(),
        bounds: entry.checks.iter().map(suite::Check::row).collect(),
        expected: entry.expect.to_string(),
        row,
        sweeps: sweeps?,
    })
}

fn run_sweep(request: &Request, entry: &Entry, sweep: &Sweep) -> Result<SweepReport, RunError> {
    let mut rows = Vec::new();
    for value in &sweep.values {
        let name = format!("{}-{}-{value}", entry.name, sweep.parameter).replace(['/', ' '], "-");
        let variant = sweep.at(&entry.variant(), value);
        let row = run_one(request, entry, &variant, &name, sweep.expected(value, &entry.expect))?;
        rows.push((value.clone(), row));
    }
    Ok(SweepReport {
        parameter: sweep.parameter.clone(),
        before: sweep.before.clone(),
        beyond: sweep.edge.as_ref().map(|edge| edge.beyond.to_string()),
        why: sweep.why.clone(),
        rows,
    })
}

fn run_one(
    request: &Request,
    entry: &Entry,
    variant: &Variant,
    name: &str,
    expected: &Expected,
) -> Result<RunResult, RunError> {
    let run = CaseRun::run(&entry.case, variant, &folder(&request.out, name))?;
    Ok(judge(&run, expected, &entry.limits(&request.suite.every), &entry.checks))
}

fn folder(out: &Path, name: &str) -> PathBuf {
    out.join("runs").join(name)
}
