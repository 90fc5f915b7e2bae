//! Tests of physics, coupling and restart, with engine and solvers in one process: real models and
//! real shared memory, but no processes. Tests of processes are in `system`.

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

mod advised;
mod audit;
mod bad_cases;
mod contact_examples;
mod figures;
mod harness;
mod histories;
mod implicit;
mod instability;
mod mapping;
mod mistakes;
mod moving;
mod off_means_off;
mod order_of_effects;
mod pages;
mod patches;
mod results;
mod resume;
mod rods;
mod scenes;
mod stopping;
mod strict;
mod time;
mod two_way;
mod wake;
mod warnings;
