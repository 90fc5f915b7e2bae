//! An evaluation does not allocate, as counted by the allocator on this thread.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use surrogate::Surrogate;

struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: every call is forwarded to the system allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.set(COUNT.get() + 1);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the pointer came from `alloc` above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const FILE: &str = r#"{"schema": 1,
    "origin": {"case": "small", "file": "small.toml", "options": [], "points": 9, "left_out": 0},
    "keys": [{"key": "a", "unit": "1", "from": 1, "to": 2}, {"key": "b", "unit": "N", "from": 1, "to": 2}],
    "coordinates": [{"key": "a", "from": 1, "to": 2}, {"key": "b", "per": "a", "from": 0.5, "to": 2}],
    "figures": [{"key": "c", "words": "c", "held": {"measure": "relative", "largest": 0.1, "rms": 0.1},
        "scale": "log", "scales": ["log", "linear"], "degrees": [[0, 0], [2, 3]], "coefficients": [1, 0.5]}]}"#;

#[test]
fn an_evaluation_does_not_allocate() {
    let surrogate = Surrogate::read(FILE.as_bytes()).unwrap();
    let mut room = surrogate.room();
    let before = COUNT.get();
    let mut sum = 0.0;
    for n in 0..100 {
        sum += surrogate.ask(&[1.0 + 0.01 * f64::from(n), 1.5], &mut room).unwrap()[0];
    }
    assert_eq!(COUNT.get() - before, 0);
    assert!(sum.is_finite() && sum > 0.0);
}
