//! Relays commands: sends each command with its inputs and files to the server, and returns reply,
//! outputs and files to the run.

use super::ClientError;
use super::connection::{Connection, of_one_run, out_of_turn};
use super::files::{pieces, send_files};
use super::participant::LocalParticipant;
use crate::frame::Frame;
use crate::pack::Packing;
use crate::routes::{Components, Readers, Routes, Writers};
use contract::description::Description;
use contract::message::{
    Command, CommandKind, Failure, OutputFile, Reply, StateFile, Status, Topics,
};
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Maximum size of a state that is written [byte].
const LARGEST_STATE: u64 = 64 << 30;

/// Open ports of the run.
struct Ports {
    readers: Readers,
    writers: Writers,
    patience: Duration,
}

/// State file being written.
struct Saving {
    path: PathBuf,
    partial: PathBuf,
    file: Option<File>,
    bytes: u64,
    fault: Option<String>,
}

/// Answers commands on behalf of the remote participant.
pub(super) struct Service<'a> {
    connection: &'a Connection,
    description: Description,
    components: Components,
    packing: Packing,
    ports: Option<Ports>,
    saving: Option<Saving>,
    /// Number of commands that failed here and were not sent to the server.
    kept_back: u64,
    // Last field: ports must close before the node that owns them.
    participant: LocalParticipant,
}

impl<'a> Service<'a> {
    pub(super) fn new(
        participant: LocalParticipant,
        connection: &'a Connection,
        description: Description,
        packing: Packing,
    ) -> Self {
        let components = Components::described(&description);
        Self {
            connection,
            description,
            components,
            packing,
            ports: None,
            saving: None,
            kept_back: 0,
            participant,
        }
    }

    /// Answers commands until the run is finished. Calls `finished` before the coordinator receives
    /// the last reply.
    pub(super) fn serve(&mut self, finished: impl Fn()) -> Result<(), ClientError> {
        loop {
            let message = self.participant.command().map_err(ClientError::of)?;
            let (command, body) = (*message.header(), message.body().to_vec());
            drop(message);
            let kind = CommandKind::from_number(command.kind);
            let (reply, body) = self.deal(kind, &command, body)?;
            let leaves = kind == Some(CommandKind::Finish) && reply.status == Status::Done as u32;
            if leaves {
                finished();
            }
            self.participant.reply(&reply, &body).map_err(ClientError::of)?;
            self.participant.idle_after(command.sequence);
            if leaves {
                return Ok(());
            }
        }
    }

    fn deal(
        &mut self,
        kind: Option<CommandKind>,
        command: &Command,
        body: Vec<u8>,
    ) -> Result<(Reply, Vec<u8>), ClientError> {
        let prepared = match self.prepare(kind, body)? {
            Ok(body) => body,
            Err(error) => {
                self.kept_back += 1;
                return Ok(failed(command, error));
            }
        };
        if let Some(ports) = &self.ports {
            let forwarded = ports.readers.forward(&self.connection.link.sending, self.packing);
            forwarded.map_err(ClientError::of)?;
        }
        self.connection.send(&Frame::Command(*command, &prepared))?;
        let (mut reply, mut body) = self.answer()?;
        if kind == Some(CommandKind::Describe) {
            body = of_one_run(body);
        }
        reply.sequence = reply.sequence.saturating_add(self.kept_back);
        let saved = self.saving.take().map(Saving::finish);
        match (reply.status == Status::Done as u32, saved) {
            (true, Some(Err(error))) => Ok(failed(command, error)),
            (true, _) => Ok((reply, body)),
            (false, _) => {
                if kind == Some(CommandKind::Connect) {
                    self.ports = None;
                }
                Ok((reply, body))
            }
        }
    }

    /// Sends the data a command needs and returns the body to send. The inner error says why the
    /// command fails here. An invalid body is left for the participant to reject.
    fn prepare(
        &mut self,
        kind: Option<CommandKind>,
        body: Vec<u8>,
    ) -> Result<Result<Vec<u8>, String>, ClientError> {
        match kind {
            Some(CommandKind::Configure) => {
                self.components.configured(&body);
                let sent = send_files(&self.connection.link.sending, &self.description, &body);
                Ok(sent.map(|()| body).map_err(|error| error.words))
            }
            Some(CommandKind::Connect) => {
                let Ok(topics) = serde_json::from_slice::<Topics>(&body) else {
                    return Ok(Ok(body));
                };
                Ok(self.connect(&topics).map(|()| body))
            }
            Some(CommandKind::Initialise) => {
                let Some(ports) = &self.ports else { return Ok(Ok(body)) };
                let until = Instant::now() + ports.patience;
                let there = ports.writers.wait_for_subscribers(until);
                Ok(there.map(|()| body).map_err(|error| error.to_string()))
            }
            Some(CommandKind::Save) => {
                if let Ok(file) = serde_json::from_slice::<StateFile>(&body) {
                    self.saving = Some(Saving::new(file.path));
                    return Ok(Ok(without_paths(StateFile {
                        path: PathBuf::new(),
                        outputs: Vec::new(),
                        geometry: Vec::new(),
                    })));
                }
                Ok(Ok(body))
            }
            Some(CommandKind::Restore) => match serde_json::from_slice::<StateFile>(&body) {
                Ok(file) => Ok(self.send_state(&file).map(|()| without_paths(file))),
                Err(_) => Ok(Ok(body)),
            },
            _ => Ok(Ok(body)),
        }
    }

    /// Opens the ports of the run.
    fn connect(&mut self, topics: &Topics) -> Result<(), String> {
        let routes = Routes::of(topics, &self.components);
        let endpoint = &self.participant.endpoint;
        let failed = |error: proto::transport::TransportError| error.to_string();
        self.ports = None;
        let readers = Readers::open(endpoint, &routes.inward).map_err(failed)?;
        let writers = Writers::open(endpoint, &routes.outward, false).map_err(failed)?;
        endpoint.close_unused();
        self.connection.link.allow(routes.longest());
        let patience = Duration::from_secs_f64(routes.deadline.clamp(0.0, 1e6));
        self.ports = Some(Ports { readers, writers, patience });
        Ok(())
    }

    /// Sends the state and the saved outputs ahead of the command.
    fn send_state(&self, file: &StateFile) -> Result<(), String> {
        let all = std::iter::once(&file.path).chain(file.outputs.iter().map(|output| &output.path));
        for (part, path) in all.enumerate() {
            pieces(path, |bytes, last| {
                let part = part as u16;
                self.connection.link.sending.send(&Frame::State { part, last, bytes })
            })
            .map_err(|error| format!("{}: {error}", path.display()))?;
        }
        Ok(())
    }

    /// Waits for the reply, and publishes the samples and the state that arrive before it.
    fn answer(&mut self) -> Result<(Reply, Vec<u8>), ClientError> {
        loop {
            let message = self.connection.next()?;
            match Frame::read(&message).map_err(ClientError::of)? {
                Frame::Reply(reply, body) => return Ok((reply, body.to_vec())),
                Frame::Sample { topic, header, packing, values, bytes } => {
                    let ports = self.ports.as_ref().ok_or_else(out_of_turn)?;
                    let published = ports.writers.publish(topic, &header, packing, values, bytes);
                    published.map_err(ClientError::of)?;
                }
                Frame::State { part: 0, bytes, .. } => {
                    self.saving.as_mut().ok_or_else(out_of_turn)?.add(bytes);
                }
                _ => return Err(out_of_turn()),
            }
        }
    }
}

fn failed(command: &Command, error: String) -> (Reply, Vec<u8>) {
    let body = serde_json::to_vec(&Failure { error }).expect("plain text always serialises");
    (Reply::new(Status::Failed, command.sequence), body)
}

/// Returns the body of `Save` or `Restore` without paths; names and grids remain.
fn without_paths(file: StateFile) -> Vec<u8> {
    let name = |output: OutputFile| OutputFile { path: PathBuf::new(), ..output };
    let outputs = file.outputs.into_iter().map(name).collect();
    let file = StateFile { path: PathBuf::new(), outputs, ..file };
    serde_json::to_vec(&file).expect("names and grids are plain data")
}

impl Saving {
    fn new(path: PathBuf) -> Self {
        let partial = path.with_extension("partial");
        Self { path, partial, file: None, bytes: 0, fault: None }
    }

    fn add(&mut self, bytes: &[u8]) {
        if self.fault.is_none()
            && let Err(error) = self.write(bytes)
        {
            self.fault = Some(format!("state file {}: {error}", self.path.display()));
        }
    }

    fn write(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.bytes += bytes.len() as u64;
        if self.bytes > LARGEST_STATE {
            let most = LARGEST_STATE >> 30;
            return Err(std::io::Error::other(format!("the server sent more than {most} GiB")));
        }
        let file = match &mut self.file {
            Some(file) => file,
            none => none.insert(File::create(&self.partial)?),
        };
        file.write_all(bytes)
    }

    fn finish(self) -> Result<(), String> {
        if let Some(fault) = self.fault {
            return Err(fault);
        }
        rename(&self.partial, &self.path)
    }
}

fn rename(partial: &Path, path: &Path) -> Result<(), String> {
    std::fs::rename(partial, path)
        .map_err(|error| format!("state file {}: {error}", path.display()))
}
