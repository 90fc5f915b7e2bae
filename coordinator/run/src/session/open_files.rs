//! Open files: the need of the processes of a run, compared with the limit of each process.
//!
//! A process without free file descriptors cannot map the segment of a message. Therefore the limit
//! is checked before any process starts, and raised as far as the user may raise it. The started
//! participants inherit it. The coordinator itself needs as many files as all of its runs together:
//! a study has one run in each of its fleets.
//!
//! The constants were counted in `/proc/PID/fd` for the shipped cases, and rounded up. A process
//! opens a few dozen files for itself and for common services of the run, and a few for each topic
//! that it publishes or subscribes to. The recorder subscribes to each topic once more.

use crate::error::{Failure, RunError};
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use std::sync::{Mutex, PoisonError};

/// Number of files of a process itself and of the run.
const OWN: u64 = 48;
/// Number of files for commands, replies, progress and doorbell of a participant.
const PER_PARTICIPANT: u64 = 24;
/// Number of files for a topic.
const PER_TOPIC: u64 = 8;
/// Number of files for recording a topic.
const PER_RECORDED: u64 = 8;

/// Need of all runs of this process. The lock is held while the limit is raised, so that no thread
/// lowers it again.
static TOTAL: Mutex<u64> = Mutex::new(0);

/// Need of a fleet, counted in the total until it is dropped: participants may stay after a run.
#[derive(Debug)]
pub(crate) struct OpenFiles {
    total: &'static Mutex<u64>,
    own: u64,
}

impl Default for OpenFiles {
    fn default() -> Self {
        Self { total: &TOTAL, own: 0 }
    }
}

impl OpenFiles {
    /// Raises the limit of open files to the need of the runs of this process. Returns whether it
    /// was too low for a participant of this run; processes started before keep the old limit.
    ///
    /// # Errors
    /// The hard limit is lower than the need.
    pub(crate) fn provide(
        &mut self,
        participants: usize,
        topics: usize,
        recorded: bool,
    ) -> Result<bool, RunError> {
        let per_topic = PER_TOPIC + if recorded { PER_RECORDED } else { 0 };
        let needed = OWN + PER_PARTICIPANT * participants as u64 + per_topic * topics as u64;
        self.replace(needed, |total| raise(needed, total))
    }

    /// Replaces the need of this fleet, and calls `raise` with the need of all.
    fn replace<T>(&mut self, needed: u64, raise: impl FnOnce(u64) -> T) -> T {
        let mut total = self.total.lock().unwrap_or_else(PoisonError::into_inner);
        *total = *total + needed - self.own;
        self.own = needed;
        raise(*total)
    }
}

impl Drop for OpenFiles {
    fn drop(&mut self) {
        self.replace(0, |_| ());
    }
}

/// Raises the limit to `total` files. Returns whether it was below `needed`.
fn raise(needed: u64, total: u64) -> Result<bool, RunError> {
    let limit = getrlimit(Resource::Nofile);
    let Some(current) = limit.current.filter(|current| *current < total) else {
        return Ok(false);
    };
    if let Some(most) = limit.maximum.filter(|most| *most < total) {
        return Err(refused(needed, total, format!("{most} are allowed")));
    }
    let raised = Rlimit { current: Some(total), ..limit };
    setrlimit(Resource::Nofile, raised).map_err(|error| refused(needed, total, error))?;
    Ok(current < needed)
}

fn refused(needed: u64, total: u64, why: impl std::fmt::Display) -> RunError {
    let (what, fewer) = match total == needed {
        true => (format!("a process of this run may open up to {needed} files"), ""),
        false => {
            let what = format!("the runs at the same time may open up to {total} files");
            (what, ", or run fewer at the same time (--jobs)")
        }
    };
    RunError::Failed(Failure {
        who: "the machine".to_owned(),
        when: "before anything was started".to_owned(),
        what: format!("{what}: {why}"),
        fix: format!("raise the hard limit of open files (`ulimit -Hn`) to {total}{fewer}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_needs_of_all_fleets_add_up_until_they_end() {
        static ALL: Mutex<u64> = Mutex::new(0);
        let fleet = || OpenFiles { total: &ALL, own: 0 };
        let total = |need: &mut OpenFiles, own| need.replace(own, |total| total);
        let (mut here, mut other) = (fleet(), fleet());
        assert_eq!(total(&mut here, 200), 200);
        assert_eq!(total(&mut other, 300), 500);
        drop(other);
        assert_eq!(total(&mut here, 250), 250, "the other fleet has ended");
    }
}
