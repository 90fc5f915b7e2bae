//! The subcommand.

use super::{FILE, Request, show, study};
use crate::output::print;
use crate::report;
use crate::study::folder::{StudyFolder, Wanted};
use crate::study::{Variant, planned, scratch};
use clap::Args;
use contract::text::json;
use run::error::RunError;
use std::path::PathBuf;

/// What `coordinator ablate` is asked.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The case file.
    case: PathBuf,
    /// Change a key for all runs: dotted name and TOML value (a bare word is a text).
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Remove a key for all runs.
    #[arg(long, value_name = "KEY")]
    unset: Vec<String>,
    /// Make each run so often; its times are the least.
    #[arg(long, value_name = "TIMES", default_value_t = 2,
          value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// Folder of the study [default: results/NAME-ablate, or NAME-ablate-2 and so on].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace an earlier study in that folder.
    #[arg(long)]
    replace: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Makes the study, writes its files and prints it.
///
/// # Errors
/// A case that cannot run, the file system.
pub fn main(asked: &Arguments, quiet: bool) -> Result<(), RunError> {
    let base = Variant { set: asked.set.clone(), unset: asked.unset.clone() };
    let standing = planned(&asked.case, &base)?;
    crate::logging::warn_of_replaced(&standing.case);
    let folder = StudyFolder::choose(&Wanted {
        command: "ablate",
        name: &format!("{}-ablate", standing.plan.name),
        out: asked.out.as_deref(),
        replace: asked.replace,
        goes_on: &|_| false,
    })?;
    let scratch = scratch()?;
    let request = Request { case: asked.case.clone(), base, repeat: asked.repeat };
    let study = study(&request, quiet || asked.json, scratch.path())?;
    let json = json(&study);
    folder.write(FILE, json.as_bytes())?;
    report::write(&folder.open()?)?;
    print(&match (asked.json, quiet) {
        (true, _) => json,
        (false, true) => String::new(),
        (false, false) => {
            format!("{}  results   {}\n", show::text(&study), folder.path().display())
        }
    })
}
