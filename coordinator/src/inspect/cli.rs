//! The subcommand.

use super::{Wanted, details_text, open, survey, text, unreadable};
use crate::output::print;
use clap::Args;
use contract::text::json;
use run::error::RunError;
use run::signals;
use std::path::PathBuf;

/// What `coordinator inspect` is asked.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The recording.
    recording: PathBuf,
    /// List the samples of this field (or topic) one by one.
    #[arg(long, value_name = "NAME")]
    field: Option<String>,
    /// List iterations and samples of this window.
    #[arg(long, value_name = "NUMBER")]
    window: Option<u64>,
    /// List all iterations.
    #[arg(long)]
    iterations: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Reads a recording and prints what it holds.
///
/// # Errors
/// It cannot be read, or not to its end.
pub(crate) fn main(asked: &Arguments) -> Result<(), RunError> {
    let _reading = signals::end_at_once();
    let path = &asked.recording;
    let wanted =
        Wanted { field: asked.field.clone(), window: asked.window, iterations: asked.iterations };
    let mut recording = open(path)?;
    let survey = survey(&mut recording, &wanted);
    let damaged = |damage: &String| Err(unreadable(path, damage));
    if asked.json {
        print(&json(&survey))?;
        return survey.damage.as_ref().map_or(Ok(()), damaged);
    }
    print(&text(&survey, path))?;
    if let Some(details) = &survey.details {
        print(&details_text(&survey, details, wanted.window.is_none()))?;
    }
    survey.damage.as_ref().map_or(Ok(()), damaged)
}
