//! Duration of a wait, measured in time during which the waiting process itself ran.
//!
//! A whole run may be frozen and thawed later (a paused container, a suspended machine, a
//! debugger). The clock goes on meanwhile, although no participant was silent or late. Therefore a
//! gap between two looks that is longer than [`LOOK`] counts as [`LOOK`].

use proto::transport::Doorbell;
use std::time::{Duration, Instant};

/// Longest time that counts between two looks. A waiting process looks every [`Doorbell::NAP`].
const LOOK: Duration = Doorbell::NAP.saturating_mul(5);

/// Duration of a wait, updated at every poll.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patience {
    waited: Duration,
    looked: Instant,
}

impl Patience {
    /// Starts a wait.
    pub(super) fn new() -> Self {
        Self { waited: Duration::ZERO, looked: Instant::now() }
    }

    /// Returns the duration of the wait so far.
    pub(super) fn waited(&mut self) -> Duration {
        self.waited_until(Instant::now())
    }

    fn waited_until(&mut self, now: Instant) -> Duration {
        self.waited += now.saturating_duration_since(self.looked).min(LOOK);
        self.looked = now;
        self.waited
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_between_two_looks_counts_as_one_look() {
        let mut patience = Patience::new();
        let start = patience.looked;
        let nap = |count: u32| start + Doorbell::NAP * count;
        assert_eq!(patience.waited_until(nap(1)), Doorbell::NAP);
        assert_eq!(patience.waited_until(nap(2)), 2 * Doorbell::NAP);
        let thawed = nap(2) + Duration::from_secs(3600);
        assert_eq!(patience.waited_until(thawed), 2 * Doorbell::NAP + LOOK);
        assert_eq!(patience.waited_until(thawed + Doorbell::NAP), 3 * Doorbell::NAP + LOOK);
    }
}
