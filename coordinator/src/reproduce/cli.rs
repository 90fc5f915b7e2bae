//! The subcommand.

use super::study::Study;
use super::{Request, reproduce};
use crate::error::RunError;
use clap::Args;
use proto::text::visible;
use std::io::Write;
use std::path::PathBuf;

/// What `coordinator reproduce` is asked.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The study: its cases, tables, figures and text.
    #[arg(default_value = "cases/paper/study.toml")]
    study: PathBuf,
    /// Folder for runs, text and plots [default: results/NAME].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
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
pub fn main(asked: &Arguments, quiet: bool) -> Result<(), RunError> {
    let out = match &asked.out {
        Some(out) => out.clone(),
        None => PathBuf::from("results").join(Study::read(&asked.study)?.name),
    };
    let request = Request {
        study: asked.study.clone(),
        out,
        write: asked.write.clone(),
        check: asked.check.clone(),
    };
    reproduce(&request, &mut |line| print(quiet, line))?;
    print(quiet, &format!("{}\n", request.out.display()));
    Ok(())
}

fn print(quiet: bool, text: &str) {
    if !quiet {
        // A reader that has gone away (`| head`) is no failure of ours.
        let mut out = std::io::stdout();
        let _ = out.write_all(visible(text).as_bytes()).and_then(|()| out.flush());
    }
}
