//! The subcommand.

use super::{FILE, Request, show, study};
use crate::error::RunError;
use crate::report;
use crate::study::folder::StudyFolder;
use crate::study::{Variant, planned, scratch};
use clap::Args;
use proto::text::{json, visible};
use std::io::Write;
use std::path::{Path, PathBuf};

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
    /// Folder of the study [default: results/NAME-ablate].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
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
    let folder = match &asked.out {
        Some(folder) => folder.clone(),
        None => {
            let name = planned(&asked.case, &base)?.plan.name;
            Path::new("results").join(format!("{name}-ablate"))
        }
    };
    let folder = StudyFolder::check(&folder, FILE)?;
    let scratch = scratch()?;
    let request = Request { case: asked.case.clone(), base, repeat: asked.repeat };
    let study = study(&request, quiet || asked.json, scratch.path())?;
    let json = json(&study);
    folder.write(FILE, json.as_bytes())?;
    report::write(folder.path())?;
    let text = match (asked.json, quiet) {
        (true, _) => json,
        (false, true) => String::new(),
        (false, false) => {
            format!("{}  results   {}\n", show::text(&study), folder.path().display())
        }
    };
    // A reader that has gone away (`| head`) is no failure of ours.
    let _ = std::io::stdout().write_all(visible(&text).as_bytes());
    Ok(())
}
