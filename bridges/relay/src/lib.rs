//! A participant on another machine: a server there starts the program, a client takes its place in the
//! run, and neither the program nor the coordinator sees that there is a network between them.
//!
//! | module | what |
//! |---|---|
//! | [`key`] | the key that both ends have |
//! | `handshake` | the first words, by which both prove that they have it |
//! | `record` | sealed records |
//! | `link` | one TCP connection: messages of records, signs of life, and their monitor |
//! | `frame`, `pack` | the bytes of messages; values, compressed without loss |
//! | `routes` | topics, numbered alike at both ends |
//! | [`client`], [`server`] | the two ends |

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

/// Cases of the tests over arbitrary bytes: a few hundred, or as many as `FUZZ_CASES` says.
#[cfg(test)]
fn fuzz_config() -> proptest::test_runner::Config {
    let cases = std::env::var("FUZZ_CASES").ok().and_then(|text| text.parse().ok());
    proptest::test_runner::Config::with_cases(cases.unwrap_or(400))
}
