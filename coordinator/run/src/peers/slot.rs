//! Roles of a run, and the programs that play them.

use crate::program::Program;

/// A role of a run, and the program that plays it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParticipantSlot {
    /// Role to play.
    pub role: String,
    /// The program that plays it.
    pub program: Program,
    /// The participant is started by hand; the run waits for it.
    pub attach: bool,
}
