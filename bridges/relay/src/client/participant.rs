//! Local ports that represent the remote participant, and its relayed heartbeat.

use crate::link::LivenessSink;
use contract::message::{Command, ProgressReport, Reply};
use proto::command_ports::{CommandPorts, ProgressReports};
use proto::run_dir::RunInfo;
use proto::transport::{
    Beat, Doorbell, Endpoint, Message, Receiver, Ringer, Sender, TransportError,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Activity of the participant: the number of the last completed command, or this value while busy.
const BUSY: u64 = u64::MAX;

/// Ports of the participant.
pub(super) struct LocalParticipant {
    commands: Receiver<Command>,
    replies: Sender<Reply>,
    coordinator: Ringer,
    doorbell: Doorbell,
    activity: Arc<AtomicU64>,
    // Last field: ports must close before the node that owns them.
    pub(super) endpoint: Arc<Endpoint>,
}

/// Heartbeat of the remote participant, passed on to the coordinator.
struct Heart {
    index: usize,
    coordinator: Ringer,
    reports: ProgressReports,
    newest: Option<ProgressReport>,
    activity: Arc<AtomicU64>,
}

impl LocalParticipant {
    /// Joins the run under this role. Also returns the receiver of the remote participant's
    /// heartbeat.
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

    /// Waits for the next command. The process ends if the coordinator dies.
    pub(super) fn command(&self) -> Result<Message<Command>, TransportError> {
        let command = self.doorbell.wait(|| self.commands.receive(), |_, _| ())?;
        self.activity.store(BUSY, Ordering::Release);
        Ok(command)
    }

    pub(super) fn reply(&self, reply: &Reply, body: &[u8]) -> Result<(), TransportError> {
        self.replies.send(reply, body)?;
        self.coordinator.ring()
    }

    /// Marks the command with this number as completed.
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
