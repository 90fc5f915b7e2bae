//! The ports of a participant beside those of its fields: commands, replies, progress, bells.

use crate::message::{Command, ProgressReport, Reply};
use crate::run_dir::RunInfo;
use crate::transport::{Doorbell, Endpoint, Receiver, Ringer, Sender, TransportError};

/// What a participant has opened when it has joined a run.
#[derive(Debug)]
pub struct CommandPorts {
    /// Commands to it.
    pub commands: Receiver<Command>,
    /// Its replies.
    pub replies: Sender<Reply>,
    /// How far it is.
    pub reports: Sender<ProgressReport>,
    /// The coordinator's bell.
    pub coordinator: Ringer,
    /// Its own bell.
    pub doorbell: Doorbell,
    // Last: ports close before the node that they belong to.
    /// Where further ports are opened.
    pub endpoint: Endpoint,
}

impl CommandPorts {
    /// Joins a run as the participant of this role, and tells the coordinator.
    ///
    /// # Errors
    /// The shared memory of the run is not there, or cannot be used.
    pub fn open(run: &RunInfo, role: &str) -> Result<Self, TransportError> {
        let endpoint = Endpoint::open(run)?;
        let doorbell = endpoint.doorbell(role)?;
        // Before the replies, whose being served tells the coordinator to connect to both.
        let reports = endpoint.progress_sender(role)?;
        let replies = endpoint.reply_sender(role)?;
        let coordinator = endpoint.ringer("coordinator")?;
        let commands = endpoint.command_receiver(role)?;
        coordinator.ring()?;
        Ok(Self { commands, replies, reports, coordinator, doorbell, endpoint })
    }
}
