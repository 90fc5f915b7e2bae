//! A participant as seen by the coordinator: commands go out, replies and heartbeats come in.

use super::advance::Advance;
use super::patience::Patience;
use super::slot::ParticipantSlot;
use crate::error::RunError;
use contract::configuration::Refusal;
use contract::message::{Command, Failure, ProgressReport, Reply, Status};
use proto::transport::{Beat, Endpoint, Message, Receiver, Ringer, Sender, TransportError};
use std::cell::{Cell, RefCell};
use std::time::{Duration, Instant};

/// Time between two heartbeats from which on the second was rung after the first had been received.
const APART: Duration = Duration::from_millis(10);

/// A participant of a run.
#[derive(Debug)]
pub struct Peer {
    role: String,
    program: String,
    attached: bool,
    commands: Sender<Command>,
    replies: Receiver<Reply>,
    /// Progress reports; opened at the first heartbeat that arrives while a command is being worked
    /// on.
    reports: Option<Receiver<ProgressReport>>,
    ringer: Ringer,
    sequence: u64,
    /// Whether the reply to the last command is still to come.
    owing: Cell<bool>,
    /// A failed reply that arrived during a wait for another participant.
    early: RefCell<Option<Message<Reply>>>,
    silence: Patience,
    /// Number of heartbeats that say that the last command has been dealt with, and time of the
    /// last of them.
    dealt_with: u32,
    last_dealt_with: Option<Instant>,
    /// Whether a heartbeat has arrived since the progress reports were read.
    has_beaten: bool,
    /// Progress with the last command, if the participant reports it.
    advance: Option<Advance>,
}

impl Peer {
    pub(super) fn new(
        slot: &ParticipantSlot,
        commands: Sender<Command>,
        replies: Receiver<Reply>,
        ringer: Ringer,
    ) -> Self {
        Self {
            role: slot.role.clone(),
            program: slot.program.name(),
            attached: slot.attach,
            commands,
            replies,
            reports: None,
            ringer,
            sequence: 0,
            owing: Cell::new(false),
            early: RefCell::new(None),
            silence: Patience::new(),
            dealt_with: 0,
            last_dealt_with: None,
            has_beaten: false,
            advance: None,
        }
    }

    /// Returns the role that the participant plays.
    #[must_use]
    pub fn role(&self) -> &str {
        &self.role
    }

    /// Returns whether the participant was started by hand.
    #[must_use]
    pub fn is_attached(&self) -> bool {
        self.attached
    }

    /// Returns role and program, for messages.
    #[must_use]
    pub fn who(&self) -> String {
        format!("{} ({})", self.role, self.program)
    }

    /// Returns whether the participant has joined.
    pub(super) fn is_up(&self) -> bool {
        self.commands.is_heard() && self.replies.is_served()
    }

    /// Sends a command and returns it with its sequence number.
    pub(super) fn post(
        &mut self,
        mut command: Command,
        body: &[u8],
    ) -> Result<Command, TransportError> {
        self.sequence += 1;
        command.sequence = self.sequence;
        self.commands.send(&command, body)?;
        // Silence counts from here: heartbeats are only received during a wait.
        self.silence = Patience::new();
        self.owing.set(true);
        (self.dealt_with, self.last_dealt_with, self.advance) = (0, None, None);
        self.has_beaten = false;
        self.ringer.ring()?;
        Ok(command)
    }

    /// Returns the sequence number of the last command.
    #[must_use]
    pub fn sequence(&self) -> u64 {
        self.sequence
    }

    pub(super) fn receive(&self) -> Result<Option<Message<Reply>>, TransportError> {
        let message = match self.early.take() {
            Some(early) => Some(early),
            None => self.replies.receive()?,
        };
        self.owing.set(self.owing.get() && message.is_none());
        Ok(message)
    }

    /// Returns whether a reply that is due has arrived and reports a failure. A reply that reports
    /// success is stored for [`Peer::receive`].
    pub(super) fn has_failed(&self) -> Result<bool, TransportError> {
        let mut early = self.early.borrow_mut();
        if self.owing.get() && early.is_none() {
            *early = self.replies.receive()?;
        }
        let failed = |reply: &Message<Reply>| reply.header().status != Status::Done as u32;
        Ok(early.as_ref().is_some_and(failed))
    }

    /// Notes a heartbeat.
    pub(super) fn beat_received(&mut self, beat: Beat) {
        self.silence = Patience::new();
        self.has_beaten = true;
        let now = Instant::now();
        let apart = self.last_dealt_with.is_none_or(|last| now - last >= APART);
        if beat == Beat::idle_after(self.sequence) && apart {
            self.dealt_with += 1;
            self.last_dealt_with = Some(now);
        }
    }

    /// Returns whether a heartbeat has brought a progress report on the last command. If the topic
    /// cannot be opened, for lack of shared memory, the next heartbeat tries again.
    pub(super) fn has_advanced(&mut self, endpoint: &Endpoint) -> Result<bool, TransportError> {
        if !std::mem::take(&mut self.has_beaten) {
            return Ok(false);
        }
        if self.reports.is_none() {
            let opened = endpoint.progress_receiver(&self.role);
            self.reports = opened.inspect_err(|error| tracing::debug!(%error, "no progress")).ok();
        }
        let Some(reports) = &self.reports else { return Ok(false) };
        let Some(report) = reports.receive()?.map(|message| *message.header()) else {
            return Ok(false);
        };
        let current = report.sequence == self.sequence;
        let next = current.then(|| Advance::after(self.advance, report, Instant::now())).flatten();
        self.advance = next.or(self.advance);
        Ok(next.is_some())
    }

    /// Returns the progress with the last command and the remaining time; `None` without a report.
    pub(super) fn advance(&self) -> Option<(ProgressReport, Option<Duration>)> {
        self.advance.map(|advance| (advance.newest(), advance.left()))
    }

    /// Returns whether the participant has dealt with the last command, according to three
    /// heartbeats.
    ///
    /// Two such heartbeats may still refer to an earlier command with a similar number: one that
    /// was rung before and not yet received, and one that was being made when the thread lost the
    /// processor. The third one was made after the second had been received.
    pub(super) fn has_dealt_with_it(&self) -> bool {
        self.dealt_with >= 3
    }

    /// Returns the time since the last sign of life, not counting time in which this process did
    /// not run.
    pub(super) fn silence(&mut self) -> Duration {
        self.silence.waited()
    }

    /// Returns the error for a refused case.
    pub(super) fn refused(&self, body: &[u8]) -> RunError {
        let refusal = serde_json::from_slice(body).unwrap_or_else(|_| {
            Refusal::new(&self.role, "refused without a reason", "ask the program's author")
        });
        RunError::Refused { role: self.role.clone(), refusal }
    }
}

/// Returns the reason in a failed reply.
pub(super) fn failure_text(body: &[u8]) -> String {
    serde_json::from_slice::<Failure>(body)
        .map_or_else(|_| "it failed without saying why".to_owned(), |failure| failure.error)
}
