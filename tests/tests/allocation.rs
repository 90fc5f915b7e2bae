//! Invariant 8: a steady step of the coupling loop does not allocate.
//!
//! The thread-safe variant of iceoryx2 allocates one small handle for every loaned sample. These
//! allocations are counted exactly; no others are allowed.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking")]

use case::RawCase;
use coupling::Coupling;
use proto::model::Step;
use run::fleet::Fleet;
use run::plan::plan;
use run::progress::silent;
use run::session::{Observed, Session};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use tests::harness::toy;

/// Commands sent by the coordinator in a window without iteration: two solves, two acceptances.
const LOANS: u64 = 4;
/// Samples sent in an iteration of an implicit scheme: two commands, one iterate.
const LOANS_PER_ITERATION: u64 = 3;

/// One more for each mapped field.
const LOANS_PER_ITERATION_WITH_MAPPINGS: u64 = 4;

/// Total number of windows, and the number of first ones that are not judged: they may open
/// connections and fill the accelerator's history. The total is small, because each hop between
/// processes takes milliseconds on a busy machine, and a window of four iterations has eighteen.
const WINDOWS: u64 = 16;
const FIRST: usize = 10;

/// Counts the allocations of the current thread.
struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: all calls are passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = COUNT.try_with(|count| count.set(count.get() + 1));
        // SAFETY: the contract of the caller is that of the system's allocator.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the contract of the caller is that of the system's allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn a_steady_step_of_the_coupling_loop_does_not_allocate() {
    let (left, right) = (toy("left"), toy("right"));
    let case = format!(
        "[case]\nname = \"steady\"\n\
         [left]\nmodel = \"increment\"\ncommand = {left:?}\n\
         [right]\nmodel = \"increment\"\ncommand = {right:?}\n\
         [time]\nmode = \"transient\"\nwindow = 1\nend = 1e6\n\
         [coupling]\nscheme = \"serial-explicit\"\n[output]\nfields = \"none\"\n"
    );
    let planned = plan(RawCase::parse("test", &case).unwrap(), &mut Fleet::for_one_run()).unwrap();
    let mut session =
        Session::start(&planned.plan, &mut Fleet::for_one_run(), None, &silent()).unwrap();
    let mut coupling = Coupling::explicit();
    let mut counted = Vec::with_capacity(WINDOWS as usize);
    for window in 0..WINDOWS {
        let before = COUNT.get();
        let step = Step { window, iteration: 1, start: window as f64, end: window as f64 + 1.0 };
        coupling.solve_window(&mut session, &step).unwrap();
        let heat = session.balance();
        session.accept(&step, Observed::Nobody).unwrap();
        counted.push(COUNT.get() - before);
        assert_eq!(heat.sent, None, "the fields are not conservative");
    }
    session.finish(&mut Fleet::for_one_run()).unwrap();
    assert_steady(&counted, LOANS, "a window each");
}

/// Defines a test for each accelerator.
macro_rules! a_steady_iteration_does_not_allocate {
    ($($name:ident: $acceleration:literal;)+) => {
        $(
            #[test]
            fn $name() {
                iterate($acceleration, 100, LOANS_PER_ITERATION);
            }
        )+
    };
}

a_steady_iteration_does_not_allocate! {
    a_plain_iteration_does_not_allocate: "none";
    a_relaxed_iteration_does_not_allocate: "constant";
    an_aitken_iteration_does_not_allocate: "aitken";
    an_anderson_iteration_does_not_allocate: "anderson";
    an_iqn_ils_iteration_does_not_allocate: "iqn-ils";
    an_iqn_imvj_iteration_does_not_allocate: "iqn-imvj";
}

/// Both fields are mapped: the iterate to the grid of the relay, the answer back.
#[test]
fn a_steady_iteration_with_mappings_does_not_allocate() {
    iterate("iqn-ils", 137, LOANS_PER_ITERATION_WITH_MAPPINGS);
}

/// Windows of four iterations; the accelerator's history is full after the first one.
fn iterate(acceleration: &str, points: u32, loans_per_iteration: u64) {
    let (relay, operator) = (toy("relay"), toy("operator"));
    let case = format!(
        "[case]\nname = \"steady\"\n\
         [linear]\nproblem = \"P1\"\n\
         [relay]\nmodel = \"identity\"\ncommand = {relay:?}\npoints = {points}\n\
         [operator]\nmodel = \"affine\"\ncommand = {operator:?}\n\
         [time]\nmode = \"transient\"\nwindow = 1\nend = 1e6\n\
         [coupling]\nacceleration = \"{acceleration}\"\nmax_columns = 9\n\
         min_iterations = 4\nmax_iterations = 4\n[output]\nfields = \"none\"\n"
    );
    let planned = plan(RawCase::parse("test", &case).unwrap(), &mut Fleet::for_one_run()).unwrap();
    let mut session =
        Session::start(&planned.plan, &mut Fleet::for_one_run(), None, &silent()).unwrap();
    let mut coupling = Coupling::implicit(&planned.plan.implicit, false, &session);
    let mut counted = Vec::with_capacity(WINDOWS as usize);
    for window in 0..WINDOWS {
        let before = COUNT.get();
        let (start, end) = (window as f64, window as f64 + 1.0);
        let step = Step { window, iteration: 0, start, end };
        coupling.begin_window(&step);
        for _ in 0..4 {
            coupling.iterate(&mut session).unwrap();
        }
        coupling.accept_window();
        session.accept(&step, Observed::Nobody).unwrap();
        counted.push(COUNT.get() - before);
    }
    session.finish(&mut Fleet::for_one_run()).unwrap();
    let loans = 4 * loans_per_iteration + 2;
    assert_steady(&counted, loans, acceleration);
}

/// Asserts that every window after the first ones allocates once per loaned sample. One window may
/// differ: the first heartbeat during a command opens the topic of progress, which on a busy
/// machine may happen in any window.
fn assert_steady(counted: &[u64], loans: u64, of: &str) {
    let others = counted[FIRST..].iter().filter(|count| **count != loans).count();
    assert!(others <= 1, "{of}: {counted:?}");
}
