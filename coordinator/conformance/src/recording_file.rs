//! Recordings as files, with the errors of commands that read them.

use contract::input_file::{self, InputFileError};
use proto::recording::{Recording, RecordingError};
use run::error::{Failure, RunError, input_failure};
use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// A recording in a file.
pub type FileRecording = Recording<BufReader<File>>;

/// Returns the path of a recording that a user names by itself or by its result folder. Of several
/// recordings in a folder, it is the one that was written last.
///
/// # Errors
/// The folder holds no recording.
pub fn find(path: &Path) -> Result<PathBuf, RunError> {
    if !path.is_dir() {
        return Ok(path.to_owned());
    }
    newest_in(path).ok_or_else(|| {
        RunError::Usage(format!(
            "{} holds no recording; `coordinator run CASE --record` writes one",
            path.display()
        ))
    })
}

/// Returns the recording of a result folder that was written last.
#[must_use]
pub fn newest_in(folder: &Path) -> Option<PathBuf> {
    let recordings = fs::read_dir(folder).ok()?.flatten().filter(|entry| {
        let name = entry.file_name().to_string_lossy().into_owned();
        name.starts_with("recording") && name.ends_with(".mcap")
    });
    let dated = recordings
        .filter_map(|entry| Some((entry.metadata().ok()?.modified().ok()?, entry.path())));
    dated.max().map(|(_, path)| path)
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, SystemTime};

    #[test]
    fn a_result_folder_stands_for_its_newest_recording() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        let none = find(place.path()).unwrap_err().to_string();
        assert!(none.contains("holds no recording; `coordinator run CASE --record`"), "{none}");
        for (name, age) in [("recording.mcap", 20), ("recording-000120.mcap", 10), ("a.mcap", 0)] {
            let file = File::create(at(name)).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(age)).unwrap();
        }
        assert_eq!(find(place.path()).unwrap(), at("recording-000120.mcap"));
        assert_eq!(find(&at("recording.mcap")).unwrap(), at("recording.mcap"));
    }
}
