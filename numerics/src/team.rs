//! Independent pieces of work, computed on several threads.
//!
//! The pieces are independent, and each is computed as on one thread, in the thread's own memory.
//! Results are therefore bit-identical, whatever the number of threads and the distribution of
//! pieces.
//!
//! The threads belong to a pool, which starts on first use and stays. Handing out work costs about
//! ten microseconds, so a sweep uses at most one thread per [`WORTH`] operations. Nested work uses
//! only the threads left to its piece: half of them in [`both`], one in a sweep.

use rayon::{ThreadPool, ThreadPoolBuilder};
use std::cell::Cell;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Number of rows that a thread takes at once.
pub const ROWS: usize = 4;

/// Number of multiply-adds that justify a thread of its own: 0.15 ms.
pub const WORTH: u64 = 1_500_000;

/// Maximum number of computing threads of the process.
static LIMIT: AtomicUsize = AtomicUsize::new(1);

/// Sets the maximum number of computing threads of the process, for teams created from now on.
pub fn limit(threads: usize) {
    LIMIT.store(threads.max(1), Ordering::Relaxed);
}

/// Returns the maximum number of computing threads of the process.
#[must_use]
pub fn threads() -> usize {
    LIMIT.load(Ordering::Relaxed)
}

/// Returns a pool with at least this number of threads; `None` if the system cannot start them. One
/// pool serves the whole process: pieces that run in parallel draw on the same threads, and each
/// hands out no more work than its share.
fn pool(threads: usize) -> Option<Arc<ThreadPool>> {
    static POOLS: Mutex<Vec<Arc<ThreadPool>>> = Mutex::new(Vec::new());
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(pool) = pools.iter().find(|pool| pool.current_num_threads() >= threads) {
        return Some(Arc::clone(pool));
    }
    // The thread that hands out the work computes too.
    let count = threads.max(self::threads() - 1);
    let pool = Arc::new(ThreadPoolBuilder::new().num_threads(count).build().ok()?);
    pools.push(Arc::clone(&pool));
    Some(pool)
}

thread_local! {
    /// Number of threads that the current piece of work may use, while other pieces run in
    /// parallel.
    static SHARE: Cell<usize> = const { Cell::new(usize::MAX) };
}

/// Computes with a share of the threads.
fn with_share<T>(threads: usize, compute: impl FnOnce() -> T) -> T {
    let before = SHARE.replace(threads);
    let value = compute();
    SHARE.set(before);
    value
}

/// Runs two closures, in parallel if there are two threads; each gets half of the threads.
pub fn both<A: Send, B: Send>(
    threads: usize,
    one: impl FnOnce() -> A + Send,
    other: impl FnOnce() -> B + Send,
) -> (A, B) {
    let threads = threads.min(SHARE.get());
    let Some(pool) = (threads > 1).then(|| pool(threads - 1)).flatten() else {
        return (one(), other());
    };
    let half = threads / 2;
    let mut of_other = None;
    let of_one = pool.in_place_scope(|scope| {
        scope.spawn(|_| of_other = Some(with_share(half, other)));
        with_share(threads - half, one)
    });
    (of_one, of_other.expect("a scope ends when all of it has"))
}

/// A team of threads, represented by the working memory of each.
#[derive(Debug)]
pub struct Team<S>(Vec<S>);

impl<S: Clone + Send> Team<S> {
    /// Returns a team of this many threads, at least one, each with a copy of `scratch`.
    #[must_use]
    pub fn new(threads: usize, scratch: S) -> Self {
        Self(vec![scratch; threads.max(1)])
    }

    /// Returns a team with the threads of the process ([`limit`]), each with a copy of `scratch`.
    #[must_use]
    pub fn of_process(scratch: S) -> Self {
        Self::new(threads(), scratch)
    }
}

impl<S> From<Vec<S>> for Team<S> {
    /// Returns a team with one thread per scratch; at least one is required.
    fn from(scratches: Vec<S>) -> Self {
        assert!(!scratches.is_empty(), "a team of no threads");
        Self(scratches)
    }
}

impl<S> Team<S> {
    /// Returns the scratch of the first thread, read-only.
    #[must_use]
    pub fn read(&self) -> &S {
        self.0.first().expect("there is at least one")
    }
}

impl<S: Send> Team<S> {
    /// Returns the scratch of the first thread.
    pub fn first(&mut self) -> &mut S {
        self.0.first_mut().expect("there is at least one")
    }

    /// Computes all items and returns the total work reported by `each`. `operations` estimates the
    /// total number of operations. On one thread, nothing is allocated.
    pub fn sweep<T>(
        &mut self,
        operations: u64,
        items: impl Iterator<Item = T> + Send,
        each: impl Fn(&mut S, T) -> u64 + Sync,
    ) -> u64 {
        let worth = usize::try_from(operations / WORTH).unwrap_or(usize::MAX);
        let threads = worth.clamp(1, self.0.len().min(SHARE.get()));
        let (own, others) = self.0[..threads].split_first_mut().expect("there is at least one");
        let Some(pool) = Some(others.len()).filter(|others| *others > 0).and_then(pool) else {
            return items.map(|item| each(own, item)).sum();
        };
        let (items, work) = (Mutex::new(items), AtomicU64::new(0));
        let next = || items.lock().unwrap_or_else(PoisonError::into_inner).next();
        let compute = |scratch: &mut S| {
            with_share(1, || {
                while let Some(item) = next() {
                    work.fetch_add(each(scratch, item), Ordering::Relaxed);
                }
            });
        };
        // This thread computes while the others wake up.
        pool.in_place_scope(|scope| {
            for other in others {
                scope.spawn(|_| compute(other));
            }
            compute(own);
        });
        work.into_inner()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Instant;

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
    /// Two halves of eight threads sweep four pieces each, and all eight pieces run at the same
    /// time: each waits for the others.
    #[test]
    fn nested_work_uses_all_threads() {
        let (arrived, begin) = (AtomicUsize::new(0), Instant::now());
        let sweep = || {
            Team::new(8, ()).sweep(4 * WORTH, 0..4, |(), _| {
                arrived.fetch_add(1, Ordering::SeqCst);
                while arrived.load(Ordering::SeqCst) < 8 && begin.elapsed().as_secs() < 20 {
                    std::thread::yield_now();
                }
                u64::from(arrived.load(Ordering::SeqCst) == 8)
            })
        };
        assert_eq!(both(8, sweep, sweep), (4, 4));
        // A third level: quarters of eight threads.
        let quarter = || both(8, || SHARE.get(), || SHARE.get());
        assert_eq!(both(8, quarter, quarter), ((2, 2), (2, 2)));
    }
}
