//! The participant contract for C, C++ and Fortran: `libcosim` and `include/cosim.h`.
//!
//! A program in C fills a table of callbacks and hands it to [`cosim_main`], which is [`proto`]'s
//! participant round it. What a callback is given it reads with functions: nothing of Rust's layout
//! crosses but plain structures.
//!
//! | module | what |
//! |---|---|
//! | [`solver`] | the table of callbacks, a step, a report |
//! | [`fault`] | refusals and failures; no panic crosses |
//! | [`configuration`], [`layout`] | what a program is given and what it answers |
//! | [`fields`] | inputs and outputs in place, state piece by piece |
//! | [`grid`], [`volume`], [`moves`] | grids, volumes, and their geometry where it changes |
//! | [`progress`] | how far it is |
//!
//! The header is written from these sources by `tests/header.rs`.

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

use participant::{LastWords, Program};
use solver::CosimSolver;
use std::any::Any;
use std::ffi::{CStr, OsString, c_char, c_int, c_void};
use std::io::Write;
use std::os::unix::ffi::OsStringExt;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The whole main of a participant: answers --describe and --estimate, and with --join takes part in
/// a run until it is finished. `user` is handed to every callback and not looked at.
///
/// Returns the exit code: 0, 1 for an error, which is written to standard error, 2 for wrong
/// arguments. While it runs, a thread of the library's own beats the heart; should the coordinator
/// die, that thread ends the process. SIGPIPE is ignored from here on, unless the program handles it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_main(
    argc: c_int,
    argv: *mut *mut c_char,
    solver: *const CosimSolver,
    user: *mut c_void,
) -> c_int {
    ignore_broken_pipes();
    let act = || -> Result<u8, String> {
        // SAFETY: the header asks for a table, callbacks that keep its rules, and main's arguments.
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

/// As Rust's own start does: the last words to a coordinator that has died must not kill the process
/// before it has left the run in order.
fn ignore_broken_pipes() {
    // SAFETY: neither disposition runs code; one that the program has set is put back.
    unsafe {
        let before = libc::signal(libc::SIGPIPE, libc::SIG_IGN);
        if before != libc::SIG_DFL && before != libc::SIG_ERR {
            libc::signal(libc::SIGPIPE, before);
        }
    }
}

/// The arguments of a C main; the library's name where there is none.
unsafe fn arguments(argc: c_int, argv: *mut *mut c_char) -> Vec<OsString> {
    let count = if argv.is_null() { 0 } else { usize::try_from(argc).unwrap_or(0) };
    // SAFETY: the header asks for main's own argc and argv: as many strings, or NULL for an end.
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
        Some(LastWords(said)) => said.clone(),
        None => format!("the library panicked: {}", fault::panic_text(panic)),
    }
}
