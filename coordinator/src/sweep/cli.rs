//! The subcommand.

use super::design::Asked;
use super::page;
use super::perform::{How, fill};
use super::study::Study;
use crate::study::arguments::{CaseArguments, FolderArguments};
use crate::study::axis::Axis;
use crate::study::output::{Kept, Printing, Shown};
use crate::study::quantity::Quantities;
use crate::study::{Variant, planned, scratch};
use clap::Args;
use run::error::RunError;
use std::path::Path;

/// What `coordinator sweep` is asked.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    of: CaseArguments,
    #[command(flatten)]
    points: Asked,
    /// Points that are run at a time [default: as many as there are cores].
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
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
    let begun = Study::new(&standing.plan, case.display().to_string(), &base, design);
    let goes_on = |folder: &Path| stopped(folder).is_some_and(|other| other.asks_the_same(&begun));
    let name = format!("{}-sweep", begun.case);
    let folder = asked.folder.choose(Study::COMMAND, &name, &goes_on)?;
    let mut study = match stopped(folder.path()).filter(|other| other.asks_the_same(&begun)) {
        Some(earlier) if !asked.folder.replace => earlier,
        _ => begun,
    };
    study.write(&folder)?;
    let quantities = Quantities::of_figures(&standing.plan.figures);
    let scratch = scratch()?;
    let printing = Printing { json: asked.json, quiet };
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
    printing.print(&study, || page::text(&study), &folder)
}

/// A sweep of this folder that was stopped.
fn stopped(folder: &Path) -> Option<Study> {
    let text = std::fs::read(folder.join(Study::FILE)).ok()?;
    serde_json::from_slice(&text).ok().filter(|study: &Study| !study.complete)
}
