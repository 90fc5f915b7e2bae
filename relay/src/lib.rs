//! A participant on another machine: one end listens there and starts the program, the other takes its place in
//! the run at home, and neither the program nor the coordinator sees that there is a network between them.
//!
//! | module | what |
//! |---|---|
//! | [`key`] | the key that both ends have |
//! | `hail`, `greet` | the first words, by which both show that they have it |
//! | `seal`, `line` | pieces that nobody else can read or make; messages, and signs of life |
//! | `fabric` | the only module that knows zenoh |
//! | `frame`, `pack` | the bytes of messages; values, compressed without loss |
//! | `routes` | topics, numbered alike at both ends |
//! | [`home`], [`far`] | the two ends |

mod fabric;
pub mod far;
mod frame;
mod greet;
mod hail;
pub mod home;
pub mod key;
mod line;
mod pack;
mod routes;
mod seal;

pub use fabric::Certificates;
pub use pack::Packing;

/// Cases of the tests over arbitrary bytes: a few hundred, or as many as `FUZZ_CASES` says.
#[cfg(test)]
fn fuzz_config() -> proptest::test_runner::Config {
    let cases = std::env::var("FUZZ_CASES").ok().and_then(|text| text.parse().ok());
    proptest::test_runner::Config::with_cases(cases.unwrap_or(400))
}
