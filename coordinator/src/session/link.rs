//! The control link to one participant.

use crate::error::RunError;
use proto::configuration::Refusal;
use proto::message::{Command, Failure, Reply};
use proto::transport::{Message, Receiver, Ringer, Sender, TransportError};
use std::time::{Duration, Instant};

/// Commands go out, replies come in.
#[derive(Debug)]
pub(crate) struct Link {
    role: String,
    program: String,
    attached: bool,
    commands: Sender<Command>,
    replies: Receiver<Reply>,
    ringer: Ringer,
    sequence: u64,
    alive: Instant,
}

impl Link {
    pub(crate) fn new(
        (role, program): (&str, String),
        attached: bool,
        commands: Sender<Command>,
        replies: Receiver<Reply>,
        ringer: Ringer,
    ) -> Self {
        let (role, alive) = (role.to_owned(), Instant::now());
        Self { role, program, attached, commands, replies, ringer, sequence: 0, alive }
    }

    pub(crate) fn role(&self) -> &str {
        &self.role
    }

    /// It was started by hand.
    pub(crate) fn is_attached(&self) -> bool {
        self.attached
    }

    /// Role and program, for messages.
    pub(crate) fn who(&self) -> String {
        format!("{} ({})", self.role, self.program)
    }

    /// The participant has joined.
    pub(crate) fn is_up(&self) -> bool {
        self.commands.is_heard() && self.replies.is_served()
    }

    /// Sends a command, and gives it back with its number; `ring` only when an answer is wanted
    /// soon.
    pub(crate) fn post(
        &mut self,
        mut command: Command,
        body: &[u8],
        ring: bool,
    ) -> Result<Command, TransportError> {
        self.sequence += 1;
        command.sequence = self.sequence;
        self.commands.send(&command, body)?;
        // Silence counts from here: heartbeats are only heard while waiting.
        self.alive = Instant::now();
        if ring {
            self.ringer.ring()?;
        }
        Ok(command)
    }

    /// Sequence number of the last command.
    pub(crate) fn sequence(&self) -> u64 {
        self.sequence
    }

    pub(crate) fn receive(&self) -> Result<Option<Message<Reply>>, TransportError> {
        self.replies.receive()
    }

    pub(crate) fn heard_heart(&mut self) {
        self.alive = Instant::now();
    }

    /// Time since the last sign of life.
    pub(crate) fn silence(&self) -> Duration {
        self.alive.elapsed()
    }

    /// The error for a refused case.
    pub(crate) fn refused(&self, body: &[u8]) -> RunError {
        let refusal = serde_json::from_slice(body).unwrap_or_else(|_| {
            Refusal::new(&self.role, "refused without a reason", "ask the program's author")
        });
        RunError::Refused { role: self.role.clone(), refusal }
    }
}

/// What a failed reply says.
pub(crate) fn failure_text(body: &[u8]) -> String {
    serde_json::from_slice::<Failure>(body)
        .map_or_else(|_| "it failed without saying why".to_owned(), |failure| failure.error)
}
