//! Ports of a participant for commands, replies, progress and doorbells.

use crate::message::{Command, ProgressReport, Reply};
use crate::run_dir::RunInfo;
use crate::transport::{Doorbell, Endpoint, Receiver, Ringer, Sender, TransportError};
use std::sync::Arc;

/// Ports that a participant opens when it joins a run.
#[derive(Debug)]
pub struct CommandPorts {
    /// Commands to the participant.
    pub commands: Receiver<Command>,
    /// Replies of the participant.
    pub replies: Sender<Reply>,
    /// Progress reports of the participant.
    pub reports: ProgressReports,
    /// Doorbell of the coordinator.
    pub coordinator: Ringer,
    /// Doorbell of the participant.
    pub doorbell: Doorbell,
    // Last: ports must close before their node.
    /// Endpoint that opens further ports.
    pub endpoint: Arc<Endpoint>,
}

impl CommandPorts {
    /// Joins a run in this role and notifies the coordinator.
    ///
    /// # Errors
    /// Fails if the shared memory of the run does not exist or cannot be used.
    pub fn open(run: &RunInfo, role: &str) -> Result<Self, TransportError> {
        let endpoint = Arc::new(Endpoint::open(run)?);
        let doorbell = endpoint.doorbell(role)?;
        let replies = endpoint.reply_sender(role)?;
        let coordinator = endpoint.ringer("coordinator")?;
        let commands = endpoint.command_receiver(role)?;
        coordinator.ring()?;
        let reports = ProgressReports::new(Arc::clone(&endpoint), role);
        Ok(Self { commands, replies, reports, coordinator, doorbell, endpoint })
    }
}

/// Sends progress reports. The topic is opened with the first report, because most participants
/// reply before they have one.
#[derive(Debug)]
pub struct ProgressReports {
    // Before the endpoint: ports must close before their node.
    sender: Option<Sender<ProgressReport>>,
    endpoint: Arc<Endpoint>,
    role: String,
    /// Latest report that has reached the coordinator.
    received: Option<ProgressReport>,
}

impl ProgressReports {
    fn new(endpoint: Arc<Endpoint>, role: &str) -> Self {
        Self { sender: None, endpoint, role: role.to_owned(), received: None }
    }

    /// Sends the newest report unless the coordinator has it. Call this with every heartbeat: the
    /// coordinator opens the topic at a heartbeat.
    ///
    /// # Errors
    /// Fails if the shared memory of the run cannot be used.
    pub fn send(&mut self, newest: Option<ProgressReport>) -> Result<(), TransportError> {
        let Some(report) = newest.filter(|_| newest != self.received) else { return Ok(()) };
        let sender = match &self.sender {
            Some(sender) => sender,
            None => self.sender.insert(self.endpoint.progress_sender(&self.role)?),
        };
        if sender.offer(&report)? {
            self.received = newest;
        }
        Ok(())
    }
}
