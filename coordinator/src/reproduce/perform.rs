//! Every distinct run of a study, once, and what became of it.

use super::study::{Run, Study};
use super::values::Outcome;
use crate::study::{self, Variant};
use run::error::{RunError, file_failure};
use run::results::write::replace;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What a reproduction is known by: the summaries of all its runs.
pub const FILE: &str = "reproduce.json";
/// The study, as it was run.
pub(super) const STUDY: &str = "study.toml";
/// Its template.
pub(super) const TEMPLATE: &str = "text.md.j2";
/// Number of the layout of [`FILE`].
const SCHEMA: u32 = 1;

/// Content of [`FILE`].
#[derive(Debug, Serialize, Deserialize)]
struct Record {
    schema: u32,
    study: String,
    /// All runs are done.
    complete: bool,
    runs: Vec<Done>,
}

/// One run.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Done {
    name: String,
    set: Vec<String>,
    unset: Vec<String>,
    /// Its result directory, as seen from the record.
    folder: PathBuf,
    summary: Value,
}

/// The runs of a study, each of which can be planned.
///
/// # Errors
/// [`RunError::Usage`] if a case is wrong.
pub(super) fn rehearse(study: &Study, file: &Path) -> Result<Vec<Run>, RunError> {
    let runs = study.runs(file.parent().unwrap_or(Path::new("")));
    for run in &runs {
        study::planned(&run.case, &run.variant).map_err(|error| of_run(run, file, error))?;
    }
    Ok(runs)
}

/// Runs everything into `out`.
///
/// # Errors
/// The file system; those of the runs.
pub(super) fn perform(
    study: &Study,
    file: &Path,
    runs: &[Run],
    out: &Path,
    say: &mut dyn FnMut(&str),
) -> Result<(), RunError> {
    keep_study(study, file, out)?;
    let mut record =
        Record { schema: SCHEMA, study: study.name.clone(), complete: false, runs: Vec::new() };
    write(out, &record)?;
    let mut known: BTreeMap<(PathBuf, Vec<String>), Done> = BTreeMap::new();
    for (n, run) in runs.iter().enumerate() {
        let since = Instant::now();
        let key = (run.case.clone(), run.variant.options());
        let done = match known.get(&key) {
            Some(same) => Done { name: run.name.clone(), ..same.clone() },
            None => one(run, out).map_err(|error| of_run(run, file, error))?,
        };
        let seconds = since.elapsed().as_secs_f64();
        let total = runs.len();
        say(&format!("run {:>3} of {total}  {:24} {seconds:6.2} s\n", n + 1, run.name));
        known.entry(key).or_insert_with(|| done.clone());
        record.runs.push(done);
    }
    record.complete = true;
    write(out, &record)
}

fn one(run: &Run, out: &Path) -> Result<Done, RunError> {
    let folder = Path::new("runs").join(&run.name);
    let summary = study::run(&run.case, &run.variant, &out.join(&folder))?;
    let Variant { set, unset } = run.variant.clone();
    Ok(Done { name: run.name.clone(), set, unset, folder, summary })
}

/// What is wrong with a case is reported with the run that it is of; a failure keeps its own words.
fn of_run(run: &Run, file: &Path, error: RunError) -> RunError {
    let place = format!("{}: run `{}`", file.display(), run.name);
    match error {
        RunError::Case(problems) => RunError::Usage(format!("{place}: {problems}")),
        error => error.and(Err(RunError::Usage(format!("{place} has not finished")))),
    }
}

/// The study itself goes into the folder.
fn keep_study(study: &Study, file: &Path, out: &Path) -> Result<(), RunError> {
    let template = file.with_file_name(&study.text);
    for (from, name) in [(file, STUDY), (&template, TEMPLATE)] {
        let content = fs::read(from).map_err(|error| file_failure(from, &error))?;
        replace(&out.join(name), &content)?;
    }
    Ok(())
}

fn write(out: &Path, record: &Record) -> Result<(), RunError> {
    let json = serde_json::to_string_pretty(record).expect("a record is plain data");
    super::write(&out.join(FILE), &(json + "\n"))
}

/// What the runs of a folder found, and the result directory of each.
pub(super) struct Found {
    /// By the names of the runs.
    pub(super) outcomes: BTreeMap<String, Outcome>,
    /// By the names of the runs.
    pub(super) folders: BTreeMap<String, PathBuf>,
}

/// Reads what has been run into a folder.
///
/// # Errors
/// [`RunError::Usage`] if it holds no reproduction that has come to its end.
pub(super) fn found(out: &Path) -> Result<Found, RunError> {
    let path = out.join(FILE);
    let text = fs::read_to_string(&path).map_err(|error| file_failure(&path, &error))?;
    let refuse = |why: String| RunError::Usage(format!("{}: {why}", path.display()));
    let record: Record = serde_json::from_str(&text).map_err(|error| refuse(error.to_string()))?;
    if record.schema != SCHEMA || !record.complete {
        let why = "the reproduction has not finished; run it again";
        return Err(refuse(why.to_owned()));
    }
    let mut found = Found { outcomes: BTreeMap::new(), folders: BTreeMap::new() };
    for done in record.runs {
        let folder = out.join(done.folder);
        let case = fs::read_to_string(folder.join("case.toml")).unwrap_or_default();
        let case = toml::from_str(&case).unwrap_or_default();
        found.outcomes.insert(done.name.clone(), Outcome { summary: done.summary, case });
        found.folders.insert(done.name, folder);
    }
    Ok(found)
}
