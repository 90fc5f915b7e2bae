//! Open files: the need of the processes of a run, compared with the limit of each process.
//!
//! A process without free file descriptors cannot map the segment of a message. Therefore the limit
//! is checked before any process starts, and raised as far as the user may raise it. The started
//! participants inherit it.
//!
//! The constants were counted in `/proc/PID/fd` for the shipped cases, and rounded up. A process
//! opens a few dozen files for itself and for common services of the run, and a few for each topic
//! that it publishes or subscribes to. The recorder subscribes to each topic once more.

use crate::error::{Failure, RunError};
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};

/// Number of files of a process itself and of the run.
const OWN: u64 = 48;
/// Number of files for commands, replies, progress and doorbell of a participant.
const PER_PARTICIPANT: u64 = 24;
/// Number of files for a topic.
const PER_TOPIC: u64 = 8;
/// Number of files for recording a topic.
const PER_RECORDED: u64 = 8;

/// Raises the limit of open files to the need of a process of the run. Returns whether it was
/// raised; processes started before keep the old limit.
///
/// # Errors
/// The hard limit is lower than the need.
pub(crate) fn provide(
    participants: usize,
    topics: usize,
    recorded: bool,
) -> Result<bool, RunError> {
    let per_topic = PER_TOPIC + if recorded { PER_RECORDED } else { 0 };
    let needed = OWN + PER_PARTICIPANT * participants as u64 + per_topic * topics as u64;
    let limit = getrlimit(Resource::Nofile);
    if limit.current.is_none_or(|current| current >= needed) {
        return Ok(false);
    }
    let raised = Rlimit { current: Some(needed), ..limit };
    if limit.maximum.is_none_or(|most| most >= needed) {
        let set = setrlimit(Resource::Nofile, raised).map_err(|error| refused(needed, error));
        return set.map(|()| true);
    }
    let most = limit.maximum.unwrap_or(u64::MAX);
    Err(refused(needed, format!("{most} are allowed")))
}

fn refused(needed: u64, why: impl std::fmt::Display) -> RunError {
    RunError::Failed(Failure {
        who: "the machine".to_owned(),
        when: "before anything was started".to_owned(),
        what: format!("a process of this run may open up to {needed} files: {why}"),
        fix: format!("raise the hard limit of open files (`ulimit -Hn`) to {needed}"),
    })
}
