//! Waits for participants: until they join, until they reply, or until something else happens.

use super::peer::{self, Peer};
use super::{Answer, Delay, Participants, Patience, Peers, Phase, Stopped, exits};
use crate::deadlines::Deadlines;
use crate::error::RunError;
use crate::progress::{Progress, Work};
use crate::signals;
use crate::supervise::{Exit, Supervisor};
use contract::message::{Reply, Status};
use coupling::ParticipantIndex;
use proto::run_dir::RunDir;
use proto::transport::{Beat, Message};
use std::cell::RefCell;
use std::time::{Duration, Instant};
use typed_index_collections::TiSlice;

impl Peers {
    /// Waits until every participant has joined.
    ///
    /// # Errors
    /// A participant has ended or is late, or the user has interrupted the run.
    pub fn join(&mut self) -> Result<(), RunError> {
        for participant in self.all.keys() {
            let attached = self.all[participant].is_attached();
            let patience = if attached { self.deadlines.solve } else { self.deadlines.start };
            self.joined(participant, patience).map_err(|stopped| self.error(stopped))?;
        }
        Ok(())
    }

    /// Waits until a participant has joined.
    ///
    /// # Errors
    /// The reason why the wait ended early.
    pub fn joined(
        &mut self,
        participant: ParticipantIndex,
        patience: Duration,
    ) -> Result<(), Stopped> {
        let mut waited = Patience::new();
        let Self { all, doorbell, supervisor, run, deadlines, phase, .. } = self;
        let watch = Watch { supervisor, run, phase: *phase, deadlines };
        let failed = |error| Stopped::Transport(participant, error);
        let poll = || -> Result<_, Stopped> {
            // A participant that has not joined has no heartbeat yet.
            all[participant].beat_received(Beat::Busy);
            if all[participant].is_up() {
                // Connects to the replies of the participant. From here on its last reply is
                // received, even if its process has ended by then.
                all[participant].receive().map_err(failed)?;
                return Ok(Some(()));
            }
            watch.look(all, participant, waited.waited(), patience)?;
            Ok(None)
        };
        doorbell.wait(poll, |_, _| ())
    }

    /// Waits for the reply to the last command of a participant. `beat` is called at every
    /// heartbeat. The patience starts anew whenever the participant reports progress.
    ///
    /// # Errors
    /// The reason why the wait ended early.
    pub fn wait(
        &mut self,
        participant: ParticipantIndex,
        patience: Duration,
        beat: impl FnMut(),
    ) -> Result<Message<Reply>, Stopped> {
        self.wait_for(&[participant], patience, beat).map(|(_, reply)| reply)
    }

    /// Waits for the reply of the first of these participants, or for an earlier failed reply of
    /// any other. Returns the participant with its reply. All other replies stay in their queues.
    fn wait_for(
        &mut self,
        pending: &[ParticipantIndex],
        patience: Duration,
        mut beat: impl FnMut(),
    ) -> Result<(ParticipantIndex, Message<Reply>), Stopped> {
        let participant = pending[0];
        let Self {
            all,
            hearts,
            doorbell,
            endpoint,
            supervisor,
            run,
            deadlines,
            phase,
            recorder,
            screen,
            ..
        } = self;
        let watch = Watch { supervisor, run, phase: *phase, deadlines };
        let all = RefCell::new(all);
        let mut waited = Patience::new();
        let poll = || -> Result<_, Stopped> {
            let mut all = all.borrow_mut();
            if let Some(found) = replied(&all, pending)? {
                return Ok(Some(found));
            }
            let advanced = all[participant].has_advanced(endpoint);
            if advanced.map_err(|error| Stopped::Transport(participant, error))? {
                waited = Patience::new();
                show(&all[participant], *phase, &**screen);
            }
            match watch.look(&mut all, participant, waited.waited(), patience) {
                Ok(()) => Ok(None),
                // A reply sent just before a participant ended still counts.
                Err(reason) => replied(&all, pending)?.map(Some).ok_or(reason),
            }
        };
        let heard = |index: usize, what| {
            if let Some(Some(participant)) = hearts.get(index) {
                all.borrow_mut()[*participant].beat_received(what);
                beat();
            }
        };
        let (who, reply) = doorbell.wait(poll, heard)?;
        if let Some(recorder) = recorder {
            recorder.reply(who, reply.header(), reply.body());
        }
        Ok((who, reply))
    }

    /// Lets time pass while watching processes and signals; `beat` is called at every heartbeat.
    ///
    /// # Errors
    /// A process has ended, or the user has interrupted the run.
    pub fn idle(&mut self, time: Duration, beat: impl FnMut()) -> Result<(), Stopped> {
        let until = Instant::now() + time;
        self.attend(|| (Instant::now() >= until).then_some(()), beat)
    }

    /// Waits for an event that does not come from a participant, while watching processes and
    /// signals. `found` is polled whenever the doorbell of the coordinator rings, and `beat` is
    /// called at every heartbeat.
    ///
    /// # Errors
    /// A process has ended, or the user has interrupted the run.
    pub fn attend<T>(
        &mut self,
        mut found: impl FnMut() -> Option<T>,
        mut beat: impl FnMut(),
    ) -> Result<T, Stopped> {
        let Self { doorbell, supervisor, all, .. } = self;
        let poll = || -> Result<_, Stopped> {
            interrupted_or_exited(supervisor, all, |_| false)?;
            Ok(found())
        };
        doorbell.wait(poll, |_, _| beat())
    }

    /// Waits for the reply to the last command of a participant, whatever its status.
    ///
    /// # Errors
    /// The wait ended early; the reason as the error of a run.
    pub fn reply(
        &mut self,
        participant: ParticipantIndex,
        patience: Duration,
    ) -> Result<Message<Reply>, RunError> {
        self.wait(participant, patience, || ()).map_err(|stopped| self.error(stopped))
    }

    /// Waits for the next reply of the pending participants, and removes its sender from the list.
    /// Returns `None` once the list is empty. Replies come in the order of the list, but a failed
    /// reply comes as soon as it arrives. The inner result is an error if the participant reports a
    /// failure; the others can still be waited for.
    ///
    /// # Errors
    /// A participant refuses the case, violates the contract, has ended, or is late.
    pub fn next_reply(
        &mut self,
        pending: &mut Participants,
        patience: impl Fn(ParticipantIndex) -> Duration,
    ) -> Result<Option<Answer>, RunError> {
        let Some(&first) = pending.first() else { return Ok(None) };
        let waited = self.wait_for(pending, patience(first), || ());
        let (participant, message) = waited.map_err(|stopped| self.error(stopped))?;
        pending.retain(|other| *other != participant);
        Ok(Some((participant, self.judge(participant, message)?)))
    }

    /// Waits for the reply to the last command, and returns an error unless the command succeeded.
    ///
    /// # Errors
    /// The participant refuses or fails, violates the contract, has ended, or is late.
    pub fn done(
        &mut self,
        participant: ParticipantIndex,
        patience: Duration,
    ) -> Result<Message<Reply>, RunError> {
        let message = self.reply(participant, patience)?;
        self.judge(participant, message)?
    }

    /// Checks a reply. The inner result is an error if the command has failed.
    fn judge(
        &self,
        participant: ParticipantIndex,
        message: Message<Reply>,
    ) -> Result<Result<Message<Reply>, RunError>, RunError> {
        let (reply, body) = (message.header(), message.body());
        match Status::from_number(reply.status) {
            _ if reply.protocol != contract::PROTOCOL_VERSION => {
                let theirs = reply.protocol;
                Err(self.misbehaved(participant, format!("it speaks protocol {theirs}")))
            }
            _ if reply.sequence != self.all[participant].sequence() => {
                let (found, expected) = (reply.sequence, self.all[participant].sequence());
                Err(self.misbehaved(
                    participant,
                    format!("it answered command {found} instead of {expected}"),
                ))
            }
            Some(Status::Done) => Ok(Ok(message)),
            Some(Status::Refused) => Err(self.all[participant].refused(body)),
            Some(Status::Failed) => Ok(Err(self.failed(participant, peer::failure_text(body)))),
            None => {
                let status = reply.status;
                Err(self.misbehaved(
                    participant,
                    format!("it replied with the unknown status {status}"),
                ))
            }
        }
    }
}

/// Shows the progress of a participant.
fn show(peer: &Peer, phase: Phase, screen: &dyn Progress) {
    if let Some((report, left)) = peer.advance() {
        screen.working(&Work { role: peer.role(), doing: phase.doing(), report, left });
    }
}

/// Returns the reply of the first of these participants, or a failed reply of any other.
fn replied(
    all: &TiSlice<ParticipantIndex, Peer>,
    pending: &[ParticipantIndex],
) -> Result<Option<(ParticipantIndex, Message<Reply>)>, Stopped> {
    for (place, &participant) in pending.iter().enumerate() {
        let failed = |error| Stopped::Transport(participant, error);
        if (place == 0 || all[participant].has_failed().map_err(failed)?)
            && let Some(message) = all[participant].receive().map_err(failed)?
        {
            return Ok(Some((participant, message)));
        }
    }
    Ok(None)
}

/// Conditions that are watched while waiting.
struct Watch<'a> {
    supervisor: &'a Supervisor,
    run: &'a RunDir,
    phase: Phase,
    deadlines: &'a Deadlines,
}

impl Watch<'_> {
    /// Returns an error if there is a reason to stop waiting.
    fn look(
        &self,
        all: &mut TiSlice<ParticipantIndex, Peer>,
        participant: ParticipantIndex,
        waited: Duration,
        patience: Duration,
    ) -> Result<(), Stopped> {
        // A participant that has been asked to finish may have ended regularly, unless the wait is
        // for its reply.
        let in_peace =
            |role: &str| self.phase == Phase::Finishing && role != all[participant].role();
        let left = |exit: &Exit| in_peace(&exit.role) && exit.is_success();
        interrupted_or_exited(self.supervisor, all, left)?;
        // A participant started by hand is not a child process: its lock shows its death.
        let has_left = |peer: &Peer| {
            peer.is_attached() && !in_peace(peer.role()) && self.run.has_left(peer.role())
        };
        if self.phase != Phase::Starting
            && let Some(gone) = all.position(has_left)
        {
            return Err(Stopped::Gone(gone));
        }
        if all[participant].has_dealt_with_it() {
            return Err(Stopped::ReplyLost(participant));
        }
        let silence = all[participant].silence();
        if silence > self.deadlines.heartbeat {
            return Err(Stopped::Silent(participant, silence));
        }
        if waited > patience {
            return Err(Stopped::Late(participant, Delay { waited: patience, silence }));
        }
        Ok(())
    }
}

/// Returns an error if the user has interrupted the run, or a process has ended unexpectedly.
fn interrupted_or_exited(
    supervisor: &Supervisor,
    all: &TiSlice<ParticipantIndex, Peer>,
    in_peace: impl Fn(&Exit) -> bool,
) -> Result<(), Stopped> {
    if let Some(signal) = signals::received() {
        return Err(Stopped::Interrupted(signal));
    }
    match exits(supervisor, all).into_iter().find(|exit| !in_peace(exit)) {
        Some(exit) => {
            let signal = exit.status.and_then(signals::received_like);
            Err(signal.map_or(Stopped::Exited(exit), Stopped::Interrupted))
        }
        None => Ok(()),
    }
}
