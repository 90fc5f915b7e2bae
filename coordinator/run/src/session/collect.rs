//! What the participants have published: received, checked, and looked through once.

use super::Session;
use super::index::TapIndex;
use crate::error::{Failure, RunError};
use crate::peers::Phase;
use contract::step::Step;
use coupling::ParticipantIndex;
use proto::model::first_non_finite;

impl Session {
    /// Receives what a participant has published for a step: its outputs, or what is only
    /// observed. Exactly one sample of each, on the grids as they are known.
    pub(super) fn collect(
        &mut self,
        one: ParticipantIndex,
        step: &Step,
        observed_only: bool,
    ) -> Result<(), RunError> {
        for index in self.taps.keys() {
            let tap = &self.taps[index];
            if tap.producer != one || tap.observed_only != observed_only {
                continue;
            }
            let received = tap.reader.receive().map_err(|e| self.peers.transport_failed(one, e))?;
            let Some(sample) = received else {
                let what = format!("it did not send `{}`", tap.kind.name);
                return Err(self.peers.misbehaved(one, what));
            };
            self.follow(index);
            let tap = &self.taps[index];
            if let Some(fault) = tap.fault(&sample, step) {
                return Err(self.peers.misbehaved(one, fault));
            }
            self.bytes_exchanged += std::mem::size_of_val(sample.values()) as u64;
            if let (Some(recorder), Some(topic)) = (self.peers.recorder(), tap.recorded) {
                recorder.sample(topic, sample.header().sequence);
            }
            self.taps[index].sample = Some(sample);
        }
        Ok(())
    }

    /// Puts a tap whose sample is about to be replaced on its grid as it is now.
    fn follow(&mut self, index: TapIndex) {
        let Self { taps, moving, .. } = self;
        let tap = &mut taps[index];
        if let Some(grid) = tap.moving.map(|at| &moving[at].grid)
            && grid.revision != tap.grid.revision
        {
            tap.move_to(grid);
        }
    }

    /// Every value of the newest sample is finite; looked at once per sample.
    pub(super) fn check_finite(&mut self, index: TapIndex) -> Result<(), RunError> {
        let tap = &mut self.taps[index];
        let Some(sample) = &tap.sample else { return Ok(()) };
        let header = sample.header();
        if tap.checked == header.sequence {
            return Ok(());
        }
        tap.checked = header.sequence;
        match first_non_finite(sample.values()) {
            None => Ok(()),
            Some(at) => {
                let step = Step {
                    window: header.window,
                    iteration: header.iteration,
                    start: header.start,
                    end: header.end,
                };
                let what = format!(
                    "field `{}` holds {} at index {at}",
                    tap.kind.name,
                    sample.values()[at]
                );
                Err(RunError::Failed(Failure {
                    who: self.peers.all()[tap.producer].who(),
                    when: Phase::Solving(step).to_string(),
                    what,
                    fix: "see its messages in log.jsonl, and check the case's values".to_owned(),
                }))
            }
        }
    }
}
