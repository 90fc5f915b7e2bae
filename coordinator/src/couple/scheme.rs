//! The order in which participants solve within one iteration.

use super::Exchange;
use crate::error::RunError;
use proto::model::Step;

/// Orders the participants.
pub trait Scheme {
    /// Lets every participant solve once.
    fn pass(&mut self, exchange: &mut dyn Exchange, step: &Step) -> Result<(), RunError>;
}

/// One after the other, each with what the earlier ones have just sent.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

impl Scheme for Serial {
    fn pass(&mut self, exchange: &mut dyn Exchange, step: &Step) -> Result<(), RunError> {
        (0..exchange.participants()).try_for_each(|one| exchange.solve(&[one], step))
    }
}
