//! The state machine that serves a model: one command, one answer.

use super::ports::{InputPorts, OutputPorts, PortError};
use crate::configuration::{Configuration, Refusal};
use crate::field::{self, FieldKind};
use crate::message::{
    Command, CommandKind, Failure, Finished, OBSERVE, Reply, StateFile, Status, Topics,
};
use crate::model::{Model, Setup, Solver, StateBlob, StateError, Step, StepError};
use crate::run_dir::{RunInfo, peak_resident_memory};
use crate::transport::{Doorbell, Endpoint, Receiver, Ringer, Sender, TransportError};
use std::time::{Duration, Instant};

/// Why a command could not be done. All but a refusal travel as [`Failure`].
#[derive(Debug, thiserror::Error)]
enum CommandError {
    #[error(transparent)]
    Refused(#[from] Refusal),
    #[error(transparent)]
    Transport(#[from] TransportError),
    #[error(transparent)]
    Port(#[from] PortError),
    #[error(transparent)]
    Step(#[from] StepError),
    #[error(transparent)]
    State(#[from] StateError),
    #[error("malformed message: {0}")]
    Json(#[from] serde_json::Error),
    #[error("state file {path}: {error}")]
    StateFile { path: std::path::PathBuf, error: std::io::Error },
    #[error("{0}")]
    Protocol(String),
}

/// How far the participant has come.
enum Stage {
    Joined,
    Configured { setup: Box<dyn Setup>, configuration: Configuration },
    Running(Running),
    Left,
}

/// A built model with its ports.
struct Running {
    model: Box<dyn Model>,
    inputs: InputPorts,
    outputs: OutputPorts,
    observed: OutputPorts,
    step: Step,
    model_time: Duration,
}

/// What goes back to the coordinator.
struct Answer {
    reply: Reply,
    body: Vec<u8>,
}

pub(super) struct Server<'a> {
    solver: &'a dyn Solver,
    role: String,
    stage: Stage,
    commands: Receiver<Command>,
    replies: Sender<Reply>,
    coordinator: Ringer,
    doorbell: Doorbell,
    // Last: ports close before the node that they belong to.
    endpoint: Endpoint,
}

impl<'a> Server<'a> {
    pub(super) fn open(
        run: &RunInfo,
        role: &str,
        solver: &'a dyn Solver,
    ) -> Result<Self, TransportError> {
        let endpoint = Endpoint::open(run)?;
        let doorbell = endpoint.doorbell(role)?;
        let replies = endpoint.reply_sender(role)?;
        let coordinator = endpoint.ringer("coordinator")?;
        let commands = endpoint.command_receiver(role)?;
        coordinator.ring()?;
        let role = role.to_owned();
        let stage = Stage::Joined;
        Ok(Self { solver, role, stage, commands, replies, coordinator, doorbell, endpoint })
    }

    pub(super) fn ringer(&self) -> Ringer {
        self.coordinator.clone()
    }

    /// Answers commands until the run is finished. The heartbeat thread ends the process when the
    /// coordinator dies, so that this wait needs no deadline of its own.
    pub(super) fn serve(&mut self) -> Result<(), TransportError> {
        while !matches!(self.stage, Stage::Left) {
            let message =
                self.doorbell.wait::<_, TransportError>(|| self.commands.receive(), |_| ())?;
            let command = *message.header();
            let answer = match self.handle(&command, message.body()) {
                Ok(None) => continue,
                Ok(Some(answer)) => answer,
                Err(error) => failed(&command, &error),
            };
            drop(message);
            self.replies.send(&answer.reply, &answer.body)?;
            self.coordinator.ring()?;
        }
        Ok(())
    }

    fn handle(&mut self, command: &Command, body: &[u8]) -> Result<Option<Answer>, CommandError> {
        if command.protocol != crate::PROTOCOL_VERSION {
            return Err(CommandError::Protocol(format!(
                "the coordinator speaks protocol {}, this program {}",
                command.protocol,
                crate::PROTOCOL_VERSION
            )));
        }
        let kind = CommandKind::from_number(command.kind)
            .ok_or_else(|| CommandError::Protocol(format!("unknown command {}", command.kind)))?;
        let _span = tracing::debug_span!(
            "command",
            ?kind,
            role = self.role,
            window = command.window,
            iteration = command.iteration
        )
        .entered();
        let done = Reply::new(Status::Done, command.sequence);
        let reply = match kind {
            CommandKind::Describe => return json_answer(done, &self.solver.description()),
            CommandKind::Configure => return self.configure(done, body),
            CommandKind::Initialise => self.initialise(done, body)?,
            CommandKind::Solve => self.running(kind)?.solve(command, done)?,
            CommandKind::Accept if command.flags & OBSERVE == 0 => {
                self.running(kind)?.model.accept();
                return Ok(None);
            }
            CommandKind::Accept => self.running(kind)?.accept_observed(done)?,
            CommandKind::Save => self.running(kind)?.save(done, &serde_json::from_slice(body)?)?,
            CommandKind::Restore => {
                self.running(kind)?.restore(command, done, &serde_json::from_slice(body)?)?
            }
            CommandKind::Finish => return self.finish(done),
        };
        Ok(Some(Answer { reply, body: Vec::new() }))
    }

    fn running(&mut self, kind: CommandKind) -> Result<&mut Running, CommandError> {
        match &mut self.stage {
            Stage::Running(running) => Ok(running),
            _ => Err(CommandError::Protocol(format!("{kind:?} before Initialise"))),
        }
    }

    fn configure(&mut self, done: Reply, body: &[u8]) -> Result<Option<Answer>, CommandError> {
        let configuration: Configuration = serde_json::from_slice(body)?;
        let setup = self.solver.configure(&configuration)?;
        let answer = json_answer(done, setup.layout())?;
        self.stage = Stage::Configured { setup, configuration };
        Ok(answer)
    }

    fn initialise(&mut self, done: Reply, body: &[u8]) -> Result<Reply, CommandError> {
        let topics: Topics = serde_json::from_slice(body)?;
        let Stage::Configured { setup, configuration } =
            std::mem::replace(&mut self.stage, Stage::Joined)
        else {
            return Err(CommandError::Protocol("Initialise before Configure".to_owned()));
        };
        let description = self.solver.description();
        let kind = |name: &str| -> Option<FieldKind> {
            let own = || description.fields.iter().find(|f| f.name == name).cloned();
            field::find(name).map(field::FieldSpec::kind).or_else(own)
        };
        let (published, observed): (Vec<_>, Vec<_>) =
            topics.outputs.iter().cloned().partition(|t| configuration.outputs.contains(&t.field));
        let fields = configuration.inputs.iter().map(|i| i.field.clone());
        let start = Instant::now();
        let model = setup.build()?;
        let model_time = start.elapsed();
        let mut running = Running {
            inputs: InputPorts::open(&self.endpoint, &topics.inputs, fields, topics.interpolation)?,
            outputs: OutputPorts::open(&self.endpoint, &published, &self.role, kind)?,
            observed: OutputPorts::open(&self.endpoint, &observed, &self.role, kind)?,
            model,
            step: Step { iteration: 0, ..Step::STEADY },
            model_time,
        };
        let deadline = Instant::now() + Duration::from_secs_f64(topics.deadline.clamp(0.0, 1e6));
        running.outputs.wait_for_subscribers(deadline)?;
        running.observed.wait_for_subscribers(deadline)?;
        running.outputs.loan()?;
        running.model.first_outputs(&mut running.outputs);
        running.outputs.publish(&running.step)?;
        self.stage = Stage::Running(running);
        Ok(done)
    }

    fn finish(&mut self, done: Reply) -> Result<Option<Answer>, CommandError> {
        let finished = match std::mem::replace(&mut self.stage, Stage::Left) {
            Stage::Running(running) => Finished {
                summary: running.model.summary(),
                model_seconds: running.model_time.as_secs_f64(),
                peak_rss_bytes: peak_resident_memory(),
            },
            _ => Finished::default(),
        };
        json_answer(done, &finished)
    }
}

impl Running {
    fn solve(&mut self, command: &Command, done: Reply) -> Result<Reply, CommandError> {
        self.inputs.advance(command)?;
        self.outputs.loan()?;
        self.step = command.step();
        let start = Instant::now();
        let solved = self.model.solve(&self.step, &self.inputs, &mut self.outputs);
        let spent = start.elapsed();
        self.model_time += spent;
        match solved {
            Ok(report) => {
                self.outputs.publish(&self.step)?;
                Ok(Reply { model_seconds: spent.as_secs_f64(), ..done.with_report(&report) })
            }
            Err(error) => {
                self.outputs.discard();
                Err(error.into())
            }
        }
    }

    fn accept_observed(&mut self, done: Reply) -> Result<Reply, CommandError> {
        let start = Instant::now();
        self.model.accept();
        self.observed.loan()?;
        self.model.observe(&mut self.observed);
        let spent = start.elapsed();
        self.model_time += spent;
        self.observed.publish(&self.step)?;
        Ok(Reply { model_seconds: spent.as_secs_f64(), ..done })
    }

    fn save(&mut self, done: Reply, file: &StateFile) -> Result<Reply, CommandError> {
        let mut blob = StateBlob::default();
        self.model.save(&mut blob);
        let partial = file.path.with_extension("partial");
        std::fs::write(&partial, &blob.0)
            .and_then(|()| std::fs::rename(&partial, &file.path))
            .map_err(|error| CommandError::StateFile { path: file.path.clone(), error })?;
        Ok(done)
    }

    fn restore(
        &mut self,
        command: &Command,
        done: Reply,
        file: &StateFile,
    ) -> Result<Reply, CommandError> {
        let bytes = std::fs::read(&file.path)
            .map_err(|error| CommandError::StateFile { path: file.path.clone(), error })?;
        self.model.restore(&StateBlob(bytes))?;
        self.step = command.step();
        self.outputs.loan()?;
        if let Err(error) = self.outputs.read(&file.outputs) {
            self.outputs.discard();
            return Err(error.into());
        }
        self.outputs.publish(&self.step)?;
        Ok(done)
    }
}

fn json_answer(
    reply: Reply,
    value: &impl serde::Serialize,
) -> Result<Option<Answer>, CommandError> {
    Ok(Some(Answer { reply, body: serde_json::to_vec(value)? }))
}

fn failed(command: &Command, error: &CommandError) -> Answer {
    tracing::error!(%error, "command failed");
    let (status, body) = match error {
        CommandError::Refused(refusal) => (Status::Refused, serde_json::to_vec(refusal)),
        other => (Status::Failed, serde_json::to_vec(&Failure { error: other.to_string() })),
    };
    let body = body.expect("plain text always serialises");
    Answer { reply: Reply::new(status, command.sequence), body }
}
