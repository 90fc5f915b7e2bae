//! `coordinator compare A B`: what differs between two results in case, figures, fields and time.

mod difference;
mod fields;
mod flat;
mod show;

use crate::output::print;
use crate::report::source::Results;
use clap::Args;
use contract::text::json;
use difference::Comparison;
use run::error::RunError;
use run::signals;
use std::path::PathBuf;

/// Two results.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A result directory.
    #[arg(value_name = "A")]
    a: PathBuf,
    /// Another one.
    #[arg(value_name = "B")]
    b: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Compares, and prints.
///
/// # Errors
/// One of the folders holds no results; it cannot be printed.
pub(crate) fn main(asked: &Arguments, quiet: bool) -> Result<(), RunError> {
    let _reading = signals::end_at_once();
    let [a, b] = [Results::read(&asked.a)?, Results::read(&asked.b)?];
    let comparison = Comparison::of(&a, &b);
    if asked.json {
        return print(&json(&comparison));
    }
    if quiet { Ok(()) } else { print(&show::text(&comparison, [&asked.a, &asked.b])) }
}
