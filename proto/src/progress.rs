//! Progress of long work, from the model to the heartbeat.

use crate::message::{Label, ProgressReport};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Progress of a model. Clones share the report; any thread may report as often as needed. A report
/// allocates nothing and only copies a few words under a lock.
///
/// The heartbeat carries the newest report. Whenever the report changes, the coordinator restarts
/// the deadline of the current command.
#[derive(Clone, Debug, Default)]
pub struct Progress(Arc<Mutex<ProgressReport>>);

impl Progress {
    /// Reports that `done` of `of` units of work are done; `of` is 0 if unknown. `what` names the
    /// activity in one ASCII word of at most 31 letters ("factorising").
    pub fn report(&self, done: u64, of: u64, what: &str) {
        let what = Label::new(what);
        let mut now = self.lock();
        *now = ProgressReport { done, of, what, ..*now };
    }

    /// Begins the command with this number.
    pub(crate) fn begin(&self, sequence: u64) {
        *self.lock() = ProgressReport { sequence, ..ProgressReport::default() };
    }

    /// Returns the newest report on the current command; `None` if the model has not reported.
    #[must_use]
    pub fn newest(&self) -> Option<ProgressReport> {
        let now = *self.lock();
        let silent = ProgressReport { sequence: now.sequence, ..ProgressReport::default() };
        (now != silent).then_some(now)
    }

    fn lock(&self) -> MutexGuard<'_, ProgressReport> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_holds_until_the_next_command() {
        let progress = Progress::default();
        let model = progress.clone();
        progress.begin(4);
        assert_eq!(progress.newest(), None);
        model.report(37, 60, "factorising");
        let what = Label::new("factorising");
        let report = ProgressReport { sequence: 4, done: 37, of: 60, what };
        assert_eq!(progress.newest(), Some(report));
        progress.begin(5);
        assert_eq!(progress.newest(), None);
    }
}
