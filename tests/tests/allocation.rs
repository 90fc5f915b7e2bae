//! Invariant 8: a steady step of the coupling loop does not allocate.
//!
//! The thread-safe variant of iceoryx2 makes one small handle on the heap for every sample that is
//! loaned. These are counted exactly, and nothing else may come on top.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking")]

use coordinator::case::RawCase;
use coordinator::couple::Coupling;
use coordinator::plan::plan;
use coordinator::session::Session;
use proto::model::Step;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// Commands that the coordinator sends in a window: two solves, two acceptances.
const LOANS: u64 = 4;

/// Counts the allocations of the thread that asks.
struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: everything is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = COUNT.try_with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's contract is the system's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's contract is the system's.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn program(name: &str) -> String {
    let test = std::env::current_exe().unwrap();
    let path = test.parent().unwrap().parent().unwrap().join(name);
    let mut build = std::process::Command::new(env!("CARGO"));
    build.args(["build", "--quiet", "-p", "tests", "--bins"]);
    if !cfg!(debug_assertions) {
        build.arg("--release");
    }
    assert!(build.status().unwrap().success());
    path.display().to_string()
}

#[test]
fn a_steady_step_of_the_coupling_loop_does_not_allocate() {
    let (left, right) = (program("toy-left"), program("toy-right"));
    let case = format!(
        "[case]\nname = \"steady\"\n\
         [left]\nmodel = \"increment\"\ncommand = [{left:?}]\n\
         [right]\nmodel = \"increment\"\ncommand = [{right:?}]\n\
         [time]\nmode = \"transient\"\nwindow = 1\nend = 1e6\n\
         [coupling]\nscheme = \"serial-explicit\"\n[output]\nfields = \"none\"\n"
    );
    let planned = plan(RawCase::parse("test", &case).unwrap()).unwrap();
    let mut session = Session::start(&planned.plan).unwrap();
    let mut coupling = Coupling::explicit();
    let mut counted = Vec::with_capacity(60);
    for window in 0..60 {
        let before = COUNT.get();
        let step = Step { window, iteration: 1, start: window as f64, end: window as f64 + 1.0 };
        coupling.solve_window(&mut session, &step).unwrap();
        let heat = session.heat_balance();
        session.accept(&step, false).unwrap();
        counted.push(COUNT.get() - before);
        assert_eq!(heat.sent, None, "the fields are not conservative");
    }
    session.finish().unwrap();
    // The first windows may open connections; after that only the loans' handles are left.
    assert!(counted[10..].iter().all(|count| *count == LOANS), "a window each: {counted:?}");
}
