//! The subcommand.

use super::page;
use super::perform::{Request, study};
use super::study::Study;
use crate::study::arguments::{CaseArguments, StudyArguments};
use crate::study::axis::Axis;
use crate::study::output::{Kept, Printing, Shown};
use crate::study::{planned, refuse_unread};
use clap::Args;
use run::error::RunError;
use run::scratch::Scratch;

/// What `coordinator states` is asked.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    of: CaseArguments,
    /// What the runs start from: a key, and its values or a range [SI].
    #[arg(long, value_name = "KEY=A,B,C|FROM..TO/COUNT", value_parser = Axis::read)]
    start: Axis,
    #[command(flatten)]
    folder: StudyArguments,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Makes the study, writes its files and prints it.
///
/// # Errors
/// A case that cannot run or is not steady, the file system.
pub(crate) fn main(asked: &Arguments, quiet: bool) -> Result<(), RunError> {
    let _participants = asked.folder.keep();
    let (case, base) = (asked.of.case.clone(), asked.of.base());
    let standing = planned(&case, &base.with(&asked.start.key, &asked.start.values[0]))?;
    refuse_unread(&standing, &asked.start.key, "--start")?;
    crate::logging::log_warnings(&standing.plan.warnings);
    let name = format!("{}-states", standing.plan.name);
    let folder = asked.folder.choose(Study::COMMAND, &name, &|_| false)?;
    let scratch = Scratch::new()?;
    let printing = Printing { json: asked.json, quiet };
    let request = Request { case, base, starts: asked.start.clone() };
    let study = study(&request, &standing, printing.is_silent(), scratch.path())?;
    study.publish(&folder)?;
    printing.print(&study, || page::text(&study), &folder)
}
