//! The windows of a run: solved, accepted, and the end after the last one.

use super::solved::SolveRecord;
use super::{Observed, Session, audit};
use crate::crew;
use crate::error::RunError;
use crate::peers::{Participants, Phase};
use contract::message::{Command, CommandKind, FIGURES, Finished, OBSERVE, STAY};
use contract::step::Step;
use coupling::{Exchange, Part, ParticipantIndex};

impl Session {
    /// Makes the last solve of every participant its accepted state. Fields of those which are
    /// observed are published and received, and figures of those which describe any. Grids that move
    /// are where they have moved to thereafter.
    pub fn accept(&mut self, step: &Step, observed: Observed) -> Result<(), RunError> {
        // Nothing else looks through what was sent last in an explicit scheme before it is kept.
        self.taps.keys().try_for_each(|tap| self.check_finite(tap))?;
        self.peers.phase = Phase::Accepting(*step);
        self.check_live()?;
        let (mut observing, mut pending) = (Participants::new(), Participants::new());
        for one in self.peers.all().keys() {
            let observe = self.is_observed(one, observed);
            let figures = self.figures.are_asked_of(one);
            let answer = observe || figures || self.has_moving_grids(one);
            observing.extend(observe.then_some(one));
            pending.extend(answer.then_some(one));
            let mut command = Command::about(CommandKind::Accept, step);
            command.flags = if observe { OBSERVE } else { 0 } | if figures { FIGURES } else { 0 };
            self.peers.post(one, command, &[], answer)?;
        }
        self.keep_geometry();
        let deadline = self.peers.deadlines().solve;
        let mut failures = Vec::new();
        while let Some((one, answer)) = self.peers.next_reply(&mut pending, |_| deadline)? {
            let message = match answer {
                Ok(message) => message,
                Err(error) => {
                    failures.push((one, error));
                    continue;
                }
            };
            if self.figures.are_asked_of(one) {
                let taken = self.figures.take(one, message.body());
                taken.map_err(|what| self.peers.misbehaved(one, what))?;
            }
            drop(message);
            if observing.contains(&one) {
                self.collect(one, step, true)?;
            }
            self.receive_geometry(one, step)?;
        }
        if let Some(error) = first(failures) {
            self.unanswered = true;
            return Err(error);
        }
        if !observing.is_empty() {
            self.taps.keys().try_for_each(|tap| self.check_finite(tap))?;
        }
        Ok(())
    }

    /// The window has no answer that may be accepted.
    pub fn no_answer(&mut self) {
        self.unanswered = true;
    }

    /// What is behind the error of a participant ([`crate::peers::Peers::cause`]).
    #[must_use]
    pub fn cause(&self, error: RunError) -> RunError {
        self.peers.cause(error)
    }

    /// The last error was that a participant has no answer: all others go on.
    pub fn take_unanswered(&mut self) -> bool {
        std::mem::take(&mut self.unanswered)
    }

    fn is_observed(&self, one: ParticipantIndex, observed: Observed) -> bool {
        let mut own = self.taps.iter().filter(|tap| tap.producer == one).peekable();
        match observed {
            Observed::Everybody => true,
            Observed::Unconsumed => own.peek().is_some() && own.all(|tap| tap.observed_only),
            Observed::Nobody => false,
        }
    }

    /// Asks every participant for its summary and lets it go, or stay for the next run.
    ///
    /// # Errors
    /// A participant fails, has ended, is late, or reports negative times.
    pub fn finish(mut self) -> Result<(Vec<Finished>, Option<Leaving>), RunError> {
        self.peers.phase = Phase::Finishing;
        if let Some(recorder) = self.peers.recorder() {
            recorder.stop_listening()?;
        }
        self.tell_mappings();
        let stay = self.reusable && crew::stays();
        let flags = if stay { STAY } else { 0 };
        for one in self.peers.all().keys() {
            let command = Command { flags, ..Command::new(CommandKind::Finish) };
            self.peers.post(one, command, &[], true)?;
        }
        let mut finished = Vec::with_capacity(self.peers.all().len());
        let deadline = self.peers.deadlines().solve;
        let mut pending = self.peers.all().keys().collect();
        while let Some((one, answer)) = self.peers.next_reply(&mut pending, |_| deadline)? {
            let said: Finished = serde_json::from_slice(answer?.body()).map_err(|e| {
                self.peers.misbehaved(one, format!("its summary is not valid: {e}"))
            })?;
            let (model, processor) = (said.model_seconds, said.cpu_seconds);
            if model < 0.0 || processor < 0.0 {
                let what = format!("model_seconds is {model} s, cpu_seconds {processor} s");
                return Err(self.peers.misbehaved(one, what));
            }
            finished.push(said);
        }
        if stay {
            let Self { guard, peers, taps, feedback, mapped, moving, live, memory, .. } = self;
            guard.spare();
            // The next run has the same ports.
            drop((taps, feedback, mapped, moving, live));
            crew::stay(peers.after_run(memory.taken()));
            return Ok((finished, None));
        }
        Ok((finished, Some(Leaving(self))))
    }
}

/// Participants that have been asked to leave. Their exits are waited for when this is dropped, so
/// that results are written meanwhile.
#[derive(Debug)]
#[must_use]
pub struct Leaving(Session);

impl Drop for Leaving {
    /// Ends those that do not leave.
    fn drop(&mut self) {
        self.0.peers.wait_for_exits();
    }
}

/// The error of the first participant in the plan's order, whichever has failed first in time.
fn first(failures: Vec<(ParticipantIndex, RunError)>) -> Option<RunError> {
    failures.into_iter().min_by_key(|(one, _)| *one).map(|(_, error)| error)
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
        for &one in participants {
            let mut command = Command::about(CommandKind::Solve, step);
            for tap in &self.taps {
                for reader in tap.readers().iter().filter(|r| r.participant == one) {
                    command.expected[reader.slot] = tap.sequence();
                }
            }
            for feedback in &self.feedback {
                for reader in feedback.readers.iter().filter(|r| r.participant == one) {
                    command.expected[reader.slot] = feedback.sequence();
                }
            }
            for sent in &self.live.sent {
                for reader in sent.readers.iter().filter(|r| r.participant == one) {
                    command.expected[reader.slot] = sent.outlet.sequence();
                }
            }
            for mapped in self.mapped.iter().filter(|m| m.reader.participant == one) {
                command.expected[mapped.reader.slot] = mapped.outlet().sequence();
            }
            self.peers.post(one, command, &[], true)?;
        }
        // While they compute, what was sent before is audited, recorded and looked through.
        for &one in participants {
            let Self { taps, feedback, mapped, .. } = &*self;
            self.solved[one].heat_sent = audit::commanded(taps, feedback, mapped, one);
        }
        if let Some(recorder) = self.peers.recorder() {
            recorder.hand_over();
        }
        self.taps.keys().try_for_each(|tap| self.check_finite(tap))?;
        let mut longest = 0.0_f64;
        let (deadline, mut failures) = (self.peers.deadlines().solve, Vec::new());
        let mut pending = participants.iter().copied().collect();
        while let Some((one, answer)) = self.peers.next_reply(&mut pending, |_| deadline)? {
            let message = match answer {
                Ok(message) => message,
                Err(error) => {
                    failures.push((one, error));
                    continue;
                }
            };
            let before = self.solved[one];
            let fault = audit::report_fault(message.header(), before.heat_received);
            fault.map_or(Ok(()), |what| Err(self.peers.misbehaved(one, what)))?;
            let heat_sent = before.heat_sent;
            self.solved[one] = SolveRecord { heat_sent, ..SolveRecord::of(message.header()) };
            longest = longest.max(self.solved[one].model_seconds);
            drop(message);
            self.collect(one, step, false)?;
        }
        self.computed_seconds += longest;
        self.unanswered = !failures.is_empty();
        first(failures).map_or(Ok(()), Err)
    }

    fn coupling_data(&self) -> &[Part] {
        &self.parts.raw
    }

    fn send(&mut self, iterate: &[f64], step: &Step) -> Result<(), RunError> {
        self.peers.phase = Phase::Solving(*step);
        self.send_iterate(iterate, step)
    }

    fn returned(&self, returned: &mut [f64]) {
        self.copy_returned(returned);
    }
}
