//! How a participant's life ends, and what is left of it.

use crate::conform::fault::{Fault, broken, late};
use proto::run_dir::{RunDir, RunInfo};
use run::peers::LEAVE;
use run::supervise::Supervisor;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A participant whose coordinator is dead.
pub(in crate::conform) struct Abandoned {
    pub(super) supervisor: Arc<Supervisor>,
    pub(super) info: RunInfo,
    pub(super) since: Instant,
}

impl Abandoned {
    /// It ends in time and takes everything with it; how long that took.
    pub(in crate::conform) fn ends(self) -> Result<Duration, Fault> {
        let gone = self.supervisor.wait_for_exits(LEAVE);
        let took = self.since.elapsed();
        drop(self.supervisor);
        let left = nothing_left(&self.info);
        if left.is_err() {
            // A new run clears away what dead ones have left.
            drop(RunDir::create(&[]));
        }
        match gone {
            true => left.map(|()| took),
            false => late(format!("it still runs {:.0} s later", LEAVE.as_secs_f64())),
        }
    }
}

/// No folder and no shared memory of the run is left.
pub(super) fn nothing_left(info: &RunInfo) -> Result<(), Fault> {
    if info.folder.exists() {
        return broken(format!("the run's folder {} is left behind", info.folder.display()));
    }
    let entries = std::fs::read_dir("/dev/shm").into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let left: Vec<String> = names.filter(|name| name.starts_with(&info.prefix)).collect();
    match left.as_slice() {
        [] => Ok(()),
        names => broken(format!("left in /dev/shm: {}", names.join(", "))),
    }
}
