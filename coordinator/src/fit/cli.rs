//! The subcommand, and the end of `sweep --fit`.

use super::make::Made;
use super::samples::Quotient;
use super::show;
use crate::output::print;
use crate::study::folder::StudyFolder;
use crate::study::output::Kept as _;
use crate::sweep::Study;
use clap::Args;
use contract::text::json;
use run::error::RunError;
use run::results::write::replace;
use std::path::PathBuf;

/// The file in the folder of the sweep.
pub(crate) const FILE: &str = "fit.json";

/// What `coordinator fit` is asked.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The folder of a sweep that has come to its end.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Take the quotient of two keys as coordinate in the place of the first: where that bounds what has an
    /// answer, or the figures go with it.
    #[arg(long, value_name = "KEY/KEY", value_parser = Quotient::read)]
    per: Vec<Quotient>,
    /// Where it is written [default: DIR/fit.json].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print JSON: the file.
    #[arg(long)]
    json: bool,
}

/// Makes a surrogate of a sweep that is done.
///
/// # Errors
/// It is none, or no surrogate can be made of it; the file system.
pub(crate) fn main(asked: &Arguments, quiet: bool) -> Result<(), RunError> {
    let study = Study::read(&asked.folder)?;
    let out = asked.out.clone().unwrap_or_else(|| asked.folder.join(FILE));
    let made = Made::of(&study, &asked.per)?;
    replace(&out, &made.file())?;
    match (asked.json, quiet) {
        (true, _) => print(&json(&made.document)),
        (false, true) => Ok(()),
        (false, false) => print(&format!("{}  surrogate {}\n", show::text(&made), out.display())),
    }
}

/// Makes the surrogate of a sweep that has just come to its end, and writes it into its folder.
///
/// # Errors
/// Those of [`main`].
pub(crate) fn after_sweep(study: &Study, folder: &StudyFolder) -> Result<String, RunError> {
    let made = Made::of(study, &[])?;
    folder.write(FILE, &made.file())?;
    Ok(show::text(&made))
}
