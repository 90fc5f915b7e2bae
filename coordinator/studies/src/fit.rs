//! `coordinator fit` and `sweep --fit`: fits a surrogate to a sweep, which gives the figures as
//! functions of the keys that varied.
//!
//! Steps: the table of a sweep is converted to numbers in SI units, and restricted to a box free of
//! failed points ([`samples`]). For each figure, the scales ([`scales`]) and the terms ([`grow`])
//! with the smallest error at held-out points ([`held`]) are chosen. The result is a
//! [`surrogate::Document`], which the crate `surrogate` reads and evaluates. docs/surrogate.md
//! explains the mathematics.

mod grow;
mod held;
mod make;
mod samples;
mod scales;

use crate::study::folder::StudyFolder;
use crate::study::output::StudyFile as _;
use crate::sweep::Study;
use clap::Args;
use console::command::{Command, Context, Group};
use console::output::print;
use contract::text::json;
use make::Made;
use run::error::RunError;
use run::results::write::replace;
use samples::Quotient;
use std::path::PathBuf;

/// Name of the surrogate in the folder of the sweep.
pub(crate) const FILE: &str = "fit.json";

/// Options of `coordinator fit`.
#[derive(Debug, Args)]
pub struct FitCommand {
    /// Folder of a finished sweep.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Use the quotient of two keys as a coordinate in place of the first key: for a quotient that
    /// limits where results exist, or on which the figures depend.
    #[arg(long, value_name = "KEY/KEY", value_parser = Quotient::read)]
    per: Vec<Quotient>,
    /// File to write [default: DIR/fit.json].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print the contents of the file as JSON.
    #[arg(long)]
    json: bool,
}

impl Command for FitCommand {
    const NAME: &'static str = "fit";
    const GROUP: Group = Group::Study;
    const ABOUT: &'static str = "Fit a surrogate to the figures of a sweep";
    const EXAMPLES: &'static [&'static str] = &["coordinator fit results/creep"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let study = Study::read(&self.folder)?;
        let out = self.out.clone().unwrap_or_else(|| self.folder.join(FILE));
        let made = Made::of(&study, &self.per)?;
        replace(&out, &made.file())?;
        match (self.json, context.quiet) {
            (true, _) => print(&json(&made.document)),
            (false, true) => Ok(()),
            (false, false) => {
                print(&format!("{}  surrogate {}\n", make::text(&made), out.display()))
            }
        }
    }
}

/// Fits the surrogate of a sweep that has just finished, and writes it into the folder of the
/// sweep.
///
/// # Errors
/// No surrogate can be fitted, or the file cannot be written.
pub(crate) fn after_sweep(study: &Study, folder: &StudyFolder) -> Result<String, RunError> {
    let made = Made::of(study, &[])?;
    folder.write(FILE, &made.file())?;
    Ok(make::text(&made))
}

#[cfg(test)]
mod tests;

pub(crate) use samples::number;
