//! `coordinator sweep`: runs a case over values of its keys, with one row per point.
//!
//! `--vary` determines the points ([`design`]). They run here ([`crate::study::runner`]) or on
//! other machines ([`engine`]). A file gains one line per point ([`rows`]), so an interrupted sweep
//! resumes with the missing points. The results are a table ([`table`]) and a page with plots
//! ([`page`]).

mod collect;
pub mod compare;
mod design;
mod engine;
mod page;
mod rows;
mod study;
mod table;

pub(crate) use study::Study;
#[cfg(test)]
pub(crate) use table::tests;

use crate::fit;
use crate::study::arguments::StudyArguments;
use crate::study::axis::Axis;
use crate::study::bench::Bench;
use crate::study::folder::StudyFolder;
use crate::study::output::{Printing, StudyFile, StudyPage};
use crate::study::quantity::Quantities;
use crate::study::runner::{Point, Runner};
use crate::study::variants::Variants;
use crate::study::{expected_run_seconds, refuse_unread};
use clap::Args;
use collect::earlier;
use console::case_arguments::CaseArguments;
use console::case_arguments::Changes;
use console::command::{Command, Context, Group};
use console::output;
use contract::text::json;
use design::{Part, PointArguments};
use engine::{Name, Tasks};
use rows::SweepInProgress;
use run::error::{Failure, RunError};
use run::format::counted;
use run::identity::unseen;
use run::plan::{Plan, Planned};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Options of `coordinator sweep`.
#[derive(Debug, Args)]
pub struct SweepCommand {
    #[command(flatten)]
    of: CaseArguments,
    #[command(flatten)]
    points: PointArguments,
    /// Run only one part of the points, for example the third of eight; for other machines and
    /// scheduler jobs.
    #[arg(long, value_name = "I/N", value_parser = Part::read, conflicts_with = "collect")]
    part: Option<Part>,
    /// Collect the results of the same points from these folders, for example from parts. Missing
    /// points are listed and run here.
    #[arg(long, value_name = "DIR", num_args = 1..)]
    collect: Vec<PathBuf>,
    /// Number of points to run at a time, also in each task of a scheduler [default: the number of
    /// cores of the machine or task].
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Fit a surrogate to the results, with errors, for `ask`: fit.json.
    #[arg(long, conflicts_with = "part")]
    fit: bool,
    #[command(flatten)]
    engine: engine::EngineArguments,
    #[command(flatten)]
    folder: StudyArguments,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl Command for SweepCommand {
    const NAME: &'static str = "sweep";
    const GROUP: Group = Group::Study;
    const ABOUT: &'static str = "Run a case over values of its keys";
    const EXAMPLES: &'static [&'static str] = &[
        "coordinator sweep CASE --vary motion.speed=10..80/8",
        "coordinator sweep CASE --vary load.normal_force=60e3..134e3/9cheb --fit",
    ];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let CaseArguments { case, changes: base } = &self.of;
        let design = self.points.design()?;
        let first = |all: Changes, one: &Axis| all.with(&one.key, &one.values[0]);
        let first = design.vary.iter().fold(base.clone(), first);
        let mut bench = self.folder.bench();
        let standing = bench.planned(case, &first)?;
        refuse_unread_keys(&self.of, &design.vary, &standing, &mut bench)?;
        console::logging::log_warnings(&standing.plan.warnings);
        let mut study = Study::new(&standing, case.display().to_string(), base, design)?;
        study.part = self.part;
        let folder = folder(self, &study)?;
        let mut sweep = begin(self, study, &folder)?;
        tell_reused(&sweep.study, &standing.plan);
        let printing = Printing { json: self.json, quiet: context.quiet };
        if !self.collect.is_empty() && !printing.is_silent() {
            tell_missing(&sweep.study);
        }
        let quantities = Quantities::of_figures(&standing.plan.figures);
        match self.engine.engine {
            Name::Local => run_here(&mut sweep, self, bench, &quantities, printing.is_silent())?,
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
        // This build lacks the feature; remove a file written by an earlier build with it.
        #[cfg(not(feature = "parquet"))]
        folder.remove("sweep.parquet")?;
        study.publish(&folder)?;
        // A surrogate of an earlier sweep is obsolete.
        folder.remove(fit::FILE)?;
        let fitted = if self.fit { fit::after_sweep(&study, &folder)? } else { String::new() };
        match printing.json {
            true => output::print(&json(&study.whole())),
            false => printing.print(&study, || page::text(&study) + &fitted, &folder),
        }?;
        // A part is judged only together with the others, when all are collected.
        if self.part.is_some() { Ok(()) } else { without_answers(&study) }
    }
}

/// Returns an error if every point has failed.
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

/// Refuses keys that no point of the sweep reads. Other varied keys, such as the choice of a model,
/// may decide whether a key is read, so their values are tried one by one.
fn refuse_unread_keys(
    of: &CaseArguments,
    vary: &[Axis],
    standing: &Planned,
    bench: &mut Bench,
) -> Result<(), RunError> {
    let first = |all: Changes, one: &Axis| all.with(&one.key, &one.values[0]);
    for Axis { key, .. } in vary {
        let Err(refused) = refuse_unread(standing, key, "--vary") else { continue };
        let words = vary.iter().filter(|other| other.key != *key && other.numbers().is_none());
        let mut others = words.flat_map(|other| {
            let values = other.values.iter().skip(1);
            values.map(move |value| {
                vary.iter().fold(of.changes.clone(), first).with(&other.key, value)
            })
        });
        let reads = |variant: Changes| {
            bench
                .planned(&of.case, &variant)
                .is_ok_and(|other| refuse_unread(&other, key, "--vary").is_ok())
        };
        if !others.any(reads) {
            return Err(refused);
        }
    }
    Ok(())
}

/// Chooses the folder of the sweep; an interrupted sweep of the same points is resumed.
fn folder(asked: &SweepCommand, study: &Study) -> Result<StudyFolder, RunError> {
    // Fitting a finished sweep needs no new runs. `begin` refuses to resume a sweep of another
    // case.
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

/// Begins a sweep or resumes an interrupted one, with all known results.
fn begin(
    asked: &SweepCommand,
    begun: Study,
    folder: &StudyFolder,
) -> Result<SweepInProgress, RunError> {
    let same = |other: &Study| !asked.folder.replace && other.asks_the_same(&begun);
    let mut sweep = match earlier(folder.path(), asked.fit).filter(same) {
        Some(earlier) => {
            let fix = "--replace starts again, --out DIR leaves that sweep untouched";
            begun.require_same_case(&earlier, &folder.path().display().to_string(), fix)?;
            engine::refuse_other(folder, asked.engine.engine)?;
            let mut sweep = SweepInProgress::again(earlier, folder)?;
            engine::parts(folder)?.iter().try_for_each(|part| collect::part(&mut sweep, part))?;
            sweep
        }
        None => {
            engine::clear(folder)?;
            // A surrogate of an earlier sweep is obsolete.
            folder.remove(fit::FILE)?;
            begun.write(folder)?;
            SweepInProgress::begin(begun, folder)?
        }
    };
    asked.collect.iter().try_for_each(|other| collect::folder(&mut sweep, other))?;
    Ok(sweep)
}

/// Runs the missing points on this machine and writes each row as soon as its run ends.
fn run_here(
    sweep: &mut SweepInProgress,
    asked: &SweepCommand,
    bench: Bench,
    quantities: &Quantities,
    quiet: bool,
) -> Result<(), RunError> {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let mut runner = Runner::new(Variants::of(&asked.of.case), &asked.folder, bench, quiet)?;
    runner.jobs = asked.jobs.map_or_else(cores, usize::from);
    let study = &sweep.study;
    let missing: Vec<Vec<usize>> = study.missing().into_iter().map(|n| study.point(n)).collect();
    let point = |at: &Vec<usize>| {
        let set = |all: Changes, (one, at): (&Axis, &usize)| all.with(&one.key, &one.values[*at]);
        let changes = study.vary.iter().zip(at).fold(asked.of.changes.clone(), set);
        Point { name: study.told(at), changes }
    };
    let points: Vec<Point> = missing.iter().map(point).collect();
    runner.run(&points, |n, attempt| {
        let row = sweep.study.row(&missing[n], attempt, quantities);
        sweep.add(row)
    })
}

/// Reports that earlier points stay in the table, and which changes since would not be seen.
fn tell_reused(study: &Study, plan: &Plan) {
    let unseen = unseen(plan);
    let goes_on = !study.missing().is_empty();
    if !study.rows.is_empty() && (goes_on || !unseen.is_empty()) {
        let count = counted(study.rows.len() as u64, "point");
        tracing::warn!("{count} of earlier runs stay; --replace repeats all{unseen}");
    }
}

/// Divides the points into tasks for a scheduler: as many parts as are already submitted, as
/// requested, or as give tasks of about a minute.
fn tasks(
    asked: &SweepCommand,
    study: &Study,
    standing: &Planned,
    folder: &StudyFolder,
) -> Result<Tasks, RunError> {
    if asked.of.case == Path::new("-") {
        let fix = "--engine needs a case file rather than standard input, because every task reads \
                   the case";
        return Err(RunError::Usage(fix.to_owned()));
    }
    let seconds = expected_run_seconds(Some(standing));
    let parts = engine::parts_under_way(folder).or(asked.engine.parts.map(|parts| parts as usize));
    let parts = parts.unwrap_or_else(|| Tasks::parts_for(study.count(), seconds));
    let case = asked.of.case.display().to_string();
    let fresh = asked.folder.fresh.then(|| "--fresh".to_owned()).into_iter().collect();
    let options =
        [vec![case], asked.of.changes.clone().options(), asked.points.options(), fresh].concat();
    Tasks::new(folder, parts, options, asked.jobs)
}

/// Reports on standard error how many points the collected folders lack.
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
