//! Number of threads of each participant. Participants that compute at the same time share the
//! cores. The coordinator computes while all participants wait.

use coupling::settings::Scheme;
use std::num::NonZero;

/// Returns the number of threads of each of `count` participants, from `limit` threads or all cores
/// of the machine. In a serial scheme each participant gets all of them. In a parallel scheme each
/// gets an equal part, at least one; the first ones get the remainder.
pub(super) fn of_participants(limit: Option<usize>, scheme: Scheme, count: usize) -> Vec<usize> {
    let limit = of_coordinator(limit);
    let share = |index| limit / count + usize::from(index < limit % count);
    let threads = |index| if scheme.is_parallel() { share(index).max(1) } else { limit };
    (0..count).map(threads).collect()
}

/// Returns the number of threads of a process that computes alone: `limit`, or all cores of the
/// machine.
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
