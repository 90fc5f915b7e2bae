//! Reasons why a wait for a participant ended early.

use super::peer::Peer;
use super::phase::Phase;
use crate::error::{Failure, RunError, machine_failure};
use crate::supervise::Exit;
use contract::message::ProgressReport;
use coupling::ParticipantIndex;
use proto::transport::TransportError;
use std::time::Duration;
use typed_index_collections::TiSlice;

/// Advice for a participant that failed. Before a run there is no `log.jsonl`.
pub(super) const MESSAGES: &str = "see its messages in log.jsonl, or with --log info";

/// Reason why a wait ended early.
#[derive(Debug)]
pub enum Stopped {
    /// The user has interrupted the run with this signal.
    Interrupted(&'static str),
    /// A process has ended.
    Exited(Exit),
    /// A participant that was started by hand has ended.
    Gone(ParticipantIndex),
    /// The participant has dealt with the command, but its reply is missing.
    ReplyLost(ParticipantIndex),
    /// No heartbeat of the participant for this long.
    Silent(ParticipantIndex, Duration),
    /// No answer and no progress of the participant for this long, nor a heartbeat for
    /// [`Delay::silence`].
    Late(ParticipantIndex, Delay),
    /// The exchange with the participant failed.
    Transport(ParticipantIndex, TransportError),
    /// The coordinator's own doorbell failed.
    Doorbell(TransportError),
}

/// Delay of a participant that is alive.
#[derive(Clone, Copy, Debug)]
pub struct Delay {
    /// Time without an answer and without progress.
    pub waited: Duration,
    /// Time since the last heartbeat.
    pub silence: Duration,
}

impl Delay {
    /// Time without a heartbeat from which on it is mentioned: many beats.
    const QUIET: Duration = Duration::from_secs(1);

    /// Formats what is known of the heartbeat.
    fn heartbeat(self) -> String {
        match self.silence >= Self::QUIET.min(self.waited) {
            false => "its heartbeat is still received".to_owned(),
            true => format!("its last heartbeat was {:.1} s ago", self.silence.as_secs_f64()),
        }
    }
}

impl From<TransportError> for Stopped {
    fn from(error: TransportError) -> Self {
        Self::Doorbell(error)
    }
}

impl Stopped {
    /// Returns the reason as the error of a run.
    pub(super) fn error(self, peers: &TiSlice<ParticipantIndex, Peer>, phase: Phase) -> RunError {
        let (when, failed) =
            (phase.to_string(), |participant: ParticipantIndex, what: String, fix: &str| {
                let (who, when) = (peers[participant].who(), phase.to_string());
                RunError::Failed(Failure { who, when, what, fix: fix.to_owned() })
            });
        match self {
            Self::Interrupted(signal) => RunError::Interrupted { signal, when },
            Self::Exited(exit) => ended(peers, &exit, when),
            Self::Gone(participant) => failed(
                participant,
                "its process is gone".to_owned(),
                "see its messages in the terminal that started it",
            ),
            Self::ReplyLost(participant) => failed(
                participant,
                "it has processed the last command, but its reply did not arrive".to_owned(),
                "a message was lost in shared memory: see log.jsonl, `ulimit -n` and /dev/shm",
            ),
            Self::Silent(participant, silence) => failed(
                participant,
                format!("no heartbeat for {:.1} s", silence.as_secs_f64()),
                "it is stopped or its machine is overloaded; raise coupling.heartbeat_deadline \
                 if it may pause for so long",
            ),
            Self::Late(participant, delay) => {
                let (what, fix) =
                    late(phase, delay, peers[participant].advance().map(|(report, _)| report));
                failed(participant, what, &fix)
            }
            Self::Transport(participant, error) => failed(participant, error.to_string(), MESSAGES),
            Self::Doorbell(error) => machine_failure(
                "the coordinator's doorbell",
                &when,
                &error,
                "check `ulimit -n` and the free space of /tmp and /dev/shm",
            ),
        }
    }
}

/// Returns description and fix for a participant that is alive but has not answered in time.
fn late(phase: Phase, delay: Delay, reached: Option<ProgressReport>) -> (String, String) {
    let (seconds, heartbeat) = (delay.waited.as_secs_f64(), delay.heartbeat());
    let (what, key) = match phase {
        Phase::Starting => {
            let what = format!("it did not join within {seconds:.1} s");
            return (what, "raise coupling.start_deadline if it needs longer".to_owned());
        }
        Phase::Initialising => ("it is still building its model", "coupling.build_deadline"),
        Phase::Configuring => {
            ("no answer", "coupling.start_deadline (in a run, coupling.solve_deadline)")
        }
        _ => ("no answer", "coupling.solve_deadline"),
    };
    let what = match reached {
        None => format!("{what} after {seconds:.1} s; {heartbeat}"),
        Some(reached) => {
            format!("it stopped at {reached}: no progress for {seconds:.1} s; {heartbeat}")
        }
    };
    (what, format!("raise {key} if it needs longer"))
}

fn ended(peers: &TiSlice<ParticipantIndex, Peer>, exit: &Exit, when: String) -> RunError {
    let peer = peers.iter().find(|peer| peer.role() == exit.role);
    RunError::Failed(Failure {
        who: peer.map_or_else(|| exit.role.clone(), Peer::who),
        when,
        what: format!("its process {exit}"),
        fix: MESSAGES.to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use typed_index_collections::TiVec;

    /// A process that is stopped sends no heartbeat, even if the deadline is shorter than the
    /// patience with heartbeats.
    #[test]
    fn a_heartbeat_is_claimed_only_if_it_was_received() {
        let told = |waited: u64, silence: u64| {
            let [waited, silence] = [waited, silence].map(Duration::from_millis);
            late(Phase::Connecting, Delay { waited, silence }, None).0
        };
        assert_eq!(told(2000, 60), "no answer after 2.0 s; its heartbeat is still received");
        assert_eq!(told(2000, 2010), "no answer after 2.0 s; its last heartbeat was 2.0 s ago");
        assert_eq!(told(300, 310), "no answer after 0.3 s; its last heartbeat was 0.3 s ago");
    }

    #[test]
    fn a_failure_of_the_own_doorbell_is_nobody_elses() {
        let cause = TransportError::Exchange {
            service: "coordinator".to_owned(),
            cause: "too many open files".to_owned(),
        };
        let error = Stopped::from(cause).error(&TiVec::new(), Phase::Finishing).to_string();
        assert!(error.starts_with("the coordinator's doorbell failed"), "{error}");
        assert!(error.contains("too many open files"), "{error}");
    }
}
