//! The place of the participant in the run: its ports, and the heart that beats as its own does.

use crate::link::LivenessSink;
use contract::message::{Command, ProgressReport, Reply};
use proto::command_ports::{CommandPorts, ProgressReports};
use proto::run_dir::RunInfo;
use proto::transport::{
    Beat, Doorbell, Endpoint, Message, Receiver, Ringer, Sender, TransportError,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// What the participant does: the number of the last command that it has dealt with, or this.
const BUSY: u64 = u64::MAX;

/// The ports of a participant.
pub(super) struct LocalParticipant {
    commands: Receiver<Command>,
    replies: Sender<Reply>,
    coordinator: Ringer,
    doorbell: Doorbell,
    activity: Arc<AtomicU64>,
    // Last: ports close before the node that they belong to.
    pub(super) endpoint: Arc<Endpoint>,
}

/// Heart of the participant at the server, which beats for the coordinator here.
struct Heart {
    index: usize,
    coordinator: Ringer,
    reports: ProgressReports,
    newest: Option<ProgressReport>,
    activity: Arc<AtomicU64>,
}

impl LocalParticipant {
    /// Joins, as the participant of this role; and who hears its signs of life.
    pub(super) fn open(
        run: &RunInfo,
        role: &str,
    ) -> Result<(Self, Box<dyn LivenessSink>), TransportError> {
        let CommandPorts { commands, replies, reports, coordinator, doorbell, endpoint } =
            CommandPorts::open(run, role)?;
        let index = run.roles.iter().position(|known| known == role).unwrap_or_default();
        let activity = Arc::new(AtomicU64::new(0));
        let heart = Heart {
            index,
            coordinator: coordinator.clone(),
            reports,
            newest: None,
            activity: Arc::clone(&activity),
        };
        Ok((Self { commands, replies, coordinator, doorbell, activity, endpoint }, Box::new(heart)))
    }

    /// The next command. That the coordinator dies ends the process.
    pub(super) fn command(&self) -> Result<Message<Command>, TransportError> {
        let command = self.doorbell.wait(|| self.commands.receive(), |_, _| ())?;
        self.activity.store(BUSY, Ordering::Release);
        Ok(command)
    }

    pub(super) fn reply(&self, reply: &Reply, body: &[u8]) -> Result<(), TransportError> {
        self.replies.send(reply, body)?;
        self.coordinator.ring()
    }

    /// The command with this number has been dealt with.
    pub(super) fn idle_after(&self, command: u64) {
        self.activity.store(command, Ordering::Release);
    }
}

impl LivenessSink for Heart {
    fn beat(&mut self) {
        let beat = match self.activity.load(Ordering::Acquire) {
            BUSY => Beat::Busy,
            command => Beat::idle_after(command),
        };
        if let Err(error) = self.coordinator.beat(self.index, beat) {
            tracing::warn!(%error, "the heartbeat does not reach the coordinator");
        }
        self.report();
    }

    fn progress(&mut self, report: ProgressReport) {
        self.newest = Some(report);
        self.report();
    }
}

impl Heart {
    fn report(&mut self) {
        if let Err(error) = self.reports.send(self.newest) {
            tracing::debug!(%error, "progress does not reach the coordinator");
        }
    }
}
