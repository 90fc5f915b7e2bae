//! What every conversation of the far end has in common.

use crate::key::Key;
use crate::routes::Components;
use run::programs::Program;
use std::time::Duration;

/// What a far end offers, and to whom.
pub(super) struct Offer {
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
