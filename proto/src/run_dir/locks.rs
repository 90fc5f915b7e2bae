//! The files by which a run is known, and which of them somebody holds.

use rustix::fs::{FlockOperation, flock};
use std::fs::File;
use std::io;
use std::path::Path;

pub(super) const COORDINATOR_LOCK: &str = "coordinator.lock";
pub(super) const MEMBERS_LOCK: &str = "members.lock";
pub(super) const RUN_FILE: &str = "run.json";

/// Nobody holds a lock.
pub(super) fn is_free(lock: &Path) -> bool {
    match File::open(lock) {
        Ok(file) => flock(&file, FlockOperation::NonBlockingLockExclusive).is_ok(),
        Err(error) => error.kind() == io::ErrorKind::NotFound,
    }
}
