//! Performs every distinct run of a study once, and records the results in `reproduce.json`.

use super::study::{Run, Study};
use crate::study;
use crate::study::bench::Bench;
use crate::study::folder::StudyFolder;
use crate::study::output::StudyFile;
use console::case_arguments::Changes;
use console::output::Speaker;
use console::steps::Steps;
use pages::source::Columns;
use run::error::{RunError, file_failure};
use run::results::summary::Summary;
use run::results::{Existing, ResultFolder, history};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Plans all runs of a study and returns each with its expected time \[s\].
///
/// # Errors
/// [`RunError::Usage`] if a case is invalid.
pub(super) fn rehearse(
    study: &Study,
    file: &Path,
    bench: &mut Bench,
) -> Result<Vec<(Run, f64)>, RunError> {
    let rehearsed = |run: Run| match bench.planned(&run.case, &run.variant) {
        Ok(planned) => Ok((run, study::expected_run_seconds(Some(&planned)))),
        Err(error) => Err(of_run(&run, file, error)),
    };
    study.runs(file.parent().unwrap_or(Path::new(""))).into_iter().map(rehearsed).collect()
}

/// Performs all runs into a folder and returns the record.
///
/// # Errors
/// A run fails, or the folder cannot be written.
pub(super) fn run_all(
    study: &Study,
    file: &Path,
    runs: &[(Run, f64)],
    folder: &StudyFolder,
    bench: &mut Bench,
    speaker: &mut Speaker,
) -> Result<Record, RunError> {
    let out = folder.open()?;
    keep_study(study, file, folder)?;
    let mut record = Record::begun(study);
    record.write(folder)?;
    let mut known: BTreeMap<(PathBuf, Vec<String>), Done> = BTreeMap::new();
    let key = |run: &Run| (run.case.clone(), run.variant.options());
    let mut met = BTreeSet::new();
    let work = runs.iter().map(|(run, seconds)| if met.insert(key(run)) { *seconds } else { 0.0 });
    let mut steps = Steps::of_work(speaker.is_quiet(), work.collect());
    for (n, (run, _)) in runs.iter().enumerate() {
        steps.step(&run.name);
        let since = Instant::now();
        let key = key(run);
        let done = match known.get(&key) {
            Some(same) => Done { name: run.name.clone(), ..same.clone() },
            None => one(run, &out, bench).map_err(|error| of_run(run, file, error))?,
        };
        let seconds = since.elapsed().as_secs_f64();
        let total = runs.len();
        let line = format!("run {:>3} of {total}  {:24} {seconds:6.2} s\n", n + 1, run.name);
        steps.aside(|| speaker.say(&line));
        known.entry(key).or_insert_with(|| done.clone());
        record.runs.push(done);
    }
    steps.finish();
    record.complete = true;
    record.write(folder)?;
    Ok(record)
}

fn one(run: &Run, out: &Path, bench: &mut Bench) -> Result<Done, RunError> {
    let folder = Path::new("runs").join(&run.name);
    let into = ResultFolder::prepare(&out.join(&folder), &run.case, Existing::Replace)?;
    let summary = bench.run(&run.case, &run.variant, &into)?;
    let Changes { set, unset } = run.variant.clone();
    Ok(Done { name: run.name.clone(), set, unset, folder, summary })
}

/// Adds the name of the run to an error in a case; other failures keep their messages.
fn of_run(run: &Run, file: &Path, error: RunError) -> RunError {
    let place = format!("{}: run `{}`", file.display(), run.name);
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
