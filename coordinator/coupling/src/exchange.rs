//! The interface of a coupling to its participants, and the order in which they solve.

use crate::vector::Part;
use contract::step::Step;

/// Declares an index type, so that different indices cannot be confused with each other or with
/// plain numbers. Lists with such an index are `typed_index_collections::TiVec`.
#[macro_export]
macro_rules! index {
    ($(#[$doc:meta])* $visibility:vis $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        $visibility struct $name(usize);

        impl $name {
            /// The first index.
            #[allow(dead_code, reason = "not every index is needed by itself")]
            $visibility const FIRST: Self = Self(0);
        }

        impl From<usize> for $name {
            fn from(index: usize) -> Self {
                Self(index)
            }
        }

        impl From<$name> for usize {
            fn from(index: $name) -> Self {
                index.0
            }
        }
    };
}

index! {
    /// A participant, by its place in the order in which data flows.
    pub ParticipantIndex
}

/// Participants of a run, as the coupling sees them. The implementation decides how to reach them
/// and defines its own errors.
pub trait Exchange {
    /// Error for a participant that failed or could not be reached.
    type Error;

    /// Returns the number of participants. They are numbered in the order in which data flows.
    fn participants(&self) -> usize;

    /// Lets some participants solve at the same time. Each uses the newest samples of its inputs at
    /// the beginning of the call.
    ///
    /// # Errors
    /// A participant failed.
    fn solve(&mut self, participants: &[ParticipantIndex], step: &Step) -> Result<(), Self::Error>;

    /// Returns the coupling data: the iterated fields, as parts of one vector. Empty for an
    /// explicit scheme.
    fn coupling_data(&self) -> &[Part];

    /// Returns the fields that are not iterated, but have tolerances of their own. Their parts
    /// follow those of the coupling data in the vector of [`Exchange::returned`].
    fn measured_data(&self) -> &[Part] {
        &[]
    }

    /// Sends an iterate of the coupling data to the participants that consume it.
    ///
    /// # Errors
    /// A consumer cannot be reached.
    fn send(&mut self, iterate: &[f64], step: &Step) -> Result<(), Self::Error>;

    /// Copies the values that the participants returned last into `returned`: coupling data, then
    /// measured data.
    fn returned(&self, returned: &mut [f64]);
}

/// The order in which participants solve within one iteration.
#[derive(Clone, Debug)]
pub(crate) enum Order {
    /// One after another, each with the values just sent by the earlier ones.
    Serial,
    /// All at once, each with the values from before the pass.
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
