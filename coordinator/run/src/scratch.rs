//! Folders for results that nobody keeps.
//!
//! A process that is killed removes nothing. Therefore each folder holds a locked file, and whoever
//! makes the next folder removes those whose lock is free: their process has ended.

use crate::error::{RunError, file_failure};
use rustix::fs::{FlockOperation, OFlags, flock};
use std::fs::{self, File};
use std::io;
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;

/// Begins the name of every such folder.
const PREFIX: &str = "cosim-scratch-";
/// The file that the owner of a folder has locked.
const LOCK: &str = "lock";
/// The folder for the user of a folder.
const CONTENT: &str = "content";
/// Names of such folders in versions before 0.3, which had no lock.
const WITHOUT_LOCK: [&str; 2] = ["cosim-study-", "cosim-drive-"];
/// Age from which a folder without a lock has no owner.
const AGE: Duration = Duration::from_secs(7 * 24 * 3600);

/// An empty folder below the temporary directory; it is removed when this is dropped.
#[derive(Debug)]
pub struct Scratch {
    /// The empty folder, beside the lock.
    path: PathBuf,
    _folder: TempDir,
    _lock: File,
}

impl Scratch {
    /// Makes a folder, and removes those that killed processes have left.
    ///
    /// # Errors
    /// The file system.
    pub fn new() -> Result<Self, RunError> {
        let place = std::env::temp_dir();
        Self::within(&place).map_err(|error| file_failure(&place, &error))
    }

    fn within(place: &Path) -> io::Result<Self> {
        remove_abandoned(place);
        loop {
            let folder = tempfile::Builder::new().prefix(PREFIX).tempdir_in(place)?;
            let lock = File::create_new(folder.path().join(LOCK))?;
            let held = flock(&lock, FlockOperation::NonBlockingLockExclusive).is_ok();
            // Another process may have met the folder before the lock was held, and removes it.
            if held && folder.path().join(LOCK).exists() {
                let path = folder.path().join(CONTENT);
                fs::create_dir(&path)?;
                return Ok(Self { path, _folder: folder, _lock: lock });
            }
        }
    }

    /// Path of the folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Removes the folders of ours whose owner has ended; one that cannot be removed stays.
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

/// A folder, no link to one, of this user.
fn is_ours(path: &Path) -> bool {
    let user = rustix::process::getuid().as_raw();
    path.symlink_metadata().is_ok_and(|found| found.is_dir() && found.uid() == user)
}

/// Takes the lock of a folder whose owner has ended; `None` if it has an owner. The lock has to stay
/// held while the folder is removed: a process that has just made the folder would else lock it, and
/// then lose it. A folder without a lock file stands for its own lock.
fn abandoned(folder: &Path) -> Option<File> {
    let no_link = OFlags::NOFOLLOW.bits().cast_signed();
    match File::options().read(true).custom_flags(no_link).open(folder.join(LOCK)) {
        Ok(lock) => flock(&lock, FlockOperation::NonBlockingLockExclusive).is_ok().then_some(lock),
        // It is being made, or was made by an earlier version.
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let changed = folder.symlink_metadata().and_then(|found| found.modified());
            let is_old = changed.is_ok_and(|time| time.elapsed().is_ok_and(|age| age > AGE));
            is_old.then(|| File::open(folder).ok())?
        }
        Err(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder whose owner lives stays, one whose lock is free goes, and nothing else is touched.
    #[test]
    fn only_abandoned_folders_are_removed() {
        let place = tempfile::tempdir().unwrap();
        let living = Scratch::within(place.path()).unwrap();
        let killed = Scratch::within(place.path()).unwrap();
        // A killed process leaves the folder and a lock that nobody holds.
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

    /// The lock of a folder is held while it is removed, so a process that has just made it notices,
    /// and makes another.
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
