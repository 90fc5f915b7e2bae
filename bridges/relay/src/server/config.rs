//! Settings shared by all conversations of a server.

use crate::key::Key;
use crate::routes::Components;
use run::program::Program;
use std::time::Duration;

/// Maximum number of simultaneous conversations. A run has one; `conform` and sweeps have several.
pub(super) const CONVERSATIONS: usize = 32;

/// Program offered by a server, with the key required to use it.
pub(super) struct ServerConfig {
    /// Program that takes part, with its arguments.
    pub(super) program: Program,
    /// Role of the program.
    pub(super) role: String,
    /// Description of the program, as JSON.
    pub(super) description: Vec<u8>,
    /// Components of the program's fields.
    pub(super) components: Components,
    /// Key shared by both ends.
    pub(super) key: Key,
    /// Silence of the client after which the link counts as lost.
    pub(super) silence: Duration,
}
