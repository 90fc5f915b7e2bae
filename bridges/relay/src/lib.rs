//! Runs a participant on another machine. A server there starts the program; a client represents it
//! in the run. Neither the program nor the coordinator notices the network between them.
//!
//! | module | content |
//! |---|---|
//! | [`key`] | shared key |
//! | `handshake` | handshake, in which both ends prove that they hold the key |
//! | `record` | encrypted records |
//! | `link` | TCP connection: messages made of records, signs of life, monitor |
//! | `frame`, `pack` | encoding of messages; lossless compression of values |
//! | `routes` | topics, numbered identically at both ends |
//! | [`client`], [`server`] | the two ends |

#![forbid(unsafe_code)]

pub mod client;
mod frame;
mod handshake;
pub mod key;
mod link;
mod pack;
mod record;
mod routes;
pub mod server;

pub use pack::Packing;

/// Configuration of tests with arbitrary bytes: 400 cases, or the number in `FUZZ_CASES`.
#[cfg(test)]
fn fuzz_config() -> proptest::test_runner::Config {
    let cases = std::env::var("FUZZ_CASES").ok().and_then(|text| text.parse().ok());
    proptest::test_runner::Config::with_cases(cases.unwrap_or(400))
}
