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
mod cli;
mod figure;
mod judge;
mod limits;
mod page;
mod report;
mod rows;
mod show;
mod suite;

pub(crate) use cli::{Arguments, main};
pub(crate) use report::{CaseReport, Report, RunResult, SweepReport};
pub(crate) use suite::Suite;

use crate::output::Speaker;
use crate::study::output::Kept;
use crate::study::progress::Steps;
use crate::study::{Variant, expected_run_seconds, planned};
use case_run::CaseRun;
use judge::judge;
use run::error::RunError;
use std::path::{Path, PathBuf};
use std::time::Instant;
use suite::{Entry, Expected, Sweep};

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
