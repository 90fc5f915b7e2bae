//! Plans, supervises and couples the participants of a co-simulation.
//!
//! Case text → [`case::RawCase`] → [`case::Case`] → [`plan::Plan`] → [`session::Session`] →
//! [`results`]. Each arrow is one module; only the left side of an arrow reaches it. [`study`] and what
//! builds on it go through all of them many times.

pub mod ablate;
pub mod accuracy;
pub mod cli;
pub mod conform;
pub mod cost;
pub mod export;
pub mod inspect;
pub mod logging;
pub mod output;
pub mod progress;
pub mod replay;
pub mod report;
pub mod reproduce;
pub mod stability;
pub mod study;

/// Cases of the tests over arbitrary bytes: a few hundred, or as many as `FUZZ_CASES` says.
#[cfg(test)]
fn fuzz_config() -> proptest::test_runner::Config {
    let cases = std::env::var("FUZZ_CASES").ok().and_then(|text| text.parse().ok());
    proptest::test_runner::Config::with_cases(cases.unwrap_or(400))
}
