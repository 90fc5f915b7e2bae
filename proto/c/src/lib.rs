//! The participant contract for C, C++ and Fortran: `libcosim` and `include/cosim.h`.
//!
//! A program in C fills a table of callbacks and passes it to [`cosim_main`], which runs
//! [`proto`]'s participant around it. Callbacks read their arguments through functions; only plain
//! structures cross the interface.
//!
//! | module | what |
//! |---|---|
//! | [`solver`] | table of callbacks, step, report |
//! | [`fault`] | refusals and failures; containment of panics |
//! | [`configuration`], [`layout`] | configuration of a program, and its answer |
//! | [`fields`] | inputs and outputs in place, state piece by piece |
//! | [`grid`], [`volume`], [`moves`] | grids, volumes, and their changing geometry |
//! | [`progress`] | progress reports |
//!
//! `tests/header.rs` generates the header from these sources.

#![allow(
    clippy::missing_safety_doc,
    reason = "the comments are the header's: they say what each function asks of its arguments"
)]

pub mod configuration;
pub mod fault;
pub mod fields;
pub mod grid;
pub mod layout;
pub mod moves;
mod participant;
pub mod progress;
pub mod solver;
pub mod volume;

use participant::{FatalMessage, Program};
use solver::CosimSolver;
use std::any::Any;
use std::ffi::{CStr, OsString, c_char, c_int, c_void};
use std::io::Write;
use std::os::unix::ffi::OsStringExt;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Complete main function of a participant: prints the description with --describe, and with --join
/// takes part in a run until the run is finished. `user` is passed unchanged to every callback.
///
/// Returns the exit code: 0 for success, 1 for an error, which is written to standard error, 2 for
/// invalid arguments. A thread of the library sends the heartbeat and ends the process if the
/// coordinator dies. SIGPIPE is ignored from here on, unless the program handles it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_main(
    argc: c_int,
    argv: *mut *mut c_char,
    solver: *const CosimSolver,
    user: *mut c_void,
) -> c_int {
    ignore_broken_pipes();
    let act = || -> Result<u8, String> {
        // SAFETY: the header requires a table, callbacks that follow its rules, and main's
        // arguments.
        let (program, arguments) =
            unsafe { (Program::new(solver::read(solver)?, user)?, arguments(argc, argv)) };
        Ok(proto::participant::main_from(arguments, &program))
    };
    let error = match catch_unwind(AssertUnwindSafe(act)) {
        Ok(Ok(code)) => return c_int::from(code),
        Ok(Err(error)) => error,
        Err(panic) => last_words(&*panic),
    };
    let _ = writeln!(std::io::stderr(), "error: {error}");
    1
}

/// Ignores SIGPIPE like Rust's own runtime: writing to a dead coordinator must not kill the process
/// before it has left the run cleanly.
fn ignore_broken_pipes() {
    // SAFETY: neither disposition runs code; a handler set by the program is restored.
    unsafe {
        let before = libc::signal(libc::SIGPIPE, libc::SIG_IGN);
        if before != libc::SIG_DFL && before != libc::SIG_ERR {
            libc::signal(libc::SIGPIPE, before);
        }
    }
}

/// Returns the arguments of a C main; the library's name if there are none.
unsafe fn arguments(argc: c_int, argv: *mut *mut c_char) -> Vec<OsString> {
    let count = if argv.is_null() { 0 } else { usize::try_from(argc).unwrap_or(0) };
    // SAFETY: the header requires main's own argc and argv: as many strings, or NULL at the end.
    let words = (0..count).map(|n| unsafe { *argv.add(n) }).take_while(|word| !word.is_null());
    let words = words.map(|word| unsafe { CStr::from_ptr(word) }.to_bytes().to_vec());
    let mut words: Vec<OsString> = words.map(OsString::from_vec).collect();
    if words.is_empty() {
        words.push(OsString::from("cosim"));
    }
    words
}

fn last_words(panic: &(dyn Any + Send)) -> String {
    match panic.downcast_ref() {
        Some(FatalMessage(said)) => said.clone(),
        None => format!("the library panicked: {}", fault::panic_text(panic)),
    }
}
