//! Settings that every conversation of a server shares.

use crate::key::Key;
use crate::routes::Components;
use run::programs::Program;
use std::time::Duration;

/// Conversations at the same time: a run has one, `conform` and sweeps several.
pub(super) const CONVERSATIONS: usize = 32;

/// Program that a server offers, and the key of those who may use it.
pub(super) struct ServerConfig {
    /// The program that takes part.
    pub(super) program: Program,
    /// The role that it plays.
    pub(super) role: String,
    /// Components of its fields.
    pub(super) components: Components,
    /// The key that both ends have.
    pub(super) key: Key,
    /// Without a sign of life for so long, the link is lost.
    pub(super) silence: Duration,
}
