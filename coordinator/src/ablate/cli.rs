//! The subcommand.

use super::perform::{Request, study};
use super::runs;
use super::study::Study;
use crate::study::arguments::{CaseArguments, RepeatArguments, StudyArguments};
use crate::study::output::{Kept, Printing, Shown};
use crate::study::planned;
use clap::Args;
use run::error::RunError;
use run::scratch::Scratch;

/// What `coordinator ablate` is asked.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    of: CaseArguments,
    #[command(flatten)]
    times: RepeatArguments,
    #[command(flatten)]
    folder: StudyArguments,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Makes the study, writes its files and prints it.
///
/// # Errors
/// A case that cannot run, the file system.
pub(crate) fn main(asked: &Arguments, quiet: bool) -> Result<(), RunError> {
    let _participants = asked.folder.keep();
    let (case, base) = (asked.of.case.clone(), asked.of.base());
    let standing = planned(&case, &base)?;
    crate::logging::log_warnings(&standing.plan.warnings);
    let name = format!("{}-ablate", standing.plan.name);
    let folder = asked.folder.choose(Study::COMMAND, &name, &|_| false)?;
    let scratch = Scratch::new()?;
    let printing = Printing { json: asked.json, quiet };
    let request = Request { case, base, repeat: asked.times.repeat };
    let study = study(&request, printing.is_silent(), scratch.path())?;
    study.publish(&folder)?;
    printing.print(&study, || runs::text(&study), &folder)
}
