//! The end beside the coordinator, for which it is a participant like any other: it asks the server
//! whatever it is asked itself.

mod connection;
mod files;
mod join;
mod participant;
mod serve;

pub use connection::ask;
pub use join::join;

use crate::key::Key;
use crate::pack::Packing;
use std::time::Duration;

/// Settings of a client: the server, the key, and its patience.
#[derive(Debug)]
pub struct Client {
    /// Address of the server: `HOST:PORT`.
    pub address: String,
    /// The key that both ends have.
    pub key: Key,
    /// How values are packed, both ways.
    pub packing: Packing,
    /// Longest wait for the server to answer the call.
    pub patience: Duration,
    /// Without a sign of life for so long, the link is lost.
    pub silence: Duration,
}

/// Reason why a client fails.
#[derive(Debug, thiserror::Error)]
#[error("{words}")]
pub struct ClientError {
    /// What to say of it.
    pub words: String,
    /// The exit code.
    pub code: u8,
}

impl ClientError {
    fn of(words: impl std::fmt::Display) -> Self {
        Self { words: words.to_string(), code: 1 }
    }
}
