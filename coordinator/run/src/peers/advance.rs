//! Progress of a participant with its current command, as counted by the participant.

use contract::message::ProgressReport;
use std::time::{Duration, Instant};

/// Newest progress report, with the pace since the count began.
#[derive(Clone, Copy, Debug)]
pub(super) struct Advance {
    newest: ProgressReport,
    at: Instant,
    /// Count and time of the first report on this work.
    first: (u64, Instant),
}

impl Advance {
    /// Returns the progress after a report; `None` if the report is not new. Work under a new label
    /// or with a new total starts a new pace.
    pub(super) fn after(before: Option<Self>, newest: ProgressReport, at: Instant) -> Option<Self> {
        match before {
            Some(before) if before.newest == newest => None,
            Some(Self { newest: last, first, .. })
                if (last.of, last.what) == (newest.of, newest.what) && last.done <= newest.done =>
            {
                Some(Self { newest, at, first })
            }
            _ => Some(Self { newest, at, first: (newest.done, at) }),
        }
    }

    pub(super) fn newest(&self) -> ProgressReport {
        self.newest
    }

    /// Returns the remaining time at the pace so far.
    pub(super) fn left(&self) -> Option<Duration> {
        let (before, since) = self.first;
        let left = self.newest.of.checked_sub(self.newest.done)?;
        let pace = (self.at - since).as_secs_f64() / (self.newest.done - before) as f64;
        Duration::try_from_secs_f64(left as f64 * pace).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::message::Label;

    #[test]
    fn what_is_left_follows_the_pace() {
        let report =
            |done, what: &str| ProgressReport { sequence: 3, done, of: 60, what: Label::new(what) };
        let start = Instant::now();
        let at = |seconds| start + Duration::from_secs(seconds);
        let first = Advance::after(None, report(10, "factorising"), start).unwrap();
        assert_eq!(first.left(), None, "one report has no pace");
        assert!(Advance::after(Some(first), report(10, "factorising"), at(1)).is_none());
        let second = Advance::after(Some(first), report(40, "factorising"), at(15)).unwrap();
        assert_eq!(second.left(), Some(Duration::from_secs(10)));
        let other = Advance::after(Some(second), report(40, "solving"), at(16)).unwrap();
        assert_eq!((other.left(), other.newest().done), (None, 40));
        let unknown = ProgressReport { of: 0, ..report(9, "x") };
        assert_eq!(Advance::after(None, unknown, start).unwrap().left(), None);
    }
}
