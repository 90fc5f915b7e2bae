//! How long a wait has lasted, by the time in which the waiting process itself ran.
//!
//! A run may be frozen as a whole and thawed later (a container's pause, a suspended machine, a
//! debugger). The clock goes on meanwhile, but nobody was silent and nobody was late: a gap between
//! two looks that is longer than [`LOOK`] counts as [`LOOK`].

use proto::transport::Doorbell;
use std::time::{Duration, Instant};

/// Most that the time between two looks counts. A waiting process looks every [`Doorbell::NAP`].
const LOOK: Duration = Doorbell::NAP.saturating_mul(5);

/// The time a wait has lasted; looked at on every poll.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patience {
    waited: Duration,
    looked: Instant,
}

impl Patience {
    /// A wait that begins now.
    pub(super) fn new() -> Self {
        Self { waited: Duration::ZERO, looked: Instant::now() }
    }

    /// How long the wait has lasted.
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
