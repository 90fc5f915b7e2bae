//! Recordings as files, with the errors of commands that read them.

use contract::input_file::{self, InputFileError};
use proto::recording::{Recording, RecordingError};
use run::error::{Failure, RunError, input_failure};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// A recording in a file.
pub type FileRecording = Recording<BufReader<File>>;

/// Opens a recording.
///
/// # Errors
/// The file does not exist, or is not a recording.
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

/// Returns the error for a recording that cannot be read further.
#[must_use]
pub fn failed(path: &Path, error: &RecordingError) -> RunError {
    let fix = match error {
        RecordingError::Format { .. } => "read it with the version that wrote it",
        RecordingError::Io(_) => "check the path and its permissions",
        _ => "record the run again, or copy the file again from its source",
    };
    failure(path, error.to_string(), fix)
}

/// Returns the error for a recording of which only the first part could be read.
#[must_use]
pub fn unreadable(path: &Path, damage: &str) -> RunError {
    failure(path, damage.to_owned(), "everything before the damage was read")
}

fn failure(path: &Path, what: String, fix: &str) -> RunError {
    let (who, when) = ("the recording".to_owned(), format!("at {}", path.display()));
    RunError::Failed(Failure { who, when, what, fix: fix.to_owned() })
}
