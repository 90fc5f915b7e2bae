//! A recording that is watched, whichever file holds it at the moment.

use crate::index::Index;
use conformance::recording_file::newest_in;
use run::error::RunError;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Age of the last change from which a recording without an end counts as abandoned.
const ABANDONED: Duration = Duration::from_secs(10);

/// The newest recording of a result folder, or a recording by itself. Another run may put another
/// recording in its place, or remove it.
pub(crate) struct WatchedRecording {
    /// Result folder or recording, as given.
    given: PathBuf,
    file: Option<PathBuf>,
    index: Option<Index>,
    /// Number of recordings opened and closed so far.
    changes: u64,
    /// Whether the folder or the recording has been removed.
    gone: bool,
    /// Reason why the recording is not read, or not read further.
    trouble: Option<String>,
}

impl WatchedRecording {
    /// Opens the recording of a result folder, which need not have one yet, or a recording.
    ///
    /// # Errors
    /// A recording that is given by itself cannot be read.
    pub(crate) fn open(given: &Path) -> Result<Self, RunError> {
        let index = match given.is_dir() {
            true => None,
            false => Some(Index::open(given)?),
        };
        let file = index.as_ref().map(|_| given.to_owned());
        let given = given.to_owned();
        let mut recording = Self { given, file, index, changes: 0, gone: false, trouble: None };
        recording.follow();
        Ok(recording)
    }

    /// Opens the recording that has taken the place of the one that was read, and closes one that
    /// has been removed from its folder. If the place itself is gone, what was read stays.
    pub(crate) fn follow(&mut self) {
        let found = fs::metadata(&self.given);
        self.gone = found.is_err();
        let newest = match found {
            Err(_) => return,
            Ok(found) if found.is_dir() => newest_in(&self.given),
            Ok(_) => Some(self.given.clone()),
        };
        let is_read = match (&newest, &self.index) {
            (Some(path), Some(index)) => index.is_of(path),
            (found, index) => found.is_none() && index.is_none(),
        };
        if is_read {
            return;
        }
        let had = self.index.is_some();
        let opened = newest.as_deref().map(Index::open).transpose();
        self.trouble = opened.as_ref().err().map(ToString::to_string);
        self.index = opened.ok().flatten();
        self.changes += u64::from(had || self.index.is_some());
        self.file = newest;
    }

    /// Reads the next chunk. Returns whether there was one.
    pub(crate) fn advance(&mut self) -> bool {
        let Some(index) = &mut self.index else { return false };
        index.advance().unwrap_or_else(|error| {
            self.trouble.get_or_insert(error.to_string());
            false
        })
    }

    /// Returns the index, once the head of the recording is written.
    pub(crate) fn index(&self) -> Option<&Index> {
        self.index.as_ref()
    }

    /// Returns the index for reading samples.
    pub(crate) fn index_mut(&mut self) -> Option<&mut Index> {
        self.index.as_mut()
    }

    /// Returns a number that changes when another recording is read.
    pub(crate) fn changes(&self) -> u64 {
        self.changes
    }

    /// Returns a remark about the recording.
    pub(crate) fn remark(&self) -> Option<String> {
        if self.gone {
            let shown = self.given.display();
            return Some(format!("{shown} has been removed; the page shows what was read before"));
        }
        let full = || "the recording has more samples and steps than are shown".to_owned();
        let is_full = self.index.as_ref().is_some_and(Index::is_full);
        self.trouble.clone().or_else(|| is_full.then(full))
    }

    /// Returns the part of the recording that was read \[-\].
    pub(crate) fn part_read(&self) -> f64 {
        let length = self.file.as_deref().and_then(|path| fs::metadata(path).ok());
        let length = length.map_or(0, |file| file.len()).max(1);
        self.index.as_ref().map_or(1.0, |index| index.bytes() as f64 / length as f64)
    }

    /// Returns whether the recording has no end, and was written to in the last seconds.
    pub(crate) fn is_growing(&self) -> bool {
        let changed =
            self.file.as_deref().and_then(|path| fs::metadata(path).ok()?.modified().ok());
        let age = changed.and_then(|changed| changed.elapsed().ok());
        let is_open = self.index.as_ref().is_some_and(|index| !index.is_complete());
        is_open && age.is_some_and(|age| age < ABANDONED)
    }
}
