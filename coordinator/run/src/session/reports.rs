//! Reports of the participants: on their last solve, and the figures that they give after each
//! accepted window.

use crate::plan::Plan;
use contract::message::{Reply, read_figures};
use coupling::ParticipantIndex;
use std::ops::Range;
use typed_index_collections::TiVec;

/// Report of a participant on its last solve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveRecord {
    /// Time spent in the model [s].
    pub model_seconds: f64,
    /// Work in the model's own measure.
    pub work: u64,
    /// Number of substeps.
    pub substeps: u32,
    /// Number of iterations of the inner solver.
    pub inner_iterations: u32,
    /// Power of the conservative inputs that were sent to the participant [W].
    pub sent: Option<f64>,
    /// Mean power through conservative inputs that the participant reports as received [W].
    pub received: Option<f64>,
    /// Longest window that the participant asks for, from the start of this one [s].
    pub wanted_window: Option<f64>,
}

impl SolveRecord {
    /// Returns the report in a reply to a solve.
    pub(super) fn of(reply: &Reply) -> Self {
        Self {
            model_seconds: reply.model_seconds,
            work: reply.work,
            substeps: reply.substeps,
            inner_iterations: reply.inner_iterations,
            sent: None,
            received: reply.received_power(),
            wanted_window: reply.wanted_window().filter(|window| *window > 0.0),
        }
    }
}

/// Figures requested from each participant, with their last values.
#[derive(Debug)]
pub(super) struct Figures {
    /// Ranges of each participant's figures among the values.
    places: TiVec<ParticipantIndex, Range<usize>>,
    values: Vec<Option<f64>>,
}

impl Figures {
    /// Returns the figures of a plan, with unknown values.
    pub(super) fn of(plan: &Plan) -> Self {
        let mut count = 0;
        let mut place = |keys: &Vec<String>| {
            count += keys.len();
            count - keys.len()..count
        };
        let places =
            plan.participants.iter().map(|participant| place(&participant.figures)).collect();
        Self { places, values: vec![None; count] }
    }

    /// Returns whether a participant is asked for figures.
    pub(super) fn are_asked_of(&self, participant: ParticipantIndex) -> bool {
        !self.places[participant].is_empty()
    }

    /// Reads the figures of a participant from its reply.
    ///
    /// # Errors
    /// The number of figures differs from the request.
    pub(super) fn take(
        &mut self,
        participant: ParticipantIndex,
        body: &[u8],
    ) -> Result<(), String> {
        read_figures(body, &mut self.values[self.places[participant].clone()])
    }

    /// Returns the figures of all participants, in the order of the plan.
    pub(super) fn values(&self) -> &[Option<f64>] {
        &self.values
    }
}
