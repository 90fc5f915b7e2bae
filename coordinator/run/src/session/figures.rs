//! The figures that participants are asked for whenever a window is accepted.

use crate::plan::Plan;
use coupling::ParticipantIndex;
use std::ops::Range;
use typed_index_collections::TiVec;

/// Bytes of a figure in a reply.
const BYTES: usize = size_of::<f64>();

/// What each participant is asked for, and what it gave last.
#[derive(Debug)]
pub(super) struct Figures {
    /// Where those of each participant lie among the values.
    places: TiVec<ParticipantIndex, Range<usize>>,
    values: Vec<f64>,
}

impl Figures {
    /// Those of a plan.
    pub(super) fn of(plan: &Plan) -> Self {
        let mut count = 0;
        let mut place = |keys: &Vec<String>| {
            count += keys.len();
            count - keys.len()..count
        };
        let places = plan.participants.iter().map(|one| place(&one.figures)).collect();
        Self { places, values: vec![f64::NAN; count] }
    }

    /// A participant is asked for figures.
    pub(super) fn are_asked_of(&self, one: ParticipantIndex) -> bool {
        !self.places[one].is_empty()
    }

    /// Takes those of a participant out of its reply.
    ///
    /// # Errors
    /// There are more or fewer than were asked for, in words.
    pub(super) fn take(&mut self, one: ParticipantIndex, body: &[u8]) -> Result<(), String> {
        let place = self.places[one].clone();
        if body.len() != BYTES * place.len() {
            let (found, asked) = (body.len(), place.len());
            return Err(format!("it replies with {found} bytes to a request for {asked} figures"));
        }
        for (value, bytes) in self.values[place].iter_mut().zip(body.chunks_exact(BYTES)) {
            *value = f64::from_le_bytes(bytes.try_into().expect("a chunk is as long as a double"));
        }
        Ok(())
    }

    /// Those of all participants, in the plan's order.
    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }
}
