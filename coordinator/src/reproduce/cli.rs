//! The subcommand.

use super::{Request, reproduce};
use crate::output::Speaker;
use crate::study::arguments::StudyArguments;
use clap::Args;
use run::error::RunError;
use std::path::PathBuf;

/// What `coordinator reproduce` is asked.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The study: its cases, tables, figures and text.
    #[arg(default_value = "cases/paper/study.toml")]
    study: PathBuf,
    #[command(flatten)]
    folder: StudyArguments,
    /// Write the text here too, and its plots into img/NAME beside it.
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
    /// Compare this text, which was written earlier, with the new one; exit 4 if it is stale.
    #[arg(long, value_name = "FILE")]
    check: Option<PathBuf>,
}

/// Runs the study and writes what it gives.
///
/// # Errors
/// A study that is wrong, those of its runs, a text that is stale.
pub(crate) fn main(asked: &Arguments, quiet: bool) -> Result<(), RunError> {
    let _participants = asked.folder.keep();
    let request = Request {
        study: &asked.study,
        folder: &asked.folder,
        write: asked.write.as_deref(),
        check: asked.check.as_deref(),
    };
    let mut speaker = Speaker::new(quiet);
    let outcome = reproduce(&request, &mut speaker);
    speaker.end(outcome)
}
