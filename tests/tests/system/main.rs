//! System tests: they run the real executables, as processes, over real shared memory.
//!
//! Every test has its own runtime folder and result folder, and a watchdog. No test depends on
//! speed: a busy machine slows tests down but does not make them fail.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking")]

/// Defines a test for each row of a table, so that rows run in parallel. Each test calls the
/// function with the values after its name.
macro_rules! table_of_tests {
    ($function:ident: $($name:ident($($value:expr),* $(,)?);)+) => {
        $(
            #[test]
            fn $name() {
                $function($($value),*);
            }
        )+
    };
}

mod ablate;
mod accuracy;
mod advise;
mod bad_cases;
mod c_interface;
mod compare;
mod conform;
mod cost;
mod crowd;
mod driven;
mod elsewhere;
mod engines;
mod exchange;
mod explicit;
mod faults;
mod fmu_in;
mod folders;
mod input_files;
mod keys;
mod languages;
mod long_work;
mod machine;
mod new;
mod new_solver;
mod picture;
mod precice;
mod python;
mod recording;
mod relay;
mod report;
mod reproduce;
mod results;
mod resume;
mod reuse;
mod rods;
mod snippets;
mod stability;
mod start;
mod surrogate;
mod sweep;
mod terminal;
mod threads;
mod transitions;
mod volume;
mod warnings;
mod watch;

use tests::harness;
