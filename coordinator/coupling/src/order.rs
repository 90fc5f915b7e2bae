//! The order in which participants solve within one iteration.

use crate::exchange::Exchange;
use crate::index::ParticipantIndex;
use contract::step::Step;

/// Orders the participants.
#[derive(Clone, Debug)]
pub(crate) enum Order {
    /// One after the other, each with what the earlier ones have just sent.
    Serial,
    /// All at once, each with what was there before.
    Parallel(Vec<ParticipantIndex>),
}

impl Order {
    pub(crate) fn of(parallel: bool) -> Self {
        if parallel { Self::Parallel(Vec::new()) } else { Self::Serial }
    }

    /// Lets every participant solve once.
    pub(crate) fn pass<E: Exchange + ?Sized>(
        &mut self,
        exchange: &mut E,
        step: &Step,
    ) -> Result<(), E::Error> {
        match self {
            Self::Serial => everybody(exchange).try_for_each(|one| exchange.solve(&[one], step)),
            Self::Parallel(all) => {
                if all.len() != exchange.participants() {
                    *all = everybody(exchange).collect();
                }
                exchange.solve(all, step)
            }
        }
    }
}

fn everybody<E: Exchange + ?Sized>(
    exchange: &E,
) -> impl Iterator<Item = ParticipantIndex> + use<E> {
    (0..exchange.participants()).map(ParticipantIndex::from)
}
