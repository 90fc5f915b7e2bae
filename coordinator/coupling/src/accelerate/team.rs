//! Pieces of a long vector, shared out among threads.
//!
//! No piece depends on another one: results are the same to the bit, whatever the number of threads
//! and whoever takes which piece. Threads are started for one pass and end with it, so that a pass
//! gets no more of them than it has [`WORTH`] operations for each. On one nothing is allocated.

use std::sync::{Mutex, PoisonError};
use std::thread;

/// Multiply-adds that are worth a thread of their own: more than 1 ms where the memory is read, so that
/// a thread that starts late on a busy machine loses less than it gains. What fits into caches is done
/// before a second thread has begun.
const WORTH: usize = 4_000_000;

/// Works on all pieces, which come to about so many multiply-adds, on `threads` threads at most.
pub(super) fn share<T: Send>(
    threads: usize,
    operations: usize,
    pieces: impl Iterator<Item = T> + Send,
    work: impl Fn(T) + Sync,
) {
    let threads = threads.min(operations / WORTH);
    if threads < 2 {
        return pieces.for_each(work);
    }
    let pieces = Mutex::new(pieces);
    let next = || pieces.lock().unwrap_or_else(PoisonError::into_inner).next();
    let take = || {
        while let Some(piece) = next() {
            work(piece);
        }
    };
    thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(take);
        }
        take();
    });
}
