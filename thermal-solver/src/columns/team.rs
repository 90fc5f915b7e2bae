//! Rows of a grid, computed on several threads.
//!
//! No row depends on another one, and each is computed as on one thread, in memory of the thread's own:
//! results are the same to the bit, whatever the number of threads and whoever takes which rows.
//!
//! Threads are started for a sweep and end with it, which costs up to 0.2 ms on a busy machine. A sweep therefore
//! gets no more of them than it has [`WORTH`] operations for each.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

/// Rows that a thread takes at once.
pub const ROWS: usize = 4;

/// Multiply-adds that are worth a thread of their own: 0.15 ms.
pub const WORTH: u64 = 1_500_000;

/// What each thread computes in.
pub struct Team<S>(Vec<S>);

impl<S: Clone + Send> Team<S> {
    /// As many threads, at least one, with copies of a scratch.
    #[must_use]
    pub fn new(threads: usize, scratch: S) -> Self {
        Self(vec![scratch; threads.max(1)])
    }
}

impl<S: Send> Team<S> {
    /// Computes all items, which come to about so many operations, and adds up the work that `each`
    /// reports. On one thread nothing is allocated.
    pub fn sweep<T>(
        &mut self,
        operations: u64,
        items: impl Iterator<Item = T> + Send,
        each: impl Fn(&mut S, T) -> u64 + Sync,
    ) -> u64 {
        let worth = usize::try_from(operations / WORTH).unwrap_or(usize::MAX);
        let threads = worth.clamp(1, self.0.len());
        let (own, others) = self.0[..threads].split_first_mut().expect("there is at least one");
        if others.is_empty() {
            return items.map(|item| each(own, item)).sum();
        }
        let (items, work) = (Mutex::new(items), AtomicU64::new(0));
        let next = || items.lock().unwrap_or_else(PoisonError::into_inner).next();
        let compute = |scratch: &mut S| {
            while let Some(item) = next() {
                work.fetch_add(each(scratch, item), Ordering::Relaxed);
            }
        };
        thread::scope(|scope| {
            for other in others {
                scope.spawn(|| compute(other));
            }
            compute(own);
        });
        work.into_inner()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_computed_once_on_any_number_of_threads() {
        for threads in [0, 1, 2, 7] {
            let mut values = vec![0_u64; 1000];
            let items = values.chunks_mut(ROWS).enumerate();
            let work = Team::new(threads, 0_u64).sweep(20 * WORTH, items, |_, (at, piece)| {
                piece.iter_mut().for_each(|value| *value += at as u64);
                piece.len() as u64
            });
            assert_eq!(work, 1000);
            assert!(values.iter().enumerate().all(|(at, value)| *value == (at / ROWS) as u64));
        }
    }
}
