//! Folders for temporary results.
//!
//! A killed process removes nothing. Therefore each folder holds a locked file. The creator of the
//! next folder removes all folders whose lock is free, because their process has ended.

use crate::error::{RunError, file_failure};
use proto::lock_file::LockFile;
use rustix::fs::OFlags;
use std::fs::{self, File};
use std::io;
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;

/// Beginning of the name of every such folder.
const PREFIX: &str = "cosim-scratch-";
/// File that the owner of a folder has locked.
const LOCK: &str = "lock";
/// Subfolder for the results.
const CONTENT: &str = "content";
/// Beginnings of the names in versions before 0.3, which had no lock.
const WITHOUT_LOCK: [&str; 2] = ["cosim-study-", "cosim-drive-"];
/// Age from which a folder without a lock counts as abandoned.
const AGE: Duration = Duration::from_secs(7 * 24 * 3600);

/// An empty folder below the temporary directory. Dropping this removes the folder.
#[derive(Debug)]
pub struct Scratch {
    /// Path of the empty folder, which lies beside the lock.
    path: PathBuf,
    _folder: TempDir,
    _lock: LockFile,
}

impl Scratch {
    /// Creates a folder, and removes the folders that killed processes have left.
    ///
    /// # Errors
    /// The folder cannot be created.
    pub fn new() -> Result<Self, RunError> {
        let place = std::env::temp_dir();
        Self::within(&place).map_err(|error| file_failure(&place, &error))
    }

    fn within(place: &Path) -> io::Result<Self> {
        remove_abandoned(place);
        loop {
            let folder = tempfile::Builder::new().prefix(PREFIX).tempdir_in(place)?;
            let lock = LockFile::from(File::create_new(folder.path().join(LOCK))?);
            let held = lock.try_lock().is_ok();
            // Another process may have found the folder before the lock was held, and removes it.
            if held && folder.path().join(LOCK).exists() {
                let path = folder.path().join(CONTENT);
                fs::create_dir(&path)?;
                return Ok(Self { path, _folder: folder, _lock: lock });
            }
        }
    }

    /// Returns the path of the folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Removes the user's folders whose owner has ended. A folder that cannot be removed stays.
fn remove_abandoned(place: &Path) {
    for entry in fs::read_dir(place).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let begins = |prefix: &&str| name.starts_with(prefix);
        let known = std::iter::once(&PREFIX).chain(&WITHOUT_LOCK).any(begins);
        if known
            && is_ours(&entry.path())
            && let Some(_held) = abandoned(&entry.path())
        {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

/// Returns whether this is a folder of this user, and not a link.
fn is_ours(path: &Path) -> bool {
    let user = rustix::process::getuid().as_raw();
    path.symlink_metadata().is_ok_and(|found| found.is_dir() && found.uid() == user)
}

/// Takes the lock of a folder whose owner has ended; `None` if the owner lives. The lock must be
/// held while the folder is removed: otherwise a process that has just made the folder could lock
/// it, and then lose it. A folder without a lock file serves as its own lock.
fn abandoned(folder: &Path) -> Option<LockFile> {
    let no_link = OFlags::NOFOLLOW.bits().cast_signed();
    match File::options().read(true).custom_flags(no_link).open(folder.join(LOCK)) {
        Ok(lock) => Some(LockFile::from(lock)).filter(|lock| lock.try_lock().is_ok()),
        // The folder is being made, or was made by an earlier version.
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let changed = folder.symlink_metadata().and_then(|found| found.modified());
            let is_old = changed.is_ok_and(|time| time.elapsed().is_ok_and(|age| age > AGE));
            is_old.then(|| File::open(folder).ok())?.map(LockFile::from)
        }
        Err(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder with a living owner stays, one with a free lock is removed, and all others stay
    /// untouched.
    #[test]
    fn only_abandoned_folders_are_removed() {
        let place = tempfile::tempdir().unwrap();
        let living = Scratch::within(place.path()).unwrap();
        let killed = Scratch::within(place.path()).unwrap();
        // A killed process leaves the folder with a free lock.
        assert_eq!(fs::read_dir(killed.path()).unwrap().count(), 0);
        fs::write(killed.path().join("results"), "x").unwrap();
        let Scratch { _folder: folder, _lock: lock, .. } = killed;
        let left = folder.keep();
        drop(lock);
        let fresh = place.path().join(format!("{PREFIX}being-made"));
        let other = place.path().join("other");
        for folder in [&fresh, &other] {
            fs::create_dir(folder).unwrap();
        }
        std::os::unix::fs::symlink(&other, place.path().join(format!("{PREFIX}link"))).unwrap();
        let next = Scratch::within(place.path()).unwrap();
        assert!(!left.exists());
        assert!(living.path().exists() && next.path().exists());
        assert!(fresh.exists() && other.exists());
        let path = next.path().to_owned();
        drop(next);
        assert!(!path.exists());
    }

    /// The lock of a folder is held while the folder is removed. A process that has just made it
    /// notices this, and makes another.
    #[test]
    fn a_folder_that_is_removed_is_nobody_elses() {
        let place = tempfile::tempdir().unwrap();
        let Scratch { _folder: folder, _lock: lock, .. } = Scratch::within(place.path()).unwrap();
        assert!(abandoned(folder.path()).is_none(), "its owner lives");
        drop(lock);
        let held = abandoned(folder.path()).unwrap();
        assert!(abandoned(folder.path()).is_none(), "it is being removed");
        drop(held);
        assert!(abandoned(folder.path()).is_some());
    }
}
