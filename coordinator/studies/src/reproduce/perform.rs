//! Every distinct run of a study, once, and what became of it.

use super::record::{Done, Record, STUDY, TEMPLATE};
use super::study::{Run, Study};
use crate::study::folder::StudyFolder;
use crate::study::output::Kept;
use crate::study::{self, Variant};
use console::output::Speaker;
use console::steps::Steps;
use run::error::{RunError, file_failure};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The runs of a study, each of which can be planned, with the seconds that each is expected to take.
///
/// # Errors
/// [`RunError::Usage`] if a case is wrong.
pub(super) fn rehearse(study: &Study, file: &Path) -> Result<Vec<(Run, f64)>, RunError> {
    let rehearsed = |run: Run| match study::planned(&run.case, &run.variant) {
        Ok(planned) => Ok((run, study::expected_run_seconds(Some(&planned)))),
        Err(error) => Err(of_run(&run, file, error)),
    };
    study.runs(file.parent().unwrap_or(Path::new(""))).into_iter().map(rehearsed).collect()
}

/// Runs everything into a folder; what has become of it.
///
/// # Errors
/// The file system; those of the runs.
pub(super) fn perform(
    study: &Study,
    file: &Path,
    runs: &[(Run, f64)],
    folder: &StudyFolder,
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
            None => one(run, &out).map_err(|error| of_run(run, file, error))?,
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
fn keep_study(study: &Study, file: &Path, folder: &StudyFolder) -> Result<(), RunError> {
    let template = file.with_file_name(&study.text);
    for (from, name) in [(file, STUDY), (&template, TEMPLATE)] {
        let content = fs::read(from).map_err(|error| file_failure(from, &error))?;
        folder.write(name, &content)?;
    }
    Ok(())
}
