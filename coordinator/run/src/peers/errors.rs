//! Errors about participants, as the errors of a run.

use super::peer::Peer;
use super::stopped;
use super::{Peers, Stopped};
use crate::error::{Failure, RunError};
use crate::supervise::Exit;
use coupling::ParticipantIndex;
use proto::transport::TransportError;
use std::time::{Duration, Instant};

impl Peers {
    /// Returns the error of a participant that failed for this reason.
    #[must_use]
    pub fn failed(&self, participant: ParticipantIndex, what: String) -> RunError {
        self.failure(participant, what, stopped::MESSAGES.to_owned())
    }

    /// Returns the error of a participant that violated the contract.
    #[must_use]
    pub fn misbehaved(&self, participant: ParticipantIndex, what: String) -> RunError {
        let fix = "the program violates the participant contract (docs/ARCHITECTURE.md)";
        self.failure(participant, what, fix.to_owned())
    }

    /// Returns the error of a participant that failed in the current phase.
    #[must_use]
    pub fn failure(&self, participant: ParticipantIndex, what: String, fix: String) -> RunError {
        let (who, when) = (self.all[participant].who(), self.phase.to_string());
        RunError::Failed(Failure { who, when, what, fix })
    }

    /// Returns the error of a failed exchange with a participant.
    #[must_use]
    pub fn transport_failed(
        &self,
        participant: ParticipantIndex,
        error: TransportError,
    ) -> RunError {
        self.error(Stopped::Transport(participant, error))
    }

    /// Returns the reason why a wait ended early as the error of a run.
    #[must_use]
    pub fn error(&self, stopped: Stopped) -> RunError {
        let stopped = match stopped {
            Stopped::Transport(participant, error) => {
                self.exit_soon().map_or(Stopped::Transport(participant, error), Stopped::Exited)
            }
            other => other,
        };
        stopped.error(&self.all, self.phase)
    }

    /// Returns the actual cause of a participant's error: the end of another participant's process,
    /// if there was one, or else the error itself.
    #[must_use]
    pub fn cause(&self, error: RunError) -> RunError {
        let RunError::Failed(failure) = &error else { return error };
        let is_other = |exit: &Exit| {
            let own = |peer: &Peer| peer.role() == exit.role && peer.who() == failure.who;
            !exit.is_success() && !self.all.iter().any(own)
        };
        match self.exit_soon().filter(is_other) {
            Some(exit) => self.error(Stopped::Exited(exit)),
            None => error,
        }
    }

    /// Returns a process that ends within 100 ms: the cause of an error often is that a participant
    /// has just died.
    fn exit_soon(&self) -> Option<Exit> {
        let until = Instant::now() + Duration::from_millis(100);
        while Instant::now() < until {
            if let Some(exit) = self.exits().into_iter().next() {
                return Some(exit);
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        None
    }
}
