//! Client side of the relay, beside the coordinator. To the coordinator it is an ordinary
//! participant; it passes every command on to the server.

mod connection;
mod files;
mod join;
mod participant;
mod serve;

pub use join::join;

use crate::key::Key;
use crate::pack::Packing;
use std::time::Duration;

/// Settings of a client.
#[derive(Debug)]
pub struct Client {
    /// Address of the server: `HOST:PORT`.
    pub address: String,
    /// Key shared by both ends.
    pub key: Key,
    /// Packing of values, in both directions.
    pub packing: Packing,
    /// Maximum wait for the server to answer the connection.
    pub patience: Duration,
    /// Silence of the server after which the link counts as lost.
    pub silence: Duration,
}

/// Error of a client.
#[derive(Debug, thiserror::Error)]
#[error("{words}")]
pub struct ClientError {
    /// Error message.
    pub words: String,
    /// Exit code of the process.
    pub code: u8,
}

impl ClientError {
    fn of(words: impl std::fmt::Display) -> Self {
        Self { words: words.to_string(), code: 1 }
    }
}
