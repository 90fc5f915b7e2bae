//! A process of the participant under test, in a run of its own, with the coordinator's side played
//! by the checks.
//!
//! A [`run::session::Session`] never violates the contract. A [`TestProcess`] can: it sends any
//! command and any sample, and exposes every reply.

use super::fault::{CheckFailure, broken, late};
use super::input::InputSource;
use super::setting::Setting;
use contract::configuration::{Configuration, Layout, Refusal};
use contract::description::Description;
use contract::grid::Grid;
use contract::message::{
    Command, CommandKind, FIGURES, Failure, FieldHeader, Finished, GeometryTopic, OBSERVE, Reply,
    STAY, Status, Topic, Topics,
};
use coupling::ParticipantIndex;
use proto::model::{Step, first_non_finite};
use proto::run_dir::{RunDir, RunInfo};
use proto::transport::{FieldWriter, TransportError};
use run::deadlines::Deadlines;
use run::error::RunError;
use run::peers::{COORDINATOR, Delay, LEAVE, ParticipantSlot, Peers, ProcessGuard, Stopped};
use run::peers::{layout_fault, volume_fault};
use run::program::Program;
use run::session::{FieldSubscription, MovingGrid};
use run::supervise::Exit;
use std::mem::ManuallyDrop;
use std::path::Path;
use std::time::{Duration, Instant};

/// The participant under test.
#[derive(Clone)]
pub(super) struct Subject {
    /// Role of the participant.
    pub(super) role: String,
    /// Executable.
    pub(super) program: Program,
    /// Description in reply to the first question; empty without one.
    pub(super) description: Description,
    /// Longest wait for an answer.
    pub(super) patience: Duration,
}

/// The usual check for heartbeats is off during the checks: a separate check covers them.
const NEVER: Duration = Duration::MAX;

/// The only participant of a run, with its connections.
pub(super) struct TestProcess {
    guard: ProcessGuard,
    subject: Subject,
    pub(super) ports: Ports,
    /// Times at which heartbeats were received.
    pub(super) beats: Vec<Instant>,
    /// Last accepted step.
    accepted: Option<Step>,
    peers: Peers,
}

/// The checks' ends of the topics of a run.
#[derive(Default)]
pub(super) struct Ports {
    outputs: Vec<FieldSubscription>,
    observed: Vec<FieldSubscription>,
    /// Volumes of observed fields.
    volumes: Vec<MovingGrid>,
    pub(super) inputs: Vec<Feed>,
}

/// A successful solve.
pub(super) struct Solved {
    pub(super) reply: Reply,
    pub(super) outputs: Values,
}

/// Values of several fields.
pub(super) type Values = Vec<(String, Vec<f64>)>;

/// Topic of an input.
pub(super) struct Feed {
    pub(super) source: InputSource,
    pub(super) grid: Grid,
    pub(super) header: FieldHeader,
    writer: FieldWriter,
    /// Last values sent.
    pub(super) values: Vec<f64>,
}

impl Feed {
    /// Sends values under the current label, with the next sequence number.
    pub(super) fn send(&mut self, values: &[f64], step: &Step) -> Result<(), TransportError> {
        self.header.sequence += 1;
        (self.header.window, self.header.iteration) = (step.window, step.iteration);
        (self.header.start, self.header.end) = (step.start, step.end);
        let mut loan = self.writer.loan(values.len())?;
        loan.values().copy_from_slice(values);
        self.values = values.to_vec();
        self.writer.publish(loan, &self.header)
    }
}

impl TestProcess {
    /// Starts the participant in its own run, without waiting for it to join.
    pub(super) fn start(subject: &Subject) -> Result<Self, CheckFailure> {
        let Subject { role, program, patience, .. } = subject.clone();
        let seat = ParticipantSlot { role, program, attach: false };
        let deadlines =
            Deadlines { start: patience, build: patience, solve: patience, heartbeat: NEVER };
        let started = Peers::start(&[seat], deadlines, None);
        let peers = started.map_err(|error| match error {
            RunError::Failed(failure) => {
                CheckFailure::Broken(format!("it does not start: {}", failure.what))
            }
            other => CheckFailure::Broken(other.to_string()),
        })?;
        Ok(Self {
            guard: peers.process_guard(),
            subject: subject.clone(),
            ports: Ports::default(),
            beats: Vec::new(),
            accepted: None,
            peers,
        })
    }

    /// Waits until the participant has joined.
    pub(super) fn joined(mut self) -> Result<Self, CheckFailure> {
        let joined = self.peers.joined(ParticipantIndex::FIRST, self.subject.patience);
        joined.map_err(|stopped| self.fault(stopped, "joining the run"))?;
        Ok(self)
    }

    /// Returns the folder of the run.
    pub(super) fn folder(&self) -> &Path {
        &self.peers.run().info().folder
    }

    /// Returns the exit of the participant's process, if it has ended.
    pub(super) fn ended(&self) -> Option<Exit> {
        self.peers.supervisor().exits().pop()
    }

    /// Returns the reason why a wait ended early as a fault of the participant.
    fn fault(&self, stopped: Stopped, what: &str) -> CheckFailure {
        let broken = |how: String| CheckFailure::Broken(format!("{what}: {how}"));
        match stopped {
            Stopped::Interrupted(signal) => CheckFailure::Interrupted(signal),
            Stopped::Exited(exit) => broken(format!("its process {exit}")),
            Stopped::Gone(_) => broken("its process is gone".to_owned()),
            Stopped::ReplyLost(_) => {
                broken("no answer, and its heartbeat says that it waits for a command".to_owned())
            }
            Stopped::Silent(_, time) | Stopped::Late(_, Delay { waited: time, .. }) => {
                broken(format!("no answer within {:.0} s", time.as_secs_f64()))
            }
            Stopped::Transport(_, error) | Stopped::Doorbell(error) => error.into(),
        }
    }

    /// Sends a command under the next sequence number.
    pub(super) fn post(&mut self, command: Command, body: &[u8]) -> Result<(), CheckFailure> {
        self.peers.send(ParticipantIndex::FIRST, command, body)?;
        Ok(())
    }

    /// Waits for the reply to the last command, and checks its label.
    pub(super) fn answer(&mut self, what: &str) -> Result<Answer, CheckFailure> {
        let Self { peers, beats, subject, .. } = self;
        let waited =
            peers.wait(ParticipantIndex::FIRST, subject.patience, || beats.push(Instant::now()));
        let message = waited.map_err(|stopped| self.fault(stopped, what))?;
        let (reply, body) = (*message.header(), message.body().to_vec());
        drop(message);
        let expected = self.peers.all()[ParticipantIndex::FIRST].sequence();
        if reply.protocol != contract::PROTOCOL_VERSION {
            return broken(format!("{what}: its reply has protocol {}", reply.protocol));
        }
        if reply.sequence != expected {
            let found = reply.sequence;
            return broken(format!("{what}: it answers command {found} instead of {expected}"));
        }
        match Status::from_number(reply.status) {
            Some(status) => Ok(Answer { reply, status, body, what: what.to_owned() }),
            None => broken(format!("{what}: its reply has the unknown status {}", reply.status)),
        }
    }

    /// Sends a command and waits for the reply.
    pub(super) fn ask(&mut self, command: Command, body: &[u8]) -> Result<Answer, CheckFailure> {
        let kind = CommandKind::from_number(command.kind);
        let what = kind.map_or_else(|| format!("command {}", command.kind), |k| format!("{k:?}"));
        self.post(command, body)?;
        self.answer(&what)
    }

    /// Sends a command with its body as JSON, and waits for the reply.
    pub(super) fn ask_with(
        &mut self,
        command: Command,
        body: &impl serde::Serialize,
    ) -> Result<Answer, CheckFailure> {
        let body = serde_json::to_vec(body).expect("bodies of commands are plain data");
        self.ask(command, &body)
    }

    /// Sends `Configure`, and returns the layout if it fits the configuration.
    pub(super) fn configure(
        &mut self,
        configuration: &Configuration,
    ) -> Result<Layout, CheckFailure> {
        let command = Command::new(CommandKind::Configure);
        let answer = self.ask_with(command, configuration)?.done()?;
        let layout: Layout = answer.json("a layout")?;
        let fault = layout_fault(configuration, &layout);
        match fault.or_else(|| volume_fault(configuration, &layout)) {
            None => Ok(layout),
            Some(fault) => broken(format!("its layout is invalid: {fault}")),
        }
    }

    /// Sends `Configure`, `Connect` and `Initialise`, and returns the layout and the first outputs.
    pub(super) fn prepare(&mut self, setting: &Setting) -> Result<(Layout, Values), CheckFailure> {
        let layout = self.configure(&setting.configuration)?;
        let first = self.initialise(setting, &layout)?;
        Ok((layout, first))
    }

    /// Opens all topics, sends `Connect` and `Initialise`, and returns the first outputs.
    pub(super) fn initialise(
        &mut self,
        setting: &Setting,
        layout: &Layout,
    ) -> Result<Values, CheckFailure> {
        let topics = self.open(setting, layout)?;
        self.ask_with(Command::new(CommandKind::Connect), &topics)?.done()?;
        let deadline = Instant::now() + self.subject.patience;
        for feed in &self.ports.inputs {
            feed.writer.wait_for_subscribers(deadline)?;
        }
        self.none_of_outputs("Connect")?;
        self.ask(Command::new(CommandKind::Initialise), &[])?.done()?;
        let before = Step { iteration: 0, ..Step::STEADY };
        self.take_geometry(&before)?;
        if let Some(grid) = self.volumes().find(|grid| grid.is_announced()) {
            return broken(format!("it does not send the geometry of its volume `{}`", grid.name));
        }
        self.collect(&before)
    }

    fn open(&mut self, setting: &Setting, layout: &Layout) -> Result<Topics, CheckFailure> {
        let configuration = &setting.configuration;
        let mut topics = Topics {
            deadline: self.subject.patience.as_secs_f64(),
            interpolation: setting.interpolation,
            figures: setting.figures.clone(),
            ..Topics::default()
        };
        let topic = |field: &str, role: &str, grid: &Grid| Topic {
            field: field.to_owned(),
            service: format!("field/{role}/{field}"),
            grid: grid.clone(),
            subscribers: 1,
            geometry: grid.is_volume().then(|| MovingGrid::service(role, &grid.name)),
        };
        let role = &self.subject.role;
        for (list, names) in [
            (&mut self.ports.outputs, &configuration.outputs),
            (&mut self.ports.observed, &configuration.observed),
        ] {
            for name in names {
                let Some(kind) = self.subject.description.field_kind(name) else {
                    return broken(format!("it provides `{name}`, which it does not describe"));
                };
                let grid = layout.grid_of(name).expect("the layout is checked");
                let topic = topic(name, role, grid);
                let known = self.ports.volumes.iter().any(|volume| volume.grid().name == grid.name);
                if let Some(service) = topic.geometry.clone().filter(|_| !known) {
                    let (endpoint, one) = (self.peers.endpoint(), ParticipantIndex::FIRST);
                    let volume = MovingGrid::open(endpoint, one, role, grid, None)?;
                    self.ports.volumes.push(volume);
                    let grid = grid.name.clone();
                    topics.geometry.push(GeometryTopic { grid, service, subscribers: 1 });
                }
                let reader = self.peers.endpoint().field_reader(&topic.service)?;
                list.push(FieldSubscription::of_role(role, kind, grid.clone(), reader));
                topics.outputs.push(topic);
            }
        }
        for (input, source) in configuration.inputs.iter().zip(&setting.sources) {
            let wanted = layout.input_grid(&input.field.name).or(input.grid.as_ref());
            let grid = wanted.expect("every input of a setting has a grid").clone();
            let topic = topic(&input.field.name, COORDINATOR, &grid);
            let length = grid.points() * source.kind.components as usize;
            let writer = self.peers.endpoint().field_writer(&topic.service, length, 1)?;
            let header = FieldHeader::new(&source.kind, COORDINATOR, &grid);
            self.ports.inputs.push(Feed {
                source: source.clone(),
                grid,
                header,
                writer,
                values: Vec::new(),
            });
            topics.inputs.push(topic);
        }
        self.peers.endpoint().close_unused();
        Ok(topics)
    }

    /// Sends `Finish`, after which the process stays for another run, and closes the ports, as the
    /// participant has done.
    pub(super) fn rest(&mut self) -> Result<(), CheckFailure> {
        let finish = Command { flags: STAY, ..Command::new(CommandKind::Finish) };
        self.ask(finish, &[])?.done()?.json::<Finished>("a summary")?;
        self.ports = Ports::default();
        self.accepted = None;
        Ok(())
    }

    /// Returns the next step to solve: the window after the accepted one.
    pub(super) fn next(&self, setting: &Setting) -> Step {
        self.accepted.map_or_else(|| setting.step(0), |step| setting.after(&step))
    }

    /// Notes that the participant was restored to the state after this step.
    pub(super) fn restored(&mut self, step: &Step) -> Result<(), CheckFailure> {
        self.accepted = Some(*step);
        self.take_geometry(step)
    }

    /// Returns the current volumes of observed fields.
    pub(super) fn volumes(&self) -> impl Iterator<Item = &Grid> {
        self.ports.volumes.iter().map(MovingGrid::grid)
    }

    /// Receives the geometry of volumes; later samples are expected on it.
    fn take_geometry(&mut self, step: &Step) -> Result<(), CheckFailure> {
        for volume in &mut self.ports.volumes {
            while let Some(grid) = volume.take(step)? {
                let on_it =
                    self.ports.observed.iter_mut().filter(|tap| tap.grid().name == grid.name);
                on_it.for_each(|tap| tap.move_to(grid));
            }
        }
        Ok(())
    }

    /// Sends every input, in a variation.
    pub(super) fn feed(&mut self, step: &Step, variation: u32) -> Result<(), CheckFailure> {
        for feed in &mut self.ports.inputs {
            let values = feed.source.values(&feed.grid, variation);
            feed.send(&values, step)?;
        }
        Ok(())
    }

    /// Sends `Solve` with the newest inputs, without waiting for the reply.
    pub(super) fn post_solve(&mut self, step: &Step) -> Result<(), CheckFailure> {
        self.post(self.solve_command(step), &[])
    }

    /// Returns `Solve` with the newest inputs.
    pub(super) fn solve_command(&self, step: &Step) -> Command {
        let mut command = Command::about(CommandKind::Solve, step);
        for (slot, feed) in self.ports.inputs.iter().enumerate() {
            command.expected[slot] = feed.header.sequence;
        }
        command
    }

    /// Sends `Solve` with the newest inputs, and waits for the reply.
    pub(super) fn ask_solve(&mut self, step: &Step) -> Result<Answer, CheckFailure> {
        self.post_solve(step)?;
        self.answer("Solve")
    }

    /// Solves a step, requires success, and receives every output.
    pub(super) fn solve(&mut self, step: &Step) -> Result<Solved, CheckFailure> {
        let reply = self.ask_solve(step)?.done()?.reply;
        Ok(Solved { reply, outputs: self.collect(step)? })
    }

    /// Sends inputs in a variation, and solves with them.
    pub(super) fn solve_with(
        &mut self,
        step: &Step,
        variation: u32,
    ) -> Result<Solved, CheckFailure> {
        self.feed(step, variation)?;
        self.solve(step)
    }

    /// Solves a window with inputs in a variation, and accepts it. Returns the outputs and the
    /// observed fields.
    pub(super) fn published(
        &mut self,
        step: &Step,
        variation: u32,
    ) -> Result<Values, CheckFailure> {
        let mut values = self.solve_with(step, variation)?.outputs;
        values.extend(self.accept(step, true)?);
        Ok(values)
    }

    /// Sends `Accept`, and returns the observed fields if requested.
    pub(super) fn accept(&mut self, step: &Step, observe: bool) -> Result<Values, CheckFailure> {
        let mut command = Command::about(CommandKind::Accept, step);
        self.accepted = Some(*step);
        command.flags = if observe { OBSERVE } else { 0 };
        self.ask(command, &[])?.done()?;
        self.none_of_outputs("Accept")?;
        let observed = if observe { &mut self.ports.observed[..] } else { &mut [] };
        let values = collected(observed, step)?;
        self.take_geometry(step)?;
        Ok(values)
    }

    /// Sends `Accept`, and returns the figures that were named in `Connect`.
    pub(super) fn accept_with_figures(&mut self, step: &Step) -> Result<Vec<u8>, CheckFailure> {
        self.accepted = Some(*step);
        let command = Command { flags: FIGURES, ..Command::about(CommandKind::Accept, step) };
        let body = self.ask(command, &[])?.done()?.body;
        self.none_of_outputs("Accept")?;
        Ok(body)
    }

    /// Receives exactly one sample of every output. Observed fields must not have been sent.
    pub(super) fn collect(&mut self, step: &Step) -> Result<Values, CheckFailure> {
        let values = collected(&mut self.ports.outputs, step)?;
        for tap in &mut self.ports.observed {
            let name = tap.kind().name.clone();
            if tap.take(step)?.is_some() {
                return broken(format!("it sends `{name}` without Accept and OBSERVE"));
            }
        }
        Ok(values)
    }

    /// Requires that no output has been sent after a command that must not publish any.
    pub(super) fn none_of_outputs(&mut self, after: &str) -> Result<(), CheckFailure> {
        for tap in &mut self.ports.outputs {
            let name = tap.kind().name.clone();
            if !matches!(tap.take(&Step::STEADY), Ok(None)) {
                return broken(format!("it sends `{name}` after {after}"));
            }
        }
        Ok(())
    }

    /// Requires that the participant still replies after an incident.
    pub(super) fn lives_on(&mut self, after: &str) -> Result<(), CheckFailure> {
        let answer = self.ask(Command::new(CommandKind::Describe), &[]);
        let answer = answer.and_then(Answer::done);
        answer.map(|_| ()).map_err(|fault| fault.at(&format!("after {after}")))
    }

    /// Receives heartbeats for a while.
    pub(super) fn listen(&mut self, time: Duration) -> Result<(), CheckFailure> {
        let Self { peers, beats, .. } = self;
        let waited = peers.idle(time, || beats.push(Instant::now()));
        waited.map_err(|stopped| self.fault(stopped, "while idle"))
    }

    /// Waits for the process to end, after a command or an event that must end it. Requires that
    /// nothing of the run is left, and returns the exit.
    pub(super) fn leave(self, why: &str) -> Result<Exit, CheckFailure> {
        let gone = self.peers.supervisor().wait_for_exits(LEAVE);
        let (exit, info) = (self.ended(), self.peers.run().info().clone());
        drop(self);
        match exit {
            Some(exit) if gone => nothing_left(&info).map(|()| exit),
            _ => late(format!("it still runs {:.0} s after {why}", LEAVE.as_secs_f64())),
        }
    }

    /// Ends like a killed coordinator: releases the locks, and leaves ports and files as they are.
    pub(super) fn abandon(self) -> Orphan {
        let Self { guard, ports, peers, .. } = self;
        peers.run().release();
        let (ports, peers) = (ManuallyDrop::new(ports), ManuallyDrop::new(peers));
        Orphan { guard, _ports: ports, peers, since: Instant::now() }
    }
}

/// Receives exactly one sample of each field, with a correct label and finite values.
fn collected(taps: &mut [FieldSubscription], step: &Step) -> Result<Values, CheckFailure> {
    let mut all = Values::with_capacity(taps.len());
    for tap in taps {
        let name = tap.kind().name.clone();
        let Some(values) = tap.take(step)?.map(<[f64]>::to_vec) else {
            return broken(format!("it does not send `{name}`"));
        };
        if let Some(index) = first_non_finite(&values) {
            return broken(format!("field `{name}` holds {} at index {index}", values[index]));
        }
        if !matches!(tap.take(step), Ok(None)) {
            return broken(format!("it sends `{name}` more than once"));
        }
        all.push((name, values));
    }
    Ok(all)
}

/// Describes the first value in which two sets of fields differ.
pub(super) fn difference(found: &Values, expected: &Values) -> Option<String> {
    found.iter().zip(expected).find_map(|((name, now), (_, then))| {
        let differs = |(a, b): (&f64, &f64)| a.to_bits() != b.to_bits();
        let index = now.iter().zip(then).position(differs)?;
        Some(format!("`{name}`[{index}] is {:e} instead of {:e}", now[index], then[index]))
    })
}

/// Reply to a command.
pub(super) struct Answer {
    pub(super) reply: Reply,
    pub(super) status: Status,
    pub(super) body: Vec<u8>,
    /// Name of the command.
    pub(super) what: String,
}

impl Answer {
    /// Requires that the command succeeded.
    pub(super) fn done(self) -> Result<Self, CheckFailure> {
        match self.status {
            Status::Done => Ok(self),
            _ => {
                let what = self.what.clone();
                broken(format!("{what} is not done: {}", self.reason()?))
            }
        }
    }

    /// Requires that the command failed or was refused, with a reason.
    pub(super) fn not_done(self, because: &str) -> Result<String, CheckFailure> {
        match self.status {
            Status::Done => broken(format!("{} is done in spite of {because}", self.what)),
            _ => self.reason(),
        }
    }

    /// Requires that the command was refused, with key, reason and fix.
    pub(super) fn refused(self, because: &str) -> Result<Refusal, CheckFailure> {
        let what = self.what.clone();
        match self.status {
            Status::Refused => self.refusal(),
            Status::Done => broken(format!("{what} is done in spite of {because}")),
            Status::Failed => {
                let reason = self.reason()?;
                broken(format!("{what} fails with {because} ({reason}); it must be refused"))
            }
        }
    }

    fn refusal(&self) -> Result<Refusal, CheckFailure> {
        let refusal: Refusal = self.json("a refusal")?;
        if [&refusal.key, &refusal.reason, &refusal.fix].iter().any(|text| text.trim().is_empty()) {
            return broken(format!("its refusal lacks key, reason or fix: {refusal:?}"));
        }
        Ok(refusal)
    }

    fn reason(&self) -> Result<String, CheckFailure> {
        if self.status == Status::Refused {
            return Ok(self.refusal()?.to_string());
        }
        let failure: Failure = self.json("a failure")?;
        match failure.error.trim().is_empty() {
            true => broken(format!("{} fails without saying why", self.what)),
            false => Ok(failure.error),
        }
    }

    /// Parses the body of the reply.
    pub(super) fn json<T: serde::de::DeserializeOwned>(
        &self,
        what: &str,
    ) -> Result<T, CheckFailure> {
        serde_json::from_slice(&self.body).map_err(|error| {
            CheckFailure::Broken(format!("the reply to {} is not {what}: {error}", self.what))
        })
    }
}

/// A participant whose coordinator has died.
pub(super) struct Orphan {
    guard: ProcessGuard,
    // A killed process does not close its ports in order, so they are never closed.
    _ports: ManuallyDrop<Ports>,
    peers: ManuallyDrop<Peers>,
    since: Instant,
}

impl Orphan {
    /// Waits until the participant ends, in time and without leaving anything. Returns the
    /// duration.
    pub(super) fn ends(self) -> Result<Duration, CheckFailure> {
        let gone = self.peers.supervisor().wait_for_exits(LEAVE);
        let took = self.since.elapsed();
        drop(self.guard);
        let left = nothing_left(self.peers.run().info());
        if left.is_err() {
            // Creating a run removes the remains of dead ones.
            drop(RunDir::create(&[]));
        }
        match gone {
            true => left.map(|()| took),
            false => late(format!("it still runs {:.0} s later", LEAVE.as_secs_f64())),
        }
    }
}

/// Requires that no folder and no shared memory of the run is left.
pub(super) fn nothing_left(info: &RunInfo) -> Result<(), CheckFailure> {
    if info.folder.exists() {
        return broken(format!("the run's folder {} is left behind", info.folder.display()));
    }
    let entries = std::fs::read_dir("/dev/shm").into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let left: Vec<String> = names.filter(|name| name.starts_with(&info.prefix)).collect();
    match left.as_slice() {
        [] => Ok(()),
        names => broken(format!("left in /dev/shm: {}", names.join(", "))),
    }
}
