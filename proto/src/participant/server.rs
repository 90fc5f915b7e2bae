//! State machine that serves a model: one reply per command.

use super::error::PortError;
use super::geometry::GeometryPorts;
use super::host::Host;
use super::ports::{InputPorts, OutputPorts};
use super::pulse::{Activity, HeartbeatSender};
use crate::command_ports::CommandPorts;
use crate::configuration::{Configuration, Refusal};
use crate::description::Description;
use crate::figure;
use crate::grid::Grid;
use crate::live::Live;
use crate::message::{
    Command, CommandKind, FIGURES, Failure, Finished, OBSERVE, Reply, STAY, StateFile, Status,
    Topics, write_figures,
};
use crate::model::{Model, Setup, Solver, StateError, Step, StepError};
use crate::progress::Progress;
use crate::run_dir::{RunInfo, forget_peak_resident_memory};
use crate::transport::{Doorbell, Endpoint, Receiver, Ringer, Sender, TransportError};
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Reason for the failure of a command. All except a refusal are sent as [`Failure`].
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
    StateFile { path: std::path::PathBuf, error: io::Error },
    #[error("{0}")]
    Protocol(String),
    #[error("{0}")]
    Report(String),
    #[error("window {window} has no answer: {error}")]
    Unacceptable { window: u64, error: StepError },
}

/// Stage of the participant in a run.
enum Stage {
    Joined,
    Configured {
        setup: Setup,
        configuration: Configuration,
    },
    Connected {
        setup: Setup,
        ports: Ports,
        patience: Duration,
    },
    Running(Running),
    /// The model could not be built. The ports stay open until the end, because peers that publish
    /// to them would fail before this participant has reported its error.
    Unbuilt {
        _ports: Ports,
    },
    Left,
}

/// A built model with its ports.
struct Running {
    model: Box<dyn Model>,
    ports: Ports,
    step: Step,
    model_time: Duration,
}

/// Ports of inputs, outputs and geometry, with the data of the run that they need.
struct Ports {
    inputs: InputPorts,
    outputs: OutputPorts,
    observed: OutputPorts,
    geometry: GeometryPorts,
    /// Live values received as inputs; shared with the model.
    live: Option<Live>,
    /// Keys of the figures requested with [`FIGURES`].
    figures: Vec<String>,
}

/// Reply to the coordinator.
struct Answer {
    reply: Reply,
    body: Vec<u8>,
}

pub(super) struct Server<'a> {
    solver: &'a dyn Solver,
    host: Host,
    description: Description,
    role: String,
    stage: Stage,
    activity: Activity,
    progress: Progress,
    /// Processor seconds of the participant before this run.
    spent_before: f64,
    commands: Receiver<Command>,
    replies: Sender<Reply>,
    coordinator: Ringer,
    doorbell: Doorbell,
    // Last: ports must close before their node.
    endpoint: Arc<Endpoint>,
}

impl<'a> Server<'a> {
    /// Joins a run as the participant with this index; returns the server and the content of its
    /// heartbeats.
    pub(super) fn open(
        run: &RunInfo,
        role: &str,
        index: usize,
        solver: &'a dyn Solver,
        host: Host,
    ) -> Result<(Self, HeartbeatSender), TransportError> {
        let CommandPorts { commands, replies, reports, coordinator, doorbell, endpoint } =
            CommandPorts::open(run, role)?;
        let (activity, progress) = (Activity::default(), Progress::default());
        let voice = HeartbeatSender {
            index,
            ringer: coordinator.clone(),
            activity: activity.clone(),
            progress: progress.clone(),
            reports,
        };
        let server = Self {
            solver,
            host,
            description: solver.description(),
            role: role.to_owned(),
            stage: Stage::Joined,
            activity,
            progress,
            spent_before: 0.0,
            commands,
            replies,
            coordinator,
            doorbell,
            endpoint,
        };
        Ok((server, voice))
    }

    /// Answers commands until the last run is finished, or the host is stopped. This wait needs no
    /// deadline: when the coordinator dies, the heartbeat thread ends the process or stops the
    /// host.
    pub(super) fn serve(&mut self) -> Result<(), TransportError> {
        while !matches!(self.stage, Stage::Left) {
            let next = || match self.host.is_stopped() {
                true => Ok(Some(None)),
                false => Ok(self.commands.receive()?.map(Some)),
            };
            let Some(message) = self.doorbell.wait::<_, TransportError>(next, |_, _| ())? else {
                return Ok(());
            };
            let command = *message.header();
            self.activity.busy();
            self.progress.begin(command.sequence);
            let answer = match self.handle(&command, message.body()) {
                Ok(answer) => answer,
                Err(error) => failed(&command, &error),
            };
            drop(message);
            self.replies.send(&answer.reply, &answer.body)?;
            self.coordinator.ring()?;
            self.activity.idle_after(command.sequence);
        }
        Ok(())
    }

    fn handle(&mut self, command: &Command, body: &[u8]) -> Result<Answer, CommandError> {
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
            CommandKind::Describe => return json_answer(done, &self.description),
            CommandKind::Advise => {
                return json_answer(done, &self.solver.advise(&serde_json::from_slice(body)?));
            }
            CommandKind::Configure => return self.configure(done, body),
            CommandKind::Connect => self.connect(done, body)?,
            CommandKind::Initialise => self.initialise(done)?,
            CommandKind::Solve => self.running(kind)?.solve(command, done)?,
            CommandKind::Accept => return self.running(kind)?.accept(command.flags, done),
            CommandKind::Save => self.running(kind)?.save(done, &serde_json::from_slice(body)?)?,
            CommandKind::Restore => {
                self.running(kind)?.restore(command, done, &serde_json::from_slice(body)?)?
            }
            CommandKind::Finish => return self.finish(command.flags & STAY != 0, done),
        };
        Ok(Answer { reply, body: Vec::new() })
    }

    fn running(&mut self, kind: CommandKind) -> Result<&mut Running, CommandError> {
        match &mut self.stage {
            Stage::Running(running) => Ok(running),
            _ => Err(CommandError::Protocol(format!("{kind:?} before Initialise"))),
        }
    }

    fn configure(&mut self, done: Reply, body: &[u8]) -> Result<Answer, CommandError> {
        let configuration: Configuration = serde_json::from_slice(body)?;
        self.description.admit(&configuration)?;
        let setup = self.solver.configure(&configuration)?;
        let answer = json_answer(done, setup.layout())?;
        self.stage = Stage::Configured { setup, configuration };
        Ok(answer)
    }

    fn connect(&mut self, done: Reply, body: &[u8]) -> Result<Reply, CommandError> {
        let topics: Topics = serde_json::from_slice(body)?;
        let Stage::Configured { setup, configuration } =
            std::mem::replace(&mut self.stage, Stage::Joined)
        else {
            return Err(CommandError::Protocol("Connect before Configure".to_owned()));
        };
        let kind = |name: &str| self.description.field_kind(name);
        let (published, observed): (Vec<_>, Vec<_>) =
            topics.outputs.iter().cloned().partition(|t| configuration.outputs.contains(&t.field));
        let fields = configuration.inputs.iter().map(|i| i.field.clone());
        let (endpoint, role) = (&self.endpoint, self.role.as_str());
        let ports = Ports {
            inputs: InputPorts::open(endpoint, &topics, fields)?,
            outputs: OutputPorts::open(endpoint, &published, role, kind)?,
            observed: OutputPorts::open(endpoint, &observed, role, kind)?,
            geometry: GeometryPorts::open(endpoint, &topics.geometry, role, &setup.layout().grids)?,
            live: configuration.histories.as_ref().and_then(|histories| histories.live.clone()),
            figures: topics.figures,
        };
        self.endpoint.close_unused();
        let patience = Duration::from_secs_f64(topics.deadline.clamp(0.0, 1e6));
        self.stage = Stage::Connected { setup, ports, patience };
        Ok(done)
    }

    fn initialise(&mut self, done: Reply) -> Result<Reply, CommandError> {
        let Stage::Connected { setup, mut ports, patience } =
            std::mem::replace(&mut self.stage, Stage::Joined)
        else {
            return Err(CommandError::Protocol("Initialise before Connect".to_owned()));
        };
        match begin(setup, &mut ports, patience, &self.progress) {
            Ok((model, step, model_time)) => {
                self.stage = Stage::Running(Running { model, ports, step, model_time });
                Ok(done)
            }
            Err(error) => {
                self.stage = Stage::Unbuilt { _ports: ports };
                Err(error)
            }
        }
    }

    /// Ends the run. The last member of the run removes the ports of a process that leaves.
    fn finish(&mut self, stays: bool, done: Reply) -> Result<Answer, CommandError> {
        let next = if stays { Stage::Joined } else { Stage::Left };
        let finished = match std::mem::replace(&mut self.stage, next) {
            Stage::Running(running) => {
                let spent = self.host.processor_seconds();
                let finished = Finished {
                    summary: running.model.summary(),
                    model_seconds: running.model_time.as_secs_f64(),
                    peak_rss_bytes: self.host.peak_resident_memory(),
                    cpu_seconds: Some(spent - std::mem::replace(&mut self.spent_before, spent)),
                };
                if !stays && matches!(self.host, Host::Process) {
                    std::mem::forget(running.ports);
                }
                finished
            }
            _ => Finished::default(),
        };
        if stays && matches!(self.host, Host::Process) {
            forget_peak_resident_memory();
        }
        json_answer(done, &finished)
    }
}

/// Builds the model and publishes its initial outputs; returns their step and the time spent
/// building.
fn begin(
    setup: Setup,
    ports: &mut Ports,
    patience: Duration,
    progress: &Progress,
) -> Result<(Box<dyn Model>, Step, Duration), CommandError> {
    ports.wait_for_subscribers(Instant::now() + patience)?;
    let start = Instant::now();
    let mut model = setup.build(progress)?;
    let model_time = start.elapsed();
    let step = Step { iteration: 0, ..Step::STEADY };
    ports.move_to(model.moved_grids(), &step)?;
    ports.outputs.loan()?;
    model.first_outputs(&mut ports.outputs);
    ports.outputs.publish(&step)?;
    Ok((model, step, model_time))
}

impl Ports {
    fn wait_for_subscribers(&self, deadline: Instant) -> Result<(), TransportError> {
        self.outputs.wait_for_subscribers(deadline)?;
        self.observed.wait_for_subscribers(deadline)?;
        self.geometry.wait_for_subscribers(deadline)
    }

    /// Publishes the geometry of the grids that have moved; the following samples are on the moved
    /// grids.
    fn move_to(&mut self, grids: &[Grid], step: &Step) -> Result<(), PortError> {
        let Self { inputs, outputs, observed, geometry, .. } = self;
        geometry.publish(grids, step, |moved| {
            outputs.moved(moved);
            observed.moved(moved);
            inputs.moved(moved);
        })
    }
}

impl Running {
    fn solve(&mut self, command: &Command, done: Reply) -> Result<Reply, CommandError> {
        let Ports { inputs, outputs, live, .. } = &mut self.ports;
        inputs.advance(command)?;
        live.iter().try_for_each(|live| inputs.give(live))?;
        outputs.loan()?;
        self.step = command.step();
        let start = Instant::now();
        let solved = self.model.solve(&self.step, &inputs.values(), outputs);
        let spent = start.elapsed();
        self.model_time += spent;
        match solved {
            Ok(report) => {
                if let Some(fault) = report.fault() {
                    outputs.discard();
                    return Err(CommandError::Report(fault));
                }
                outputs.publish(&self.step)?;
                Ok(Reply { model_seconds: spent.as_secs_f64(), ..done.with_report(&report) })
            }
            Err(error) => {
                outputs.discard();
                Err(error.into())
            }
        }
    }

    /// Accepts the last solve, and publishes what is requested.
    fn accept(&mut self, flags: u32, done: Reply) -> Result<Answer, CommandError> {
        let Self { model, ports, step, .. } = self;
        let start = Instant::now();
        let refused = |error| CommandError::Unacceptable { window: step.window, error };
        let (observe, figures) = (flags & OBSERVE != 0, flags & FIGURES != 0);
        model.acceptable().map_err(refused)?;
        model.accept();
        if observe {
            ports.observed.loan()?;
            model.observe(&mut ports.observed);
        }
        let body = if figures {
            let summary = model.summary();
            write_figures(ports.figures.iter().map(|key| figure::value(&summary, key)))
        } else {
            Vec::new()
        };
        let spent = start.elapsed();
        self.model_time += spent;
        ports.observed.publish(step)?;
        ports.move_to(model.moved_grids(), step)?;
        let reply = Reply { model_seconds: spent.as_secs_f64(), ..done };
        Ok(Answer { reply, body })
    }

    fn save(&mut self, done: Reply, file: &StateFile) -> Result<Reply, CommandError> {
        let partial = file.path.with_extension("partial");
        write_state(&*self.model, &partial)
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
        let opened = File::open(&file.path)
            .map_err(|error| CommandError::StateFile { path: file.path.clone(), error })?;
        read_state(&mut *self.model, opened)?;
        self.step = command.step();
        let (ports, step) = (&mut self.ports, &self.step);
        ports.move_to(&file.geometry, step)?;
        ports.outputs.loan()?;
        if let Err(error) = ports.outputs.read(&file.outputs) {
            ports.outputs.discard();
            return Err(error.into());
        }
        ports.outputs.publish(step)?;
        ports.move_to(self.model.moved_grids(), step)?;
        Ok(done)
    }
}

/// Streams the accepted state to a file.
fn write_state(model: &dyn Model, path: &Path) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    model.save(&mut file)?;
    file.flush()
}

/// Streams a state from a file and checks that the file ends with the state.
fn read_state(model: &mut dyn Model, file: File) -> Result<(), StateError> {
    let mut file = BufReader::new(file);
    model.restore(&mut file)?;
    match file.read(&mut [0])? {
        0 => Ok(()),
        _ => Err(StateError("it is longer than the model's state".to_owned())),
    }
}

fn json_answer(reply: Reply, value: &impl serde::Serialize) -> Result<Answer, CommandError> {
    Ok(Answer { reply, body: serde_json::to_vec(value)? })
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
