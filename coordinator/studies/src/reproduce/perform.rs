//! Performs every distinct run of a study once, and records the results in `reproduce.json`.

use super::study::{Run, Study};
use crate::study;
use crate::study::arguments::StudyArguments;
use crate::study::bench::Bench;
use crate::study::finished::FinishedRuns;
use crate::study::folder::StudyFolder;
use crate::study::output::StudyFile;
use crate::study::runner::{self, Attempt, Maker, Point, Runner};
use console::case_arguments::Changes;
use console::output::Speaker;
use pages::source::Columns;
use run::error::{RunError, file_failure};
use run::identity::Identity;
use run::results::summary::Summary;
use run::results::{Existing, ResultFolder, history};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;
use std::{fs, mem};

/// Request for one reproduction.
#[derive(Debug)]
pub(crate) struct Request<'a> {
    /// File of the study.
    pub study: &'a Path,
    /// Folder for the runs, the text and the plots.
    pub folder: &'a StudyArguments,
    /// Number of runs at a time.
    pub jobs: usize,
    /// Additional file for the text; its plots go into `img/NAME` beside it.
    pub write: Option<&'a Path>,
    /// Earlier text, with its plots, to compare with the new one.
    pub check: Option<&'a Path>,
}

/// A run of a study, planned.
pub(super) struct Rehearsed {
    run: Run,
    /// Expected time \[s\].
    seconds: f64,
    identity: Identity,
}

/// Plans all runs of a study.
///
/// # Errors
/// [`RunError::Usage`] if a case is invalid.
pub(super) fn rehearse(
    study: &Study,
    file: &Path,
    bench: &mut Bench,
) -> Result<Vec<Rehearsed>, RunError> {
    let rehearsed = |run: Run| match bench.planned(&run.case, &run.variant) {
        Ok(planned) => {
            let seconds = study::expected_run_seconds(Some(&planned));
            Ok(Rehearsed { run, seconds, identity: Identity::of(&planned)? })
        }
        Err(error) => Err(of_run(&run.name, file, error)),
    };
    study.runs(file.parent().unwrap_or(Path::new(""))).into_iter().map(rehearsed).collect()
}

/// The distinct runs of a study, each in a folder of its own.
struct Reproduction<'a> {
    runs: Vec<&'a Rehearsed>,
    out: &'a Path,
}

impl Maker for Reproduction<'_> {
    type Made = Done;

    fn key(&self, point: &Point) -> Vec<String> {
        vec![point.name.clone()]
    }

    fn work(&self, points: &[(usize, &Point)], _: &mut Bench) -> Result<Vec<f64>, RunError> {
        Ok(points.iter().map(|(n, _)| self.runs[*n].seconds).collect())
    }

    fn make(&self, (n, _): (usize, &Point), bench: &mut Bench, _: &Path) -> Attempt<Done> {
        let since = Instant::now();
        let run = &self.runs[n].run;
        let outcome = match one(run, self.out, bench) {
            Ok(done) => runner::Outcome::Finished(Box::new(done)),
            Err(error) => runner::Outcome::Failed(error),
        };
        Attempt { outcome, wall_s: since.elapsed().as_secs_f64() }
    }
}

/// Performs all runs into a folder and returns the record. Equal runs are performed once.
///
/// # Errors
/// A run fails, or the folder cannot be written.
pub(super) fn run_all(
    request: &Request<'_>,
    study: &Study,
    runs: &[Rehearsed],
    folder: &StudyFolder,
    bench: Bench,
    speaker: &mut Speaker,
) -> Result<Record, RunError> {
    let (file, out) = (request.study, folder.open()?);
    keep_study(study, file, folder)?;
    let mut record = Record::begun(study);
    record.write(folder)?;
    let (distinct, places) = distinct(runs);
    let point =
        |of: &&Rehearsed| Point { name: of.run.name.clone(), changes: of.run.variant.clone() };
    let points: Vec<Point> = distinct.iter().map(point).collect();
    let identities: Vec<&Identity> = distinct.iter().map(|of| &of.identity).collect();
    let none = FinishedRuns::none_of_cases(&json!(identities));
    let mut done = vec![None; distinct.len()];
    let maker = Reproduction { runs: distinct, out: &out };
    let mut runner = Runner::new(maker, request.folder, bench, speaker.is_quiet())?
        .keep_finished(none, folder)?;
    runner.jobs = request.jobs;
    runner.run(&points, |n, attempt| {
        let seconds = attempt.wall_s;
        let made = attempt.made();
        done[n] = Some((made.map_err(|error| of_run(&points[n].name, file, error))?, seconds));
        while let Some(Rehearsed { run, .. }) = runs.get(record.runs.len())
            && let Some((made, seconds)) = &mut done[places[record.runs.len()]]
        {
            record.runs.push(Done { name: run.name.clone(), ..made.clone() });
            let (number, total, seconds) = (record.runs.len(), runs.len(), mem::take(seconds));
            speaker.say(&format!("run {number:>3} of {total}  {:24} {seconds:6.2} s\n", run.name));
        }
        Ok(())
    })?;
    record.complete = true;
    record.write(folder)?;
    runner.complete()?;
    Ok(record)
}

/// Returns the distinct runs, and the place of each run among them.
fn distinct(runs: &[Rehearsed]) -> (Vec<&Rehearsed>, Vec<usize>) {
    let (mut distinct, mut known, mut places) = (Vec::new(), BTreeMap::new(), Vec::new());
    for rehearsed in runs {
        let key = (&rehearsed.run.case, rehearsed.run.variant.options());
        places.push(*known.entry(key).or_insert_with(|| {
            distinct.push(rehearsed);
            distinct.len() - 1
        }));
    }
    (distinct, places)
}

fn one(run: &Run, out: &Path, bench: &mut Bench) -> Result<Done, RunError> {
    let folder = Path::new("runs").join(&run.name);
    let into = ResultFolder::prepare(&out.join(&folder), &run.case, Existing::Replace)?;
    let summary = bench.run(&run.case, &run.variant, &into)?;
    let Changes { set, unset } = run.variant.clone();
    Ok(Done { name: run.name.clone(), set, unset, folder, summary })
}

/// Adds the name of the run to an error in a case; other failures keep their messages.
fn of_run(run: &str, file: &Path, error: RunError) -> RunError {
    let place = format!("{}: run `{run}`", file.display());
    match error {
        RunError::Case(problems) => RunError::Usage(format!("{place}: {problems}")),
        error => error.and(Err(RunError::Usage(format!("{place} did not finish")))),
    }
}

/// Copies the study, its template and its tables of measured values into the folder.
fn keep_study(study: &Study, file: &Path, folder: &StudyFolder) -> Result<(), RunError> {
    let own = [(file.to_owned(), STUDY.to_owned())];
    let template = [(file.with_file_name(&study.text), TEMPLATE.to_owned())];
    let tables = study.measurements.iter();
    let tables = tables.map(|of| (file.with_file_name(&of.table), of.kept_table()));
    for (from, name) in own.into_iter().chain(template).chain(tables) {
        let content = fs::read(&from).map_err(|error| file_failure(&from, &error))?;
        folder.write(&name, &content)?;
    }
    Ok(())
}

/// Copy of the study in the folder.
pub(super) const STUDY: &str = "study.toml";
/// Copy of the template in the folder.
pub(super) const TEMPLATE: &str = "text.md.j2";

/// Record of all runs of a study.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Record {
    schema: u32,
    study: String,
    /// Whether all runs are done.
    pub(super) complete: bool,
    pub(super) runs: Vec<Done>,
}

/// One finished run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Done {
    pub(super) name: String,
    pub(super) set: Vec<String>,
    pub(super) unset: Vec<String>,
    /// Result folder, relative to the record.
    pub(super) folder: PathBuf,
    pub(super) summary: Summary,
}

/// Results of a run.
#[derive(Clone, Debug, Default)]
pub(super) struct Outcome {
    /// Contents of `summary.json`.
    pub(super) summary: Summary,
    /// The case as run.
    pub(super) case: toml::Table,
    /// Contents of `history.csv`; empty if missing.
    pub(super) history: Columns,
}

impl StudyFile for Record {
    const COMMAND: &'static str = "reproduce";
    const FILE: &'static str = "reproduce.json";
    const SCHEMA: u32 = 1;
}

impl Record {
    /// Returns the empty record of a study that begins.
    pub(super) fn begun(study: &Study) -> Self {
        let study = study.name.clone();
        Self { schema: Self::SCHEMA, study, complete: false, runs: Vec::new() }
    }

    /// Result folder of each run below `out`, by name.
    pub(super) fn folders(&self, out: &Path) -> BTreeMap<String, PathBuf> {
        self.runs.iter().map(|done| (done.name.clone(), out.join(&done.folder))).collect()
    }

    /// Results of each run below `out`, by name.
    pub(super) fn outcomes(&self, out: &Path) -> BTreeMap<String, Outcome> {
        let outcome = |done: &Done| {
            let text = |name: &str| {
                fs::read_to_string(out.join(&done.folder).join(name)).unwrap_or_default()
            };
            let case = toml::from_str(&text("case.toml")).unwrap_or_default();
            let history = Columns::parse(&text(history::FILE));
            (done.name.clone(), Outcome { summary: done.summary.clone(), case, history })
        };
        self.runs.iter().map(outcome).collect()
    }
}
