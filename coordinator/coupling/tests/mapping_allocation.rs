//! Applying a fixed mapping allocates nothing: counted by the allocator, on this thread only.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so does what it calls")]

use contract::field::Mapping;
use contract::grid::{Grid, Quadrilaterals, Structured};
use coupling::map::{CurrentMapping, Method};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

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

#[test]
fn mapping_and_auditing_do_not_allocate_while_grids_stay() {
    let plane = |n| Structured::contact_plane(0.0, 0.0, 1.0 / n as f64, 1.0 / n as f64, n, n);
    let source = Grid::structured("source", plane(40));
    let target = Grid::quadrilaterals("target", Quadrilaterals::from(&plane(55)));
    let field = vec![1.0; 2 * source.points()];
    let mut mapped = vec![0.0; 2 * target.points()];
    for method in Method::ALL {
        let mut current = CurrentMapping::new(Some(method), Mapping::Conservative);
        current.between(&source, &target).unwrap();
        let before = COUNT.get();
        for _ in 0..10 {
            let mapping = current.between(&source, &target).unwrap();
            mapping.apply(&field, &mut mapped);
            assert!(mapping.imbalance(&field, &mapped) < 1e-13, "rounding");
        }
        assert_eq!(COUNT.get() - before, 0, "{method:?}");
        assert_eq!(current.builds(), 1);
    }
}
