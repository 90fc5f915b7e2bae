//! `coordinator stability`: runs the hard cases and checks each against its expected outcome.
//!
//! A suite file lists cases, bounds of their quantities with physical reasons, and parameters to
//! vary up to the edge where results end. Every run is an ordinary run, with a recording for the
//! ranges of whole fields.
//!
//! ```text
//! suite.toml ──Suite::read──► Suite ──Runner──► CaseRun ──judge──► RunResult ──► Report
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

use crate::study::arguments::{JobsArguments, StudyArguments};
use crate::study::bench::Bench;
use crate::study::finished::FinishedRuns;
use crate::study::folder::StudyFolder;
use crate::study::output::{StudyFile, StudyPage};
use crate::study::runner::{Attempt, Maker, Outcome, Point, Runner};
use crate::study::{ends_study, expected_run_seconds};
use case_run::CaseRun;
use clap::Args;
use console::case_arguments::Changes;
use console::command::{Command, Context, Group};
use console::output::{Speaker, print};
use contract::text;
use judge::judge;
use run::error::{Failure, RunError};
use run::identity::Identity;
use run::results::write::replace;
use run::sealed::sum_of_file;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Instant;
use suite::{Entry, Expected, Limits, Sweep};

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
    jobs: JobsArguments,
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
        let suite = Suite::read(&self.suite)?;
        // Report an unknown case before anything is printed.
        suite.chosen(&self.only)?;
        let folder =
            self.folder.choose(Report::COMMAND, Report::COMMAND, &Report::is_unfinished)?;
        let mut speaker = Speaker::new(context.quiet || self.json);
        // Mark the study as unfinished, so that an interrupted one can be resumed in the same
        // folder.
        Report { schema: Report::SCHEMA, ..Report::default() }.write(&folder)?;
        speaker.say(&rows::head());
        let report = self.perform(&suite, &folder, &mut speaker)?;
        if self.json {
            print(&text::json(&report))?;
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

/// A run of a suite: a case as it is, or with a value of a sweep.
struct SuiteRun<'a> {
    entry: &'a Entry,
    /// Name of the run and of its folder.
    name: String,
    changes: Changes,
    expected: &'a Expected,
    /// Expected time of the case as it is \[s\].
    own_seconds: f64,
}

impl<'a> SuiteRun<'a> {
    /// Returns the runs of a case, followed by those of its sweeps.
    fn all(entry: &'a Entry, sweeps: &'a [Sweep], own_seconds: f64) -> Vec<Self> {
        let (base, name, expected) = (entry.variant(), entry.name.clone(), &entry.expect);
        let own = Self { entry, name, changes: base.clone(), expected, own_seconds };
        let values = sweeps.iter().flat_map(|sweep| sweep.values.iter().map(move |at| (sweep, at)));
        let swept = values.map(|(sweep, value)| {
            let name = format!("{}-{}-{value}", entry.name, sweep.parameter);
            let (changes, expected) = (sweep.at(&base, value), sweep.expected(value, expected));
            Self { entry, name: name.replace(['/', ' '], "-"), changes, expected, own_seconds }
        });
        std::iter::once(own).chain(swept).collect()
    }
}

/// Performs the runs of a suite, each in a folder of its own.
struct SuiteRuns<'a> {
    runs: Vec<SuiteRun<'a>>,
    every: &'a Limits,
    out: PathBuf,
}

impl Maker for SuiteRuns<'_> {
    type Made = RunResult;

    fn key(&self, point: &Point) -> Vec<String> {
        vec![point.name.clone()]
    }

    /// Expected times \[s\]. In the sweeps of a quick case, every run counts like the case itself,
    /// because planning them would take longer.
    fn work(&self, points: &[(usize, &Point)], bench: &mut Bench) -> Result<Vec<f64>, RunError> {
        const QUICK: f64 = 0.5;
        let mut expected = |(n, point): &(usize, &Point)| {
            let SuiteRun { entry, own_seconds, .. } = &self.runs[*n];
            match *own_seconds < QUICK || point.name == entry.name {
                true => *own_seconds,
                false => {
                    expected_run_seconds(bench.planned(&entry.case, &point.changes).ok().as_ref())
                }
            }
        };
        Ok(points.iter().map(&mut expected).collect())
    }

    fn make(&self, (n, point): (usize, &Point), bench: &mut Bench, _: &Path) -> Attempt<RunResult> {
        let SuiteRun { entry, changes, expected, .. } = &self.runs[n];
        let folder = self.out.join("runs").join(&point.name);
        match CaseRun::run(&entry.case, changes, &folder, bench) {
            Ok(run) => {
                let result = judge(&run, expected, &entry.limits(self.every), &entry.checks);
                Attempt { outcome: Outcome::Finished(Box::new(result)), wall_s: run.seconds }
            }
            Err(error) => Attempt { outcome: Outcome::Failed(error), wall_s: 0.0 },
        }
    }
}

impl StabilityCommand {
    /// Runs the cases and reports each as soon as the case and its sweeps are done, in the order of
    /// the suite.
    ///
    /// # Errors
    /// The suite lacks a requested case, a folder cannot be written, or the user interrupts. An
    /// unexpected outcome of a case is part of the report and not an error.
    fn perform(
        &self,
        suite: &Suite,
        folder: &StudyFolder,
        speaker: &mut Speaker,
    ) -> Result<Report, RunError> {
        let begun = Instant::now();
        let mut bench = self.folder.bench();
        let mut report =
            Report { schema: Report::SCHEMA, suite: suite.name(), ..Report::default() };
        let (mut cases, mut runs) = (Vec::new(), Vec::new());
        let mut asked = vec![json!(suite.text)];
        for entry in suite.chosen(&self.only)? {
            let planned = match bench.planned(&entry.case, &entry.variant()) {
                Err(error) if ends_study(&error) => return Err(error),
                planned => planned.ok(),
            };
            let identity = planned.as_ref().map(Identity::of).transpose()?;
            asked.push(json!((identity, sum_of_file(&entry.case).ok())));
            let sweeps = if self.no_sweep { &[][..] } else { &entry.sweeps };
            let seconds = expected_run_seconds(planned.as_ref());
            runs.extend(SuiteRun::all(entry, sweeps, seconds));
            cases.push((entry, sweeps, runs.len()));
        }
        let point =
            |run: &SuiteRun<'_>| Point { name: run.name.clone(), changes: run.changes.clone() };
        let points: Vec<Point> = runs.iter().map(point).collect();
        let mut results: Vec<Option<RunResult>> = vec![None; runs.len()];
        let maker = SuiteRuns { runs, every: &suite.every, out: folder.open()? };
        let mut runner = Runner::new(maker, &self.folder, bench, speaker.is_quiet())?
            .keep_finished(FinishedRuns::none_of_cases(&json!(asked)), folder)?;
        runner.jobs = self.jobs.jobs.into();
        let mut next = 0;
        runner.run(&points, |n, attempt| {
            results[n] = Some(attempt.made()?);
            while let Some((entry, sweeps, end)) = cases.get(report.cases.len())
                && let Some(rows) = results[next..*end].iter().cloned().collect::<Option<Vec<_>>>()
            {
                let case = case_report(entry, sweeps, rows);
                speaker.say(&rows::case(&case));
                report.cases.push(case);
                next = *end;
            }
            Ok(())
        })?;
        report.wall_s = begun.elapsed().as_secs_f64();
        report.complete = true;
        report.publish(folder)?;
        runner.complete()?;
        Ok(report)
    }
}

/// Returns the report of a case from the results of its runs.
fn case_report(entry: &Entry, sweeps: &[Sweep], rows: Vec<RunResult>) -> CaseReport {
    let mut rows = rows.into_iter();
    let row = rows.next().expect("a case has a run");
    let report = |sweep: &Sweep| SweepReport {
        parameter: sweep.parameter.clone(),
        before: sweep.before.clone(),
        beyond: sweep.edge.as_ref().map(|edge| edge.beyond.to_string()),
        why: sweep.why.clone(),
        rows: sweep.values.iter().cloned().zip(rows.by_ref()).collect(),
    };
    let sweeps = sweeps.iter().map(report).collect();
    CaseReport {
        number: entry.number,
        name: entry.name.clone(),
        title: entry.title.clone(),
        bounds: entry.checks.iter().map(suite::Check::row).collect(),
        expected: entry.expect.to_string(),
        row,
        sweeps,
    }
}
