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

/// All at once, each with what was there before.
#[derive(Clone, Debug, Default)]
pub struct Parallel {
    everybody: Vec<usize>,
}

impl Scheme for Parallel {
    fn pass(&mut self, exchange: &mut dyn Exchange, step: &Step) -> Result<(), RunError> {
        if self.everybody.len() != exchange.participants() {
            self.everybody = (0..exchange.participants()).collect();
        }
        exchange.solve(&self.everybody, step)
    }
}
