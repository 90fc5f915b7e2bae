//! A run that somebody watches: it writes its newest fields at every look.
//!
//! Whoever watches touches the file [`LOOK`] in the result folder. The run looks at the age of this
//! file a few times a second. Without the file it does nothing else, and costs nothing.

use crate::error::RunError;
use crate::results::claim::MARKER;
use crate::results::dir::Dir;
use contract::input_file;
use proto::lock_file::LockFile;
use rustix::fs::OFlags;
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// File that is touched by whoever watches.
pub const LOOK: &str = ".watched";

/// Shortest time between two looks at the file, and between two outputs of fields.
const PAUSE: Duration = Duration::from_millis(700);
/// Age of the file from which nobody watches any more.
const OLD: Duration = Duration::from_secs(3);

/// Notes that somebody watches the run of a result folder. A link, a pipe or a device in the place
/// of the file is left alone. Failure has no consequence but older fields on the page.
pub fn look(folder: &Path) {
    let file = Dir::open(folder).and_then(|dir| dir.file(LOOK, OFlags::WRONLY | OFlags::CREATE));
    let is_regular = |file: &File| file.metadata().is_ok_and(|found| found.is_file());
    if let Ok(file) = file.as_ref().map_err(drop)
        && is_regular(file)
    {
        let _ = file.set_modified(SystemTime::now());
    }
}

/// Returns whether a run writes into a result folder: it holds the lock of the marker.
#[must_use]
pub fn is_running(folder: &Path) -> bool {
    let Ok(marker) = input_file::open(&folder.join(MARKER)).map(LockFile::from) else {
        return false;
    };
    matches!(marker.try_lock_shared(), Err(TryLockError::WouldBlock))
}

/// Whether somebody watches a run, asked in every window.
#[derive(Debug)]
pub(crate) struct Watcher {
    file: PathBuf,
    asked: Instant,
    stopped: bool,
}

impl Watcher {
    /// Returns the watcher of a result folder.
    pub(crate) fn of(folder: &Path) -> Self {
        Self { file: folder.join(LOOK), asked: Instant::now(), stopped: false }
    }

    /// Returns whether fields are to be written now because somebody watches.
    pub(crate) fn is_due(&mut self) -> bool {
        if self.stopped || self.asked.elapsed() < PAUSE {
            return false;
        }
        self.asked = Instant::now();
        let changed = fs::metadata(&self.file).and_then(|file| file.modified());
        changed.is_ok_and(|changed| changed.elapsed().is_ok_and(|age| age < OLD))
    }

    /// Writes no fields any more, because they cannot be written.
    pub(crate) fn stop(&mut self, error: &RunError) {
        tracing::warn!("the page of `coordinator watch` gets no newer fields: {error}");
        self.stopped = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rustix::fs::{CWD, FileType, Mode, mknodat};
    use std::os::unix::fs::symlink;

    #[test]
    fn fields_are_due_while_somebody_looks() {
        let folder = tempfile::tempdir().unwrap();
        let mut watcher = Watcher::of(folder.path());
        let due = |watcher: &mut Watcher| {
            watcher.asked = Instant::now() - 2 * PAUSE;
            watcher.is_due()
        };
        assert!(!due(&mut watcher), "nobody has looked");
        look(folder.path());
        assert!(due(&mut watcher));
        assert!(!watcher.is_due(), "fields were due a moment ago");
        let long_ago = SystemTime::now() - 2 * OLD;
        File::open(folder.path().join(LOOK)).unwrap().set_modified(long_ago).unwrap();
        assert!(!due(&mut watcher), "the last look is long ago");
    }

    /// The file is neither made nor touched through a link, and a pipe is not waited for.
    #[test]
    fn only_a_regular_file_is_touched() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        symlink(at("target"), at(LOOK)).unwrap();
        look(folder.path());
        assert!(!at("target").exists());
        fs::remove_file(at(LOOK)).unwrap();
        mknodat(CWD, at(LOOK), FileType::Fifo, Mode::from_raw_mode(0o600), 0).unwrap();
        look(folder.path());
    }

    #[test]
    fn a_run_holds_its_folder() {
        let folder = tempfile::tempdir().unwrap();
        assert!(!is_running(folder.path()));
        let marker = LockFile::from(File::create(folder.path().join(MARKER)).unwrap());
        assert!(!is_running(folder.path()));
        marker.try_lock().unwrap();
        assert!(is_running(folder.path()));
    }
}
