//! The end at home: for the coordinator a participant like any other, which asks the far end whatever it is
//! asked itself.

mod ask;
mod files;
mod join;
mod keeper;
mod seat;
mod serve;

pub use ask::ask;
pub use join::join;

use crate::fabric::Certificates;
use crate::key::Key;
use crate::pack::Packing;
use std::time::Duration;

/// How the far end is reached.
#[derive(Debug)]
pub struct Home {
    /// Where it listens: `tcp/HOST:PORT` or `tls/HOST:PORT`.
    pub endpoint: String,
    /// The key that both ends have.
    pub key: Key,
    /// Certificates for `tls`.
    pub certificates: Certificates,
    /// How values are packed, both ways.
    pub packing: Packing,
    /// Longest wait for the far end to answer the call.
    pub patience: Duration,
    /// Without a sign of life for so long, the link is lost.
    pub silence: Duration,
}

/// How the end at home ends badly.
#[derive(Debug, thiserror::Error)]
#[error("{words}")]
pub struct HomeError {
    /// What to say of it.
    pub words: String,
    /// The exit code.
    pub code: u8,
}

impl HomeError {
    fn of(words: impl std::fmt::Display) -> Self {
        Self { words: words.to_string(), code: 1 }
    }
}
