//! The subcommand.

use super::{FILE, show, study};
use crate::error::{RunError, file_failure};
use crate::report;
use crate::results::folder::replace;
use crate::study::{Variant, planned};
use clap::Args;
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
    std::fs::create_dir_all(&folder).map_err(|error| file_failure(&folder, &error))?;
    let scratch = tempfile::Builder::new().prefix(".run-").tempdir_in(&folder);
    let scratch = scratch.map_err(|error| file_failure(&folder, &error))?;
    let study = study(&asked.case, &base, quiet || asked.json, scratch.path())?;
    let json = serde_json::to_string_pretty(&study).expect("a study is plain data") + "\n";
    replace(&folder.join(FILE), json.as_bytes())?;
    report::write(&folder)?;
    let text = match (asked.json, quiet) {
        (true, _) => json,
        (false, true) => String::new(),
        (false, false) => format!("{}  results   {}\n", show::text(&study), folder.display()),
    };
    // A reader that has gone away (`| head`) is no failure of ours.
    let _ = std::io::stdout().write_all(text.as_bytes());
    Ok(())
}
