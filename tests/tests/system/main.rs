//! System tests: they run the real executables, as processes, over real shared memory.
//!
//! Every test has a runtime folder and a result folder of its own, and a watchdog. None depends
//! on time being short: a busy machine makes them slower, not red.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking")]

/// A test for each row of a table, so that rows run side by side: a function, applied to what stands
/// behind the test's name.
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
mod audit;
mod bad_cases;
mod c_interface;
mod compare;
mod conform;
mod contact_examples;
mod cost;
mod crowd;
mod driven;
mod elsewhere;
mod engines;
mod exchange;
mod explicit;
#[path = "../shared/failures.rs"]
mod failures;
mod faults;
mod figures;
mod fmi;
mod fmu_in;
mod folders;
mod histories;
mod implicit;
mod input_files;
mod instability;
mod keys;
mod languages;
mod long_work;
mod machine;
mod mapping;
mod mistakes;
mod moving;
mod new;
mod new_solver;
mod off_means_off;
mod order_of_effects;
#[path = "../shared/paper.rs"]
mod paper;
mod paraview;
mod patches;
mod picture;
mod python;
mod recording;
mod relay;
mod report;
mod reproduce;
mod results;
mod resume;
mod reuse;
mod rods;
mod scenes;
mod snippets;
mod stability;
mod start;
mod surrogate;
mod sweep;
#[path = "../shared/sweeps.rs"]
mod sweeps;
mod terminal;
mod threads;
mod time;
mod two_way;
mod volume;
mod wake;
mod warnings;

use tests::harness;
