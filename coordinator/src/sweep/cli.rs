//! The subcommand.

use super::design::{Asked, Part};
use super::page;
use super::perform::{How, fill};
use super::study::Study;
use crate::fit;
use crate::study::arguments::{CaseArguments, FolderArguments};
use crate::study::axis::Axis;
use crate::study::output::{Kept, Printing, Shown};
use crate::study::quantity::Quantities;
use crate::study::{Variant, planned, scratch};
use clap::Args;
use run::error::{RunError, file_failure};
use run::format::counted;
use std::io::Write;
use std::path::{Path, PathBuf};

/// What `coordinator sweep` is asked.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
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
    /// Points that are run at a time [default: as many as there are cores].
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Fit the figures that were found, with errors, for `ask`: fit.json.
    #[arg(long, conflicts_with = "part")]
    fit: bool,
    #[command(flatten)]
    folder: FolderArguments,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Makes the sweep, or goes on with one that was stopped, writes its files and prints it.
///
/// # Errors
/// A case that cannot run, the user has stopped it, the file system.
pub(crate) fn main(asked: &Arguments, quiet: bool) -> Result<(), RunError> {
    let (case, base) = (asked.of.case.clone(), asked.of.base());
    let design = asked.points.design()?;
    let first = |all: Variant, one: &Axis| all.with(&one.key, &one.values[0]);
    let standing = planned(&case, &design.vary.iter().fold(base.clone(), first))?;
    crate::logging::warn_of_replaced(&standing.case);
    let of = case.display().to_string();
    let begun = Study { part: asked.part, ..Study::new(&standing.plan, of, &base, design) };
    let goes_on =
        |folder: &Path| earlier(folder, asked.fit).is_some_and(|other| other.asks_the_same(&begun));
    let part = asked.part.map(|Part { one, of }| format!("-{one}-of-{of}"));
    let name = format!("{}-sweep{}", begun.case, part.unwrap_or_default());
    let folder = asked.folder.choose(Study::COMMAND, &name, &goes_on)?;
    let mut study =
        match earlier(folder.path(), asked.fit).filter(|other| other.asks_the_same(&begun)) {
            Some(earlier) if !asked.folder.replace => earlier,
            _ => begun,
        };
    for other in &asked.collect {
        collect(&mut study, other)?;
    }
    let printing = Printing { json: asked.json, quiet };
    if !asked.collect.is_empty() && !printing.is_silent() {
        tell_missing(&study);
    }
    study.write(&folder)?;
    let quantities = Quantities::of_figures(&standing.plan.figures);
    let scratch = scratch()?;
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let how = How {
        case: &case,
        base: &base,
        quantities: &quantities,
        jobs: asked.jobs.map_or_else(cores, usize::from),
        scratch: scratch.path(),
        quiet: printing.is_silent(),
    };
    fill(&mut study, &how, &folder)?;
    folder.write("sweep.csv", &study.csv())?;
    study.publish(&folder)?;
    // That of an earlier table is none of this one.
    folder.remove(fit::FILE)?;
    let fitted = if asked.fit { fit::after_sweep(&study, &folder)? } else { String::new() };
    printing.print(&study, || page::text(&study) + &fitted, &folder)
}

/// Takes the rows of a sweep in another folder, finished or not.
fn collect(study: &mut Study, other: &Path) -> Result<(), RunError> {
    let path = other.join(Study::FILE);
    let text = std::fs::read(&path).map_err(|error| file_failure(&path, &error))?;
    let wrong = |why: String| RunError::Usage(format!("--collect {}: {why}", other.display()));
    let found: Study = serde_json::from_slice(&text).map_err(|error| wrong(error.to_string()))?;
    match study.collect(found) {
        true => Ok(()),
        false => Err(wrong(
            "is of other points; give the case and options that it was made with".to_owned(),
        )),
    }
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

/// A sweep of this folder that was stopped, or has come to its end too: what is fitted need not be run again.
fn earlier(folder: &Path, complete: bool) -> Option<Study> {
    let text = std::fs::read(folder.join(Study::FILE)).ok()?;
    serde_json::from_slice(&text).ok().filter(|study: &Study| complete || !study.complete)
}
