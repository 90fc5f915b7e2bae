//! How many threads each participant may compute on: those that compute at the same time share what
//! there is. The coordinator computes while they all wait.

use coupling::settings::Scheme;
use std::num::NonZero;

/// The threads of each of `count` participants. Of `limit` threads, or as many as the machine has
/// cores: all to each where one computes after the other; where all compute at once, equal parts, what
/// is over to the first ones, and one at least.
pub(super) fn of_participants(limit: Option<usize>, scheme: Scheme, count: usize) -> Vec<usize> {
    let limit = of_coordinator(limit);
    let share = |index| limit / count + usize::from(index < limit % count);
    let threads = |index| if scheme.is_parallel() { share(index).max(1) } else { limit };
    (0..count).map(threads).collect()
}

/// The threads of what computes by itself: `limit`, or as many as the machine has cores.
pub(super) fn of_coordinator(limit: Option<usize>) -> usize {
    let cores = || std::thread::available_parallelism().map_or(1, NonZero::get);
    limit.unwrap_or_else(cores)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn those_that_compute_at_once_share() {
        let (serial, parallel) = (Scheme::SerialImplicit, Scheme::ParallelExplicit);
        assert_eq!(of_participants(Some(5), serial, 2), [5, 5]);
        assert_eq!(of_participants(Some(5), parallel, 2), [3, 2]);
        assert_eq!(of_participants(Some(1), parallel, 3), [1, 1, 1]);
        assert!(of_participants(None, serial, 1)[0] >= 1);
    }
}
