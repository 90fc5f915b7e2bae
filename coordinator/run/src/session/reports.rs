//! Reports of the participants: on their last solve, and the figures that they give after each
//! accepted window.

use crate::plan::Plan;
use contract::message::Reply;
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
            received: Some(reply.heat_received).filter(|heat| !heat.is_nan()),
            wanted_window: Some(reply.wanted_window).filter(|w| *w > 0.0 && w.is_finite()),
        }
    }
}

/// Size of a figure in a reply [byte].
const BYTES: usize = size_of::<f64>();

/// Figures requested from each participant, with their last values.
#[derive(Debug)]
pub(super) struct Figures {
    /// Ranges of each participant's figures among the values.
    places: TiVec<ParticipantIndex, Range<usize>>,
    values: Vec<f64>,
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
        Self { places, values: vec![f64::NAN; count] }
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
        let place = self.places[participant].clone();
        if body.len() != BYTES * place.len() {
            let (found, asked) = (body.len(), place.len());
            return Err(format!("it replies with {found} bytes to a request for {asked} figures"));
        }
        for (value, bytes) in self.values[place].iter_mut().zip(body.chunks_exact(BYTES)) {
            *value = f64::from_le_bytes(bytes.try_into().expect("a chunk is as long as a double"));
        }
        Ok(())
    }

    /// Returns the figures of all participants, in the order of the plan.
    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }
}
