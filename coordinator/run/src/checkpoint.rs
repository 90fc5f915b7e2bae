//! Checkpoints: the state of a whole run between two windows, in `DIR/checkpoints/`.
//!
//! ```text
//! checkpoints/000120/             window 120 is the next one
//!     coordinator.state           state of the coordinator, and checksums of the other files
//!     ROLE.state                  state of each participant
//!     FIELD.values                values sent last, as little-endian doubles
//!     ROLE.GRID.geometry          the grid of those values, if it moves
//! ```
//!
//! A checkpoint is written under the name `000120.new`, every file is flushed to the disk, and the
//! folder is then renamed. Under its final name a checkpoint is complete, unless the disk fails.
//! The last [`KEPT`] checkpoints are kept. `coordinator.state` holds the length and CRC-64 of every
//! file, and its own CRC-64 in its head, so that a corrupt checkpoint is recognised.
//! [`Checkpoints::newest`] reports the damage and takes the checkpoint before.

use crate::error::{RunError, file_failure};
use crate::results::counts::Counts;
use crate::results::vtk::FileSeries;
use crate::sealed::{self, Magic, SealedFileError, sum_of_stream};
use coupling::windows;
use proto::binary;
use proto::recording::Compression;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// Number of checkpoints that are kept.
pub const KEPT: usize = 2;

/// Folder of the checkpoints in the result directory.
pub const FOLDER: &str = "checkpoints";

/// The coordinator's part, written after all others: without it a folder is no checkpoint.
const OWN: &str = "coordinator.state";
/// First bytes of every [`OWN`] file; the digit is the version of its layout.
const MAGIC: &Magic = b"COSIMCK3";

/// Origin of a run. A run resumes only from a checkpoint of the same origin.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// Version of the coordinator.
    pub version: String,
    /// Version of the participant contract.
    pub protocol: u32,
    /// The case, as text.
    pub case: String,
    /// Folder to which relative file names in the case refer.
    #[serde(with = "raw_path")]
    pub folder: PathBuf,
    /// CRC-64 of each part of the plan, by name.
    pub plan: Vec<(String, u64)>,
    /// CRC-64 of each file that the case names, by key.
    pub files: BTreeMap<String, String>,
}

/// The coordinator's part of a checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoordinatorState {
    /// Origin of the run.
    pub origin: Origin,
    /// The last accepted step: window, iteration, start and end [s].
    pub step: (u64, u32, f64, f64),
    /// Position of the run in time.
    pub time: windows::WindowState,
    /// Counts of the run so far.
    pub counts: Counts,
    /// State of the coupling, as written by [`coupling::Coupling::save`].
    pub coupling: Vec<u8>,
    /// The last iterate sent to the consumers that close the loop.
    pub iterate: Vec<f64>,
    /// Length of `iterations.csv` [byte].
    pub table_bytes: u64,
    /// Length of `history.csv` [byte].
    pub history_bytes: u64,
    /// The series of field files so far.
    pub series: Vec<FileSeries>,
    /// Compression of the recording, if the run is recorded.
    #[serde(default)]
    pub recorded: Option<Compression>,
}

/// Name, length and CRC-64 of a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Part {
    name: String,
    bytes: u64,
    sum: u64,
}

/// The checkpoints of a result directory.
#[derive(Clone, Debug)]
pub struct Checkpoints {
    folder: PathBuf,
}

/// An intact checkpoint.
#[derive(Debug)]
pub struct Checkpoint {
    /// The coordinator's part.
    pub state: CoordinatorState,
    /// The folder with the other parts.
    pub folder: PathBuf,
}

/// A corrupt checkpoint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Corrupt {
    /// Name of its folder.
    pub name: String,
    /// Description of the damage.
    pub reason: String,
}

impl Checkpoints {
    /// Returns the checkpoints of this result directory.
    #[must_use]
    pub fn of(results: &Path) -> Self {
        Self { folder: results.join(FOLDER) }
    }

    /// Creates the folder for the parts of a checkpoint, after which window `next` is solved.
    ///
    /// # Errors
    /// The folder cannot be created, or a draft of the same name cannot be removed.
    pub fn begin(&self, next: u64) -> Result<PathBuf, RunError> {
        let draft = self.folder.join(format!("{next:06}.new"));
        let make = || {
            remove(&draft)?;
            fs::create_dir_all(&draft)
        };
        make().map_err(|error| file_failure(&draft, &error))?;
        Ok(draft)
    }

    /// Completes the checkpoint in the folder that [`Checkpoints::begin`] returned. Then removes
    /// all but the last [`KEPT`] checkpoints.
    ///
    /// # Errors
    /// A part cannot be read, or the disk cannot be written.
    pub fn complete(
        &self,
        draft: &Path,
        parts: &[String],
        state: &CoordinatorState,
    ) -> Result<(), RunError> {
        let complete = || {
            let parts = parts.iter().map(|name| seal(draft, name)).collect::<io::Result<_>>()?;
            write_own(&draft.join(OWN), &(parts, state))?;
            File::open(draft)?.sync_all()?;
            let folder = draft.with_extension("");
            // An existing checkpoint of this name is corrupt: a run would have resumed from an
            // intact one.
            remove(&folder)?;
            fs::rename(draft, folder)?;
            File::open(&self.folder)?.sync_all()
        };
        complete().map_err(|error| {
            // Half a checkpoint is useless, and may be what fills the disk.
            let _ = fs::remove_dir_all(draft);
            file_failure(draft, &error)
        })?;
        let mut names = self.names();
        while names.len() > KEPT {
            let oldest = self.folder.join(names.remove(0));
            remove(&oldest).map_err(|error| file_failure(&oldest, &error))?;
        }
        Ok(())
    }

    /// Returns the newest intact checkpoint, if any, and all corrupt checkpoints newer than it.
    #[must_use]
    pub fn newest(&self) -> (Option<Checkpoint>, Vec<Corrupt>) {
        let mut corrupt = Vec::new();
        for name in self.names().into_iter().rev() {
            match read(&self.folder.join(&name)) {
                Ok(checkpoint) => return (Some(checkpoint), corrupt),
                Err(reason) => corrupt.push(Corrupt { name, reason }),
            }
        }
        (None, corrupt)
    }

    /// Removes every checkpoint and every draft.
    ///
    /// # Errors
    /// A folder cannot be removed.
    pub fn clear(&self) -> Result<(), RunError> {
        let drafts = self
            .entries()
            .into_iter()
            .filter(|name| name.strip_suffix(".new").is_some_and(is_number));
        for name in self.names().into_iter().chain(drafts) {
            let folder = self.folder.join(name);
            remove(&folder).map_err(|error| file_failure(&folder, &error))?;
        }
        // A folder with other files in it stays.
        let _ = fs::remove_dir(&self.folder);
        Ok(())
    }

    fn entries(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        entries.filter_map(|entry| entry.file_name().into_string().ok()).collect()
    }

    /// The names of the checkpoints, oldest first.
    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> =
            self.entries().into_iter().filter(|name| is_number(name)).collect();
        names.sort_by_key(|name| (name.len(), name.clone()));
        names
    }
}

fn is_number(name: &str) -> bool {
    name.len() >= 6 && name.bytes().all(|byte| byte.is_ascii_digit())
}

/// Removes a checkpoint. The coordinator's part goes first, so that the remainder is not taken for
/// a checkpoint.
fn remove(folder: &Path) -> io::Result<()> {
    for step in [fs::remove_file(folder.join(OWN)), fs::remove_dir_all(folder)] {
        match step {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
    }
    Ok(())
}

/// Flushes a part to the disk and returns its length and checksum.
fn seal(folder: &Path, name: &str) -> io::Result<Part> {
    let file = File::open(folder.join(name))?;
    let (bytes, sum) = sum_of_stream(&file)?;
    file.sync_all()?;
    Ok(Part { name: name.to_owned(), bytes, sum })
}

fn write_own(path: &Path, content: &(Vec<Part>, &CoordinatorState)) -> io::Result<()> {
    fs::write(path, encode_own(content))?;
    File::open(path)?.sync_all()
}

fn encode_own(content: &(Vec<Part>, &CoordinatorState)) -> Vec<u8> {
    sealed::seal(MAGIC, content).expect("a state is plain data")
}

/// Inverts [`encode_own`]. Returns a description of the damage if the bytes are corrupt.
fn decode_own(bytes: &[u8]) -> Result<(Vec<Part>, CoordinatorState), String> {
    sealed::open(MAGIC, bytes).map_err(|broken| match broken {
        SealedFileError::Foreign => format!("{OWN} is not a checkpoint of this version"),
        SealedFileError::Sum(_) => format!("{OWN} is {broken}"),
        SealedFileError::Content(_) => format!("{OWN}: {broken}"),
    })
}

/// Reads a checkpoint. Returns a description of the damage if it is corrupt.
fn read(folder: &Path) -> Result<Checkpoint, String> {
    let failed = |name: &str| {
        let name = name.to_owned();
        move |error: io::Error| format!("{name}: {error}")
    };
    let own = fs::symlink_metadata(folder.join(OWN)).map_err(failed(OWN))?;
    if !own.is_file() || own.len() > binary::LONGEST as u64 {
        return Err(format!("{OWN} is not a checkpoint: {} bytes", own.len()));
    }
    let bytes = fs::read(folder.join(OWN)).map_err(failed(OWN))?;
    let (parts, state) = decode_own(&bytes)?;
    for part in &parts {
        if part.name.contains('/') || part.name == ".." {
            return Err(format!(
                "{OWN} names {:?}, which is not a file of a checkpoint",
                part.name
            ));
        }
        let path = folder.join(&part.name);
        let file = fs::symlink_metadata(&path).map_err(failed(&part.name))?;
        if !file.is_file() || file.len() != part.bytes {
            let (found, expected) = (file.len(), part.bytes);
            return Err(format!(
                "{} is corrupt: truncated to {found} of {expected} bytes",
                part.name
            ));
        }
        let found = File::open(path).and_then(sum_of_stream).map_err(failed(&part.name))?;
        if found != (part.bytes, part.sum) {
            return Err(format!("{} is corrupt: checksum mismatch", part.name));
        }
    }
    Ok(Checkpoint { state, folder: folder.to_owned() })
}

/// A path as bytes: a path need not be UTF-8.
mod raw_path {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use std::ffi::OsString;
    use std::os::unix::ffi::{OsStrExt, OsStringExt};
    use std::path::{Path, PathBuf};

    pub(super) fn serialize<S: Serializer>(path: &Path, to: S) -> Result<S::Ok, S::Error> {
        path.as_os_str().as_bytes().serialize(to)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<PathBuf, D::Error> {
        Ok(OsString::from_vec(Vec::deserialize(from)?).into())
    }
}

#[cfg(test)]
mod tests;
