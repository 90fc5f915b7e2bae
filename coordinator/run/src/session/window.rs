//! Windows of a run: solving, accepting, and the end after the last one.

use super::reports::SolveRecord;
use super::{Observed, Session, audit};
use crate::error::RunError;
use crate::fleet::Fleet;
use crate::peers::{Participants, Phase};
use contract::message::{Command, CommandKind, FIGURES, Finished, OBSERVE, STAY};
use contract::step::Step;
use coupling::{Exchange, Part, ParticipantIndex};

impl Session {
    /// Makes the last solve of every participant its accepted state. Participants publish observed
    /// fields and figures, and the new geometry of grids that move.
    pub fn accept(&mut self, step: &Step, observed: Observed) -> Result<(), RunError> {
        // In an explicit scheme no other check covers the samples of the last solve before they are
        // accepted.
        self.fields.keys().try_for_each(|field| self.check_finite(field))?;
        self.peers.phase = Phase::Accepting(*step);
        self.check_live()?;
        let mut observing = Participants::new();
        for participant in self.peers.all().keys() {
            let observe = self.is_observed(participant, observed);
            let figures = self.figures.are_asked_of(participant);
            observing.extend(observe.then_some(participant));
            let mut command = Command::about(CommandKind::Accept, step);
            command.flags = if observe { OBSERVE } else { 0 } | if figures { FIGURES } else { 0 };
            self.peers.post(participant, command, &[])?;
        }
        self.keep_geometry();
        let deadline = self.peers.deadlines().solve;
        let (mut failures, mut pending) = (Vec::new(), self.peers.all().keys().collect());
        while let Some((participant, answer)) = self.peers.next_reply(&mut pending, |_| deadline)? {
            let message = match answer {
                Ok(message) => message,
                Err(error) => {
                    failures.push((participant, error));
                    continue;
                }
            };
            if self.figures.are_asked_of(participant) {
                let taken = self.figures.take(participant, message.body());
                taken.map_err(|what| self.peers.misbehaved(participant, what))?;
            }
            drop(message);
            if observing.contains(&participant) {
                self.collect(participant, step, true)?;
            }
            self.receive_geometry(participant, step)?;
        }
        if let Some(error) = first(failures) {
            self.unanswered = true;
            return Err(error);
        }
        self.memory.settle();
        if !observing.is_empty() {
            self.fields.keys().try_for_each(|field| self.check_finite(field))?;
        }
        Ok(())
    }

    /// Notes that the window has no answer that could be accepted.
    pub fn no_answer(&mut self) {
        self.unanswered = true;
    }

    /// Returns the cause of the error of a participant ([`crate::peers::Peers::cause`]).
    #[must_use]
    pub fn cause(&self, error: RunError) -> RunError {
        self.peers.cause(error)
    }

    /// Returns whether the last error was that a participant has no answer, so that all others
    /// continue. Clears the note.
    pub fn take_unanswered(&mut self) -> bool {
        std::mem::take(&mut self.unanswered)
    }

    fn is_observed(&self, participant: ParticipantIndex, observed: Observed) -> bool {
        let mut own = self.fields.iter().filter(|field| field.producer == participant).peekable();
        match observed {
            Observed::Everybody => true,
            Observed::Unconsumed => own.peek().is_some() && own.all(|field| field.observed_only),
            Observed::Nobody => false,
        }
    }

    /// Asks every participant for its summary, and lets it end or stay for the next run.
    ///
    /// # Errors
    /// A participant fails, has ended, is late, or reports negative times.
    pub fn finish(
        mut self,
        fleet: &mut Fleet,
    ) -> Result<(Vec<Finished>, Option<PendingExits>), RunError> {
        self.peers.phase = Phase::Finishing;
        if let Some(recorder) = self.peers.recorder() {
            recorder.stop_listening()?;
        }
        self.tell_mappings();
        let stay = self.reusable && fleet.stays();
        let flags = if stay { STAY } else { 0 };
        for participant in self.peers.all().keys() {
            let command = Command { flags, ..Command::new(CommandKind::Finish) };
            self.peers.post(participant, command, &[])?;
        }
        let mut finished = Vec::with_capacity(self.peers.all().len());
        let deadline = self.peers.deadlines().solve;
        let mut pending = self.peers.all().keys().collect();
        while let Some((participant, answer)) = self.peers.next_reply(&mut pending, |_| deadline)? {
            let said: Finished = serde_json::from_slice(answer?.body()).map_err(|e| {
                self.peers.misbehaved(participant, format!("its summary is not valid: {e}"))
            })?;
            let (model, processor) = (said.model_seconds, said.cpu_seconds.unwrap_or_default());
            if model < 0.0 || processor < 0.0 {
                let what = format!("model_seconds is {model} s, cpu_seconds {processor} s");
                return Err(self.peers.misbehaved(participant, what));
            }
            finished.push(said);
        }
        if stay {
            let taken = self.memory.taken();
            self.stay(fleet, taken);
            return Ok((finished, None));
        }
        Ok((finished, Some(PendingExits(self))))
    }

    /// Leaves the participants in the fleet. They hold this much shared memory [byte].
    pub(super) fn stay(self, fleet: &mut Fleet, held: u64) {
        let Self { guard, peers, fields, coupled, mapped, moving, live, .. } = self;
        guard.spare();
        // The next run needs the same ports.
        drop((fields, coupled, mapped, moving, live));
        fleet.stay(peers.after_run(held));
    }
}

/// Participants that have been asked to end. Dropping this waits for their exits, so that results
/// can be written meanwhile.
#[derive(Debug)]
#[must_use]
pub struct PendingExits(Session);

impl Drop for PendingExits {
    /// Waits for the exits; the session then kills the remaining processes.
    fn drop(&mut self) {
        self.0.peers.wait_for_exits();
    }
}

/// Returns the error of the first failed participant in the order of the plan, independent of
/// timing.
fn first(failures: Vec<(ParticipantIndex, RunError)>) -> Option<RunError> {
    failures.into_iter().min_by_key(|(participant, _)| *participant).map(|(_, error)| error)
}

impl Exchange for Session {
    type Error = RunError;

    fn participants(&self) -> usize {
        self.peers.all().len()
    }

    fn solve(&mut self, participants: &[ParticipantIndex], step: &Step) -> Result<(), RunError> {
        self.peers.phase = Phase::Solving(*step);
        if let Some(recorder) = self.peers.recorder() {
            recorder.wait_for_room()?;
        }
        self.send_live(step)?;
        self.send_mapped(participants)?;
        self.note_live(participants);
        for &participant in participants {
            let mut command = Command::about(CommandKind::Solve, step);
            for field in &self.fields {
                for reader in field.readers().iter().filter(|r| r.participant == participant) {
                    command.expected[reader.slot] = field.sequence();
                }
            }
            for coupled in &self.coupled {
                for reader in coupled.readers.iter().filter(|r| r.participant == participant) {
                    command.expected[reader.slot] = coupled.sequence();
                }
            }
            for sent in &self.live.sent {
                for reader in sent.readers.iter().filter(|r| r.participant == participant) {
                    command.expected[reader.slot] = sent.publisher.sequence();
                }
            }
            for mapped in self.mapped.iter().filter(|m| m.reader.participant == participant) {
                command.expected[mapped.reader.slot] = mapped.publisher().sequence();
            }
            self.peers.post(participant, command, &[])?;
        }
        // While the participants compute, the samples sent before are audited, recorded and
        // checked.
        for &participant in participants {
            let Self { fields, coupled, mapped, .. } = &*self;
            self.solved[participant].sent = audit::commanded(fields, coupled, mapped, participant);
        }
        if let Some(recorder) = self.peers.recorder() {
            recorder.hand_over();
        }
        self.fields.keys().try_for_each(|field| self.check_finite(field))?;
        let mut longest = 0.0_f64;
        let (deadline, mut failures) = (self.peers.deadlines().solve, Vec::new());
        let mut pending = participants.iter().copied().collect();
        while let Some((participant, answer)) = self.peers.next_reply(&mut pending, |_| deadline)? {
            let message = match answer {
                Ok(message) => message,
                Err(error) => {
                    failures.push((participant, error));
                    continue;
                }
            };
            let before = self.solved[participant];
            let fault = audit::report_fault(message.header(), before.received);
            fault.map_or(Ok(()), |what| Err(self.peers.misbehaved(participant, what)))?;
            let sent = before.sent;
            self.solved[participant] = SolveRecord { sent, ..SolveRecord::of(message.header()) };
            longest = longest.max(self.solved[participant].model_seconds);
            drop(message);
            self.collect(participant, step, false)?;
        }
        self.computed_seconds += longest;
        self.unanswered = !failures.is_empty();
        first(failures).map_or(Ok(()), Err)
    }

    fn coupling_data(&self) -> &[Part] {
        &self.parts.raw[..self.coupled.len()]
    }

    fn measured_data(&self) -> &[Part] {
        &self.parts.raw[self.coupled.len()..]
    }

    fn send(&mut self, iterate: &[f64], step: &Step) -> Result<(), RunError> {
        self.peers.phase = Phase::Solving(*step);
        self.send_iterate(iterate, step)
    }

    fn returned(&self, returned: &mut [f64]) {
        self.copy_returned(returned);
    }
}
