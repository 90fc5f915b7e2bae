//! `coordinator fit`, and `sweep --fit`: a surrogate of a sweep, its figures as functions of the keys that varied.
//!
//! The table of a sweep → [`samples`] (numbers in SI units; [`region`]: a box without points that have no answer) →
//! for each figure its scales ([`scales`]) and its terms ([`grow`]), by the error at points held out ([`held`]) →
//! a [`surrogate::Document`], which that crate reads and evaluates. docs/surrogate.md has the mathematics.

mod grow;
mod held;
mod make;
mod region;
mod samples;
mod scales;
mod show;

use crate::study::folder::StudyFolder;
use crate::study::output::Kept as _;
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

/// The file in the folder of the sweep.
pub(crate) const FILE: &str = "fit.json";

/// Options of `coordinator fit`.
#[derive(Debug, Args)]
pub struct FitCommand {
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

impl Command for FitCommand {
    const NAME: &'static str = "fit";
    const GROUP: Group = Group::Study;
    const ABOUT: &'static str =
        "Fit the figures of a sweep, with errors, for `ask` and for simulations that link to them";

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let study = Study::read(&self.folder)?;
        let out = self.out.clone().unwrap_or_else(|| self.folder.join(FILE));
        let made = Made::of(&study, &self.per)?;
        replace(&out, &made.file())?;
        match (self.json, context.quiet) {
            (true, _) => print(&json(&made.document)),
            (false, true) => Ok(()),
            (false, false) => {
                print(&format!("{}  surrogate {}\n", show::text(&made), out.display()))
            }
        }
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

#[cfg(test)]
mod tests;

pub(crate) use samples::number;
