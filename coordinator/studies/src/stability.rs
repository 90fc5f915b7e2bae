//! `coordinator stability`: runs the hard cases and checks each against its expected outcome.
//!
//! A suite file lists cases, bounds of their quantities with physical reasons, and parameters to
//! vary up to the edge where results end. Every run is an ordinary run, with a recording for the
//! ranges of whole fields.
//!
//! ```text
//! suite.toml ──Suite::read──► Suite ──each case and sweep──► CaseRun ──judge──► RunResult ──► Report
//! ```
//!
//! The code does not depend on particular models or effects: a new case is one more entry in the
//! file.

mod case_run;
mod judge;
mod page;
mod report;
mod rows;
mod suite;

pub(crate) use report::{CaseReport, Report, RunResult, SweepReport};
pub(crate) use suite::Suite;

use crate::study::arguments::StudyArguments;
use crate::study::bench::Bench;
use crate::study::expected_run_seconds;
use crate::study::output::{StudyFile, StudyPage};
use case_run::CaseRun;
use clap::Args;
use console::case_arguments::Changes;
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
    /// Suite file.
    #[arg(default_value = "cases/hard/suite.toml")]
    suite: PathBuf,
    /// Run only this case; may be repeated.
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Run only the cases, without varying parameters up to their edges.
    #[arg(long)]
    no_sweep: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    folder: StudyArguments,
    /// Write the edges to this file, as Markdown.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["only", "no_sweep"])]
    write_limits: Option<PathBuf>,
}

impl Command for StabilityCommand {
    const NAME: &'static str = "stability";
    const GROUP: Group = Group::Study;
    const ABOUT: &'static str = "Run the hard cases to the edges of their parameters";
    const EXAMPLES: &'static [&'static str] =
        &["coordinator stability", "coordinator stability --only tiny-load --no-sweep"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let mut bench = self.folder.bench();
        let suite = Suite::read(&self.suite)?;
        // Report an unknown case before anything is printed.
        suite.chosen(&self.only)?;
        let folder =
            self.folder.choose(Report::COMMAND, Report::COMMAND, &Report::is_unfinished)?;
        let request =
            Request { suite, only: self.only.clone(), sweeps: !self.no_sweep, out: folder.open()? };
        let mut speaker = Speaker::new(context.quiet || self.json);
        // Mark the study as unfinished, so that an interrupted one can be restarted in the same
        // folder.
        Report { schema: Report::SCHEMA, ..Report::default() }.write(&folder)?;
        speaker.say(&rows::head());
        let report = stability(&request, &mut bench, &mut speaker)?;
        report.publish(&folder)?;
        if self.json {
            print(&json(&report))?;
        }
        speaker.say(&rows::tail(&report, folder.path()));
        let written = verdict(&report).and_then(|()| match &self.write_limits {
            Some(path) => replace(path, page::text(&report).as_bytes()),
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
        fix: "run a single case with `coordinator stability --only NAME`".to_owned(),
    }))
}

/// Request for one run of a suite.
#[derive(Clone, Debug)]
pub(crate) struct Request {
    pub suite: Suite,
    /// Names of the cases to run; all if empty.
    pub only: Vec<String>,
    /// Whether to vary parameters up to their edges.
    pub sweeps: bool,
    /// Folder for the runs.
    pub out: PathBuf,
}

/// Runs the cases and reports each as soon as the case and its sweeps are done.
///
/// # Errors
/// The suite lacks a requested case, a folder cannot be written, or the user interrupts. An
/// unexpected outcome of a case is part of the report and not an error.
pub(crate) fn stability(
    request: &Request,
    bench: &mut Bench,
    speaker: &mut Speaker,
) -> Result<Report, RunError> {
    let begun = Instant::now();
    let mut report =
        Report { schema: Report::SCHEMA, suite: request.suite.name(), ..Report::default() };
    let chosen = request.suite.chosen(&request.only)?;
    let quiet = speaker.is_quiet();
    let expected =
        |entry: &&Entry| if quiet { 1.0 } else { expected_seconds(request, entry, bench) };
    let mut steps = Steps::of_work(quiet, chosen.iter().map(expected).collect());
    for entry in chosen {
        steps.step(&entry.name);
        let case = run_entry(request, entry, bench)?;
        steps.aside(|| speaker.say(&rows::case(&case)));
        report.cases.push(case);
    }
    steps.finish();
    report.wall_s = begun.elapsed().as_secs_f64();
    report.complete = true;
    Ok(report)
}

/// Expected time of a case and its sweeps \[s\]. In the sweeps of a quick case, every run counts
/// like the case itself, because planning them would take longer.
fn expected_seconds(request: &Request, entry: &Entry, bench: &mut Bench) -> f64 {
    const QUICK: f64 = 0.5;
    let mut of =
        |variant: &Changes| expected_run_seconds(bench.planned(&entry.case, variant).ok().as_ref());
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

fn run_entry(request: &Request, entry: &Entry, bench: &mut Bench) -> Result<CaseReport, RunError> {
    let row = run_one(request, entry, &entry.variant(), (&entry.name, &entry.expect), bench)?;
    let sweeps = match request.sweeps {
        true => entry.sweeps.iter().map(|sweep| run_sweep(request, entry, sweep, bench)).collect(),
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

fn run_sweep(
    request: &Request,
    entry: &Entry,
    sweep: &Sweep,
    bench: &mut Bench,
) -> Result<SweepReport, RunError> {
    let mut rows = Vec::new();
    for value in &sweep.values {
        let name = format!("{}-{}-{value}", entry.name, sweep.parameter).replace(['/', ' '], "-");
        let variant = sweep.at(&entry.variant(), value);
        let row = run_one(
            request,
            entry,
            &variant,
            (&name, sweep.expected(value, &entry.expect)),
            bench,
        )?;
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
    variant: &Changes,
    (name, expected): (&str, &Expected),
    bench: &mut Bench,
) -> Result<RunResult, RunError> {
    let run = CaseRun::run(&entry.case, variant, &folder(&request.out, name), bench)?;
    Ok(judge(&run, expected, &entry.limits(&request.suite.every), &entry.checks))
}

fn folder(out: &Path, name: &str) -> PathBuf {
    out.join("runs").join(name)
}
