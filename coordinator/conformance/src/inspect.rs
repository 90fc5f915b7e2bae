//! `coordinator inspect`: what a recording holds, in one pass over the file.

mod range;
mod show;
mod survey;

pub use range::Range;
pub use show::{details_text, text};
pub use survey::{Details, FieldSurvey, Survey, Wanted, survey};

use clap::Args;
use console::command::{Command, Context, Group};
use console::output::print;
use contract::input_file::{self, InputFileError};
use contract::text::json;
use proto::recording::{Recording, RecordingError};
use run::error::{Failure, RunError, input_failure};
use run::signals;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Options of `coordinator inspect`.
#[derive(Debug, Args)]
pub struct InspectCommand {
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

impl Command for InspectCommand {
    const NAME: &'static str = "inspect";
    const GROUP: Group = Group::Look;
    const ABOUT: &'static str =
        "Show what a recording holds: windows, iterations, ranges, residuals, timings";

    fn run(&self, _: &Context<'_>) -> Result<(), RunError> {
        let _reading = signals::end_at_once();
        let path = &self.recording;
        let wanted =
            Wanted { field: self.field.clone(), window: self.window, iterations: self.iterations };
        let mut recording = open(path)?;
        let survey = survey(&mut recording, &wanted);
        let damaged = |damage: &String| Err(unreadable(path, damage));
        if self.json {
            print(&json(&survey))?;
            return survey.damage.as_ref().map_or(Ok(()), damaged);
        }
        print(&text(&survey, path))?;
        if let Some(details) = &survey.details {
            print(&details_text(&survey, details, wanted.window.is_none()))?;
        }
        survey.damage.as_ref().map_or(Ok(()), damaged)
    }
}

/// A recording in a file.
pub type FileRecording = Recording<BufReader<File>>;

/// Opens a recording.
///
/// # Errors
/// There is no such file, or it is no recording.
pub fn open(path: &Path) -> Result<FileRecording, RunError> {
    let file = input_file::open(path).map_err(|error| match error {
        InputFileError::System(error) if error.kind() == std::io::ErrorKind::NotFound => {
            RunError::Usage(format!(
                "there is no recording {}; `coordinator run CASE --record` writes one",
                path.display()
            ))
        }
        error => input_failure(path, &error),
    })?;
    Recording::open(BufReader::with_capacity(1 << 20, file)).map_err(|error| failed(path, &error))
}

/// The error for a recording that cannot be read on.
#[must_use]
pub fn failed(path: &Path, error: &RecordingError) -> RunError {
    let fix = match error {
        RecordingError::Format { .. } => "read it with the version that wrote it",
        RecordingError::Io(_) => "check the path and its permissions",
        _ => "record the run again, or take the file from where it was made",
    };
    failure(path, error.to_string(), fix)
}

/// The error for a recording of which only the first part could be read.
#[must_use]
pub fn unreadable(path: &Path, damage: &str) -> RunError {
    failure(path, damage.to_owned(), "everything before the damage was read")
}

fn failure(path: &Path, what: String, fix: &str) -> RunError {
    let (who, when) = ("the recording".to_owned(), format!("at {}", path.display()));
    RunError::Failed(Failure { who, when, what, fix: fix.to_owned() })
}
