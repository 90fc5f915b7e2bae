//! `coordinator sweep`: a case over values of its keys, one row a point.
//!
//! `--vary` → [`design`], the points → [`perform`] here, or [`engine`] on other machines → [`rows`], a file that grows by
//! a line a point: a sweep that was stopped goes on with what it lacks → [`table`], and [`page`], which draws what
//! has changed.

mod collect;
mod design;
mod engine;
mod page;
mod perform;
mod rows;
mod study;
mod table;

pub(crate) use study::Study;

use crate::fit;
use crate::study::arguments::{CaseArguments, StudyArguments};
use crate::study::axis::Axis;
use crate::study::folder::StudyFolder;
use crate::study::output::{Kept, Printing, Shown};
use crate::study::quantity::Quantities;
use crate::study::{Variant, expected_run_seconds, planned, refuse_unread};
use clap::Args;
use collect::earlier;
use console::command::{Command, Context, Group};
use console::output;
use contract::text::json;
use design::{Asked, Part};
use engine::{Name, Tasks};
use perform::{How, fill};
use rows::Growing;
use run::error::{Failure, RunError};
use run::format::counted;
use run::plan::Planned;
use run::scratch::Scratch;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Options of `coordinator sweep`.
#[derive(Debug, Args)]
pub struct SweepCommand {
    #[command(flatten)]
    of: CaseArguments,
    #[command(flatten)]
    points: Asked,
    /// Run one part of the points alone, the third of eight say: for other machines, and jobs of a scheduler.
    #[arg(long, value_name = "I/N", value_parser = Part::read, conflicts_with = "collect")]
    part: Option<Part>,
    /// Take what these folders have found of the same points, parts for instance; what is missing is
    /// named, and run here.
    #[arg(long, value_name = "DIR", num_args = 1..)]
    collect: Vec<PathBuf>,
    /// Points that are run at a time, in each task of a scheduler too [default: as many as there are cores, or
    /// as a task has].
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Fit the figures that were found, with errors, for `ask`: fit.json.
    #[arg(long, conflicts_with = "part")]
    fit: bool,
    #[command(flatten)]
    engine: engine::Asked,
    #[command(flatten)]
    folder: StudyArguments,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl Command for SweepCommand {
    const NAME: &'static str = "sweep";
    const GROUP: Group = Group::Study;
    const ABOUT: &'static str =
        "Run a case over values of its keys: a row a point, plots over what varies";

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let (case, base) = (self.of.case.clone(), self.of.base());
        let design = self.points.design()?;
        let first = |all: Variant, one: &Axis| all.with(&one.key, &one.values[0]);
        let standing = planned(&case, &design.vary.iter().fold(base.clone(), first))?;
        refuse_unread_keys(&case, &base, &design.vary, &standing)?;
        console::logging::log_warnings(&standing.plan.warnings);
        let mut study = Study::new(&standing, case.display().to_string(), &base, design)?;
        study.part = self.part;
        let folder = folder(self, &study)?;
        let mut sweep = begin(self, study, &folder)?;
        let printing = Printing { json: self.json, quiet: context.quiet };
        if !self.collect.is_empty() && !printing.is_silent() {
            tell_missing(&sweep.study);
        }
        let quantities = Quantities::of_figures(&standing.plan.figures);
        match self.engine.engine {
            Name::Local => here(&mut sweep, self, &quantities, printing.is_silent())?,
            Name::List if !sweep.study.missing().is_empty() => {
                return engine::list(&sweep, &tasks(self, &sweep.study, &standing, &folder)?);
            }
            Name::List => {}
            Name::Slurm | Name::Hyperqueue => {
                let tasks = tasks(self, &sweep.study, &standing, &folder)?;
                engine::fill(&mut sweep, &tasks, &self.engine, &folder, printing.is_silent())?;
            }
        }
        let mut study = sweep.study;
        study.settle(&quantities);
        folder.create("sweep.csv", |out| table::csv(&study, out))?;
        #[cfg(feature = "parquet")]
        folder.create("sweep.parquet", |out| table::columnar::write(&study, out))?;
        // Removes the file of an earlier table, which a build with the feature has written.
        #[cfg(not(feature = "parquet"))]
        folder.remove("sweep.parquet")?;
        study.publish(&folder)?;
        // That of an earlier table is none of this one.
        folder.remove(fit::FILE)?;
        let fitted = if self.fit { fit::after_sweep(&study, &folder)? } else { String::new() };
        match printing.json {
            true => output::print(&json(&study.whole())),
            false => printing.print(&study, || page::text(&study) + &fitted, &folder),
        }?;
        // A part is judged with the others, where they are collected.
        if self.part.is_some() { Ok(()) } else { without_answers(&study) }
    }
}

/// A sweep in which every point has failed is an error.
fn without_answers(study: &Study) -> Result<(), RunError> {
    let failures: Vec<&String> = study.rows.iter().filter_map(|row| row.failed.as_ref()).collect();
    match failures.first() {
        Some(first) if failures.len() == study.rows.len() => Err(RunError::Failed(Failure {
            who: format!("the sweep of {}", study.case),
            when: "at every point".to_owned(),
            what: (*first).clone(),
            fix: "see sweep.csv".to_owned(),
        })),
        _ => Ok(()),
    }
}

/// Refuses keys that no point of the sweep reads. Which keys are read may depend on others that vary,
/// such as a model: their words are tried one by one.
fn refuse_unread_keys(
    case: &Path,
    base: &Variant,
    vary: &[Axis],
    standing: &Planned,
) -> Result<(), RunError> {
    let first = |all: Variant, one: &Axis| all.with(&one.key, &one.values[0]);
    for Axis { key, .. } in vary {
        let Err(refused) = refuse_unread(standing, key, "--vary") else { continue };
        let words = vary.iter().filter(|other| other.key != *key && other.numbers().is_none());
        let mut others = words.flat_map(|other| {
            let values = other.values.iter().skip(1);
            values.map(move |value| vary.iter().fold(base.clone(), first).with(&other.key, value))
        });
        let reads = |variant: Variant| {
            planned(case, &variant).is_ok_and(|other| refuse_unread(&other, key, "--vary").is_ok())
        };
        if !others.any(reads) {
            return Err(refused);
        }
    }
    Ok(())
}

/// The folder of a sweep; that of the same one if it was stopped.
fn folder(asked: &SweepCommand, study: &Study) -> Result<StudyFolder, RunError> {
    // A fitted sweep need not be run again. A stopped sweep of another case is refused in `begin`.
    let goes_on = |folder: &Path| {
        earlier(folder, asked.fit).is_some_and(|other| {
            let same = !other.complete || other.identity == study.identity;
            same && other.asks_the_same(study)
        })
    };
    let part = asked.part.map(|part| format!("-{}", part.name()));
    let name = format!("{}-sweep{}", study.case, part.unwrap_or_default());
    asked.folder.choose(Study::COMMAND, &name, &goes_on)
}

/// Begins a sweep, or goes on with the one that was stopped, with all that is known of its points.
fn begin(asked: &SweepCommand, begun: Study, folder: &StudyFolder) -> Result<Growing, RunError> {
    let same = |other: &Study| !asked.folder.replace && other.asks_the_same(&begun);
    let mut sweep = match earlier(folder.path(), asked.fit).filter(same) {
        Some(earlier) => {
            let fix = "--replace begins anew, --out DIR leaves it as it is";
            begun.require_same_case(&earlier, &folder.path().display().to_string(), fix)?;
            engine::refuse_other(folder, asked.engine.engine)?;
            let mut sweep = Growing::again(earlier, folder)?;
            engine::parts(folder)?.iter().try_for_each(|part| collect::part(&mut sweep, part))?;
            sweep
        }
        None => {
            engine::clear(folder)?;
            // A surrogate of an earlier sweep is none of this one.
            folder.remove(fit::FILE)?;
            begun.write(folder)?;
            Growing::begin(begun, folder)?
        }
    };
    asked.collect.iter().try_for_each(|other| collect::folder(&mut sweep, other))?;
    Ok(sweep)
}

/// Runs what is missing on this machine.
fn here(
    sweep: &mut Growing,
    asked: &SweepCommand,
    quantities: &Quantities,
    quiet: bool,
) -> Result<(), RunError> {
    let scratch = Scratch::new()?;
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let (case, base, scratch) = (&*asked.of.case, &asked.of.base(), scratch.path());
    let jobs = asked.jobs.map_or_else(cores, usize::from);
    fill(sweep, &How { case, base, quantities, jobs, scratch, quiet, study: &asked.folder })
}

/// The parts for a scheduler: as many as are under way, as are asked for, or as make tasks of a minute.
fn tasks(
    asked: &SweepCommand,
    study: &Study,
    standing: &Planned,
    folder: &StudyFolder,
) -> Result<Tasks, RunError> {
    if asked.of.case == Path::new("-") {
        let fix = "--engine needs a case in a file: its tasks read it too";
        return Err(RunError::Usage(fix.to_owned()));
    }
    let seconds = expected_run_seconds(Some(standing));
    let parts = engine::parts_under_way(folder).or(asked.engine.parts.map(|parts| parts as usize));
    let parts = parts.unwrap_or_else(|| Tasks::parts_for(study.count(), seconds));
    let case = asked.of.case.display().to_string();
    let fresh = asked.folder.fresh.then(|| "--fresh".to_owned()).into_iter().collect();
    let options = [vec![case], asked.of.base().options(), asked.points.options(), fresh].concat();
    Tasks::new(folder, parts, options, asked.jobs)
}

/// Says on standard error what parts lack.
fn tell_missing(study: &Study) {
    let missing = study.missing().len() as u64;
    let text = match missing {
        0 => "nothing is missing".to_owned(),
        some => format!("{} missing, run now", counted(some, "point")),
    };
    let _ = writeln!(
        std::io::stderr(),
        "{} collected, {text}",
        counted(study.rows.len() as u64, "point")
    );
}
