//! The commands of the coordinator, and what they are made of: studies, recordings, conformance, pages.
//!
//! What a case is, and how it runs, are crates of their own: [`case`], [`run`]. A study runs a case many
//! times; [`cli`] lists the commands, and is all that the executable needs.

mod ablate;
mod accuracy;
mod advise;
mod ask;
mod case_arguments;
mod catalogue;
pub mod cli;
mod colour;
mod compare;
mod conform;
mod cost;
mod drive;
mod export;
mod feed;
mod fit;
mod fmu;
mod inspect;
mod keys;
mod listing;
mod logging;
mod manual;
mod new;
mod new_solver;
mod output;
mod picture;
mod progress;
mod relay;
mod replay;
mod report;
mod reproduce;
mod scenes;
mod solvers;
mod stability;
mod states;
mod study;
mod sweep;

/// Cases of the tests over arbitrary bytes: a few hundred, or as many as `FUZZ_CASES` says.
#[cfg(test)]
fn fuzz_config() -> proptest::test_runner::Config {
    let cases = std::env::var("FUZZ_CASES").ok().and_then(|text| text.parse().ok());
    proptest::test_runner::Config::with_cases(cases.unwrap_or(400))
}
