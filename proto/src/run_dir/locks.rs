//! Names of the files in a run's folder, and the state of its locks.

use crate::lock_file::LockFile;
use std::fs::File;
use std::io;
use std::path::Path;

pub(super) const COORDINATOR_LOCK: &str = "coordinator.lock";
pub(super) const MEMBERS_LOCK: &str = "members.lock";
pub(super) const RUN_FILE: &str = "run.json";

/// Returns true if no process holds a lock.
pub(super) fn is_free(lock: &Path) -> bool {
    match File::open(lock) {
        Ok(file) => LockFile::from(file).try_lock().is_ok(),
        Err(error) => error.kind() == io::ErrorKind::NotFound,
    }
}
