//! A run: from a validated case to its results.
//!
//! [`case::Case`] → [`plan::Plan`] → [`session::Session`] → [`results`]. Each arrow is one module; only
//! the left side of an arrow reaches it.

pub mod advice;
pub mod checkpoint;
pub mod crew;
pub mod damage;
pub mod deadlines;
pub mod error;
pub mod format;
pub mod identity;
pub mod peers;
pub mod perform;
pub mod plan;
pub mod plan_file;
pub mod processes;
mod program;
pub mod programs;
pub mod progress;
pub mod record;
pub mod results;
pub mod scratch;
pub mod sealed;
pub mod session;
pub mod signals;
pub mod supervise;
pub mod warnings;
pub mod wrap;

/// Cases of the tests over arbitrary bytes: a few hundred, or as many as `FUZZ_CASES` says.
#[cfg(test)]
fn fuzz_config() -> proptest::test_runner::Config {
    let cases = std::env::var("FUZZ_CASES").ok().and_then(|text| text.parse().ok());
    proptest::test_runner::Config::with_cases(cases.unwrap_or(400))
}
