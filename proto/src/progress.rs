//! How far long work is, from the model that does it to the heart that reports it.

use crate::message::{Label, ProgressReport};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Where a model says how far it is. Clones are the same place; any thread may report, as often as it
/// likes: nothing is allocated and nobody is waited for but a copy of a few words.
///
/// The heartbeat carries the newest report. Whenever it differs from the one before, the coordinator
/// gives the command that is worked on its whole deadline again.
#[derive(Clone, Debug, Default)]
pub struct Progress(Arc<Mutex<ProgressReport>>);

impl Progress {
    /// `done` of `of` is done, in any measure; `of` is 0 if nobody knows. `what` is being done, in
    /// an ASCII word of at most 31 letters ("factorising").
    pub fn report(&self, done: u64, of: u64, what: &str) {
        let what = Label::new(what);
        let mut now = self.lock();
        *now = ProgressReport { done, of, what, ..*now };
    }

    /// Work on the command with this number begins.
    pub(crate) fn begin(&self, sequence: u64) {
        *self.lock() = ProgressReport { sequence, ..ProgressReport::default() };
    }

    /// The newest report on the command that is worked on; `None` if the model said nothing.
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
