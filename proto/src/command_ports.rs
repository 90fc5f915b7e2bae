//! The ports of a participant besides those of its fields: commands, replies, progress, bells.

use crate::message::{Command, ProgressReport, Reply};
use crate::run_dir::RunInfo;
use crate::transport::{Doorbell, Endpoint, Receiver, Ringer, Sender, TransportError};
use std::sync::Arc;

/// What a participant has opened when it has joined a run.
#[derive(Debug)]
pub struct CommandPorts {
    /// Commands to it.
    pub commands: Receiver<Command>,
    /// Its replies.
    pub replies: Sender<Reply>,
    /// How far it is.
    pub reports: ProgressReports,
    /// The coordinator's bell.
    pub coordinator: Ringer,
    /// Its own bell.
    pub doorbell: Doorbell,
    // Last: ports close before the node that they belong to.
    /// Where further ports are opened.
    pub endpoint: Arc<Endpoint>,
}

impl CommandPorts {
    /// Joins a run as the participant of this role, and tells the coordinator.
    ///
    /// # Errors
    /// The shared memory of the run is not there, or cannot be used.
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

/// Sends how far a participant is. The topic is opened with the first report: most participants
/// have answered before there is one.
#[derive(Debug)]
pub struct ProgressReports {
    // Before the endpoint, which it belongs to.
    sender: Option<Sender<ProgressReport>>,
    endpoint: Arc<Endpoint>,
    role: String,
    /// The last report that has reached the coordinator.
    received: Option<ProgressReport>,
}

impl ProgressReports {
    fn new(endpoint: Arc<Endpoint>, role: &str) -> Self {
        Self { sender: None, endpoint, role: role.to_owned(), received: None }
    }

    /// Sends the newest report unless the coordinator has it. It opens its side of the topic at a
    /// heartbeat, so that this is called with each of them.
    ///
    /// # Errors
    /// The shared memory of the run cannot be used.
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
