//! A step allocates nothing: counted by the allocator, on this thread only.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so does what it calls")]

mod support;

use proto::configuration::Mode;
use proto::grid::Structured;
use proto::model::Step;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use support::{Run, steel};

struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: every call is passed to the system's allocator unchanged.
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

/// Returns the allocations of `steps` accepted windows after `before` others.
fn allocations(run: &mut Run, before: usize, steps: usize, duration: f64) -> u64 {
    run.given.flux = Some(vec![1e8; run.grid().points()]);
    let step = Step { end: duration, ..Step::STEADY };
    let mut window = || {
        for iteration in 1..3 {
            let step = Step { iteration, ..step };
            run.model.solve(&step, &run.given, &mut run.surfaces).unwrap();
        }
        run.model.accept();
    };
    (0..before).for_each(|_| window());
    let count = COUNT.get();
    (0..steps).for_each(|_| window());
    COUNT.get() - count
}

#[test]
fn steady_steps_do_not_allocate() {
    // Below and above the crossover to Fourier transforms.
    for columns in [41, 321] {
        let grid = Structured::contact_plane(-8e-3, -1e-3, 2e-4, 2e-4, columns, 11);
        for model in ["ertz-knothe", "columns", "moving-source", "fe"] {
            assert_eq!(allocations(&mut Run::steady(model, grid), 1, 5, 0.0), 0, "{model}");
        }
    }
}

#[test]
fn transient_steps_do_not_allocate_once_the_grid_has_been_crossed() {
    let grid = Structured::contact_plane(-8e-3, -1e-3, 2e-4, 2e-4, 21, 3);
    for duration in [4.1e-7, 4.1e-6, 4.1e-5] {
        let crossing = (21.0 * 2e-4 / support::SPEED / duration) as usize;
        for model in ["columns", "fe"] {
            let mut run = Run::new(model, Mode::Transient, grid, steel());
            let made = allocations(&mut run, 2 * crossing + 2, 200, duration);
            assert_eq!(made, 0, "{model} {duration}");
        }
        let repeats = Structured::contact_plane(-8e-3, -1e-3, 2e-4, 2e-4, 22, 3);
        let mut run = Run::new("periodic", Mode::Transient, repeats, steel());
        assert_eq!(allocations(&mut run, 2, 20, duration), 0, "periodic {duration}");
    }
}
