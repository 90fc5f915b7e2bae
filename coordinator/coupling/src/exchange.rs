//! What a coupling asks of the participants it couples.

use crate::index::ParticipantIndex;
use crate::part::Part;
use contract::step::Step;

/// The participants of a run, as a coupling sees them: how they are reached, and what else can fail
/// there, is the business of whoever implements this.
pub trait Exchange {
    /// Why a participant could not be reached, or failed.
    type Error;

    /// Number of participants, in the order in which data flows.
    fn participants(&self) -> usize;

    /// Lets some participants solve at the same time, with the newest samples of their inputs as
    /// they are when the call begins.
    ///
    /// # Errors
    /// A participant that failed.
    fn solve(&mut self, participants: &[ParticipantIndex], step: &Step) -> Result<(), Self::Error>;

    /// The coupling data: the fields that are iterated, as parts of one vector; none for an
    /// explicit scheme.
    fn coupling_data(&self) -> &[Part];

    /// Sends an iterate of the coupling data to those who consume it.
    ///
    /// # Errors
    /// A consumer that cannot be reached.
    fn send(&mut self, iterate: &[f64], step: &Step) -> Result<(), Self::Error>;

    /// Copies what the participants have returned last into `returned`.
    fn returned(&self, returned: &mut [f64]);
}
