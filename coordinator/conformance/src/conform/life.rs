//! One life of the participant under test: a run of its own, with the other side in our hands.
//!
//! A [`run::session::Session`] hides what a participant must not do; a life does it: it sends any
//! command, any sample, and looks at everything that comes back.

mod answer;
mod ending;

pub(super) use answer::Answer;

use super::fault::{Fault, broken, late};
use super::given::Given;
use super::setting::Setting;
use super::subject::Subject;
use contract::configuration::{Configuration, Layout};
use contract::description::Description;
use contract::grid::Grid;
use contract::message::{
    Command, CommandKind, FIGURES, FieldHeader, Finished, GeometryTopic, OBSERVE, Reply, STAY,
    Status, Topic, Topics,
};
use coupling::ParticipantIndex;
use ending::{Abandoned, nothing_left};
use proto::model::{Step, first_non_finite};
use proto::transport::{FieldWriter, TransportError};
use run::deadlines::Deadlines;
use run::error::RunError;
use run::peers::{COORDINATOR, EndsFirst, LEAVE, Peers, Seat, Stopped};
use run::session::{MovingGrid, Tap, header, layout_fault};
use run::supervise::Exit;
use std::path::Path;
use std::time::{Duration, Instant};

/// A participant may be silent while it is put through a check; its heartbeats have one of their own.
const NEVER: Duration = Duration::MAX;

/// The only participant of a run, and what it is connected to.
pub(super) struct Life {
    guard: EndsFirst,
    outputs: Vec<Tap>,
    observed: Vec<Tap>,
    /// The volumes that observed fields are on.
    volumes: Vec<MovingGrid>,
    pub(super) inputs: Vec<Feed>,
    /// When its heartbeats were received.
    pub(super) beats: Vec<Instant>,
    role: String,
    description: Description,
    patience: Duration,
    /// What was accepted last.
    accepted: Option<Step>,
    peers: Peers,
}

/// A solve that went through.
pub(super) struct Solved {
    pub(super) reply: Reply,
    pub(super) outputs: Values,
}

/// The values of several fields.
pub(super) type Values = Vec<(String, Vec<f64>)>;

/// The topic of one input.
pub(super) struct Feed {
    pub(super) given: Given,
    pub(super) grid: Grid,
    pub(super) header: FieldHeader,
    writer: FieldWriter,
    /// What was sent last.
    pub(super) values: Vec<f64>,
}

impl Feed {
    /// Sends values behind the label as it is, numbered after the last ones.
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

impl Life {
    /// Starts the participant in a run of its own; it has not joined yet.
    pub(super) fn start(subject: &Subject) -> Result<Self, Fault> {
        Self::of_version(subject, contract::PROTOCOL_VERSION)
    }

    /// Waits until it has joined.
    pub(super) fn joined(mut self) -> Result<Self, Fault> {
        let joined = self.peers.joined(ParticipantIndex::FIRST, self.patience);
        joined.map_err(|stopped| self.fault(stopped, "joining the run"))?;
        Ok(self)
    }

    /// Starts the participant in a run of some version of the contract; it has not joined yet.
    pub(super) fn of_version(subject: &Subject, protocol: u32) -> Result<Self, Fault> {
        let (role, program) = (subject.role.clone(), subject.program.clone());
        let seat = Seat { role: role.clone(), program, attach: false };
        let patience = subject.patience;
        let deadlines =
            Deadlines { start: patience, build: patience, solve: patience, heartbeat: NEVER };
        let started = Peers::start_version(protocol, &[seat], deadlines, None);
        let peers = started.map_err(|error| match error {
            RunError::Failed(failure) => {
                Fault::Broken(format!("it does not start: {}", failure.what))
            }
            other => Fault::Broken(other.to_string()),
        })?;
        let (outputs, observed, volumes, inputs, beats) = Default::default();
        Ok(Self {
            guard: peers.end_first(),
            outputs,
            observed,
            volumes,
            inputs,
            beats,
            role,
            description: subject.description.clone(),
            patience,
            accepted: None,
            peers,
        })
    }

    /// The run's folder.
    pub(super) fn folder(&self) -> &Path {
        &self.peers.info().folder
    }

    /// The participant's process has ended.
    pub(super) fn ended(&self) -> Option<Exit> {
        self.peers.supervisor().exits().pop()
    }

    /// Why a wait has ended, as a fault of the participant.
    fn fault(&self, stopped: Stopped, what: &str) -> Fault {
        let broken = |how: String| Fault::Broken(format!("{what}: {how}"));
        match stopped {
            Stopped::Interrupted(signal) => Fault::Interrupted(signal),
            Stopped::Exited(exit) => broken(format!("its process {exit}")),
            Stopped::Gone(_) => broken("its process is gone".to_owned()),
            Stopped::ReplyLost(_) => {
                broken("no answer, and its heartbeat says that it waits for a command".to_owned())
            }
            Stopped::Silent(_, time) | Stopped::Late(_, time) => {
                broken(format!("no answer within {:.0} s", time.as_secs_f64()))
            }
            Stopped::Transport(_, error) | Stopped::Doorbell(error) => error.into(),
        }
    }

    /// Sends a command; its number and the version are put in unless they are given.
    pub(super) fn post(&mut self, command: Command, body: &[u8]) -> Result<(), Fault> {
        let answered = command.kind != CommandKind::Accept as u32
            || command.flags != 0
            || !self.volumes.is_empty();
        self.peers.send(ParticipantIndex::FIRST, command, body, answered)?;
        Ok(())
    }

    /// Waits for the reply to the last command, and checks its label.
    pub(super) fn answer(&mut self, what: &str) -> Result<Answer, Fault> {
        let Self { peers, beats, patience, .. } = self;
        let waited = peers.wait(ParticipantIndex::FIRST, *patience, || beats.push(Instant::now()));
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
    pub(super) fn ask(&mut self, command: Command, body: &[u8]) -> Result<Answer, Fault> {
        let kind = CommandKind::from_number(command.kind);
        let what = kind.map_or_else(|| format!("command {}", command.kind), |k| format!("{k:?}"));
        self.post(command, body)?;
        self.answer(&what)
    }

    /// `Configure`; a layout that fits the configuration.
    pub(super) fn configure(&mut self, configuration: &Configuration) -> Result<Layout, Fault> {
        let body = serde_json::to_vec(configuration).expect("a configuration is plain data");
        let answer = self.ask(Command::new(CommandKind::Configure), &body)?.done()?;
        let layout: Layout = answer.json("a layout")?;
        match layout_fault(configuration, &layout) {
            None => Ok(layout),
            Some(fault) => broken(format!("its layout cannot be: {fault}")),
        }
    }

    /// `Configure`, `Connect` and `Initialise`; the first outputs.
    pub(super) fn prepare(&mut self, setting: &Setting) -> Result<(Layout, Values), Fault> {
        let layout = self.configure(&setting.configuration)?;
        let first = self.initialise(setting, &layout)?;
        Ok((layout, first))
    }

    /// `Connect`, with every topic open on our side, and `Initialise`.
    pub(super) fn initialise(
        &mut self,
        setting: &Setting,
        layout: &Layout,
    ) -> Result<Values, Fault> {
        let topics = self.open(setting, layout)?;
        let body = serde_json::to_vec(&topics).expect("topics are plain data");
        self.ask(Command::new(CommandKind::Connect), &body)?.done()?;
        let deadline = Instant::now() + self.patience;
        for feed in &self.inputs {
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

    fn open(&mut self, setting: &Setting, layout: &Layout) -> Result<Topics, Fault> {
        let configuration = &setting.configuration;
        let mut topics = Topics {
            deadline: self.patience.as_secs_f64(),
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
        let role = &self.role;
        for (list, names) in [
            (&mut self.outputs, &configuration.outputs),
            (&mut self.observed, &configuration.observed),
        ] {
            for name in names {
                let Some(kind) = self.description.field_kind(name) else {
                    return broken(format!("it provides `{name}`, which it does not describe"));
                };
                let grid = layout.grid_of(name).expect("the layout is checked");
                let topic = topic(name, role, grid);
                let known = self.volumes.iter().any(|volume| volume.grid().name == grid.name);
                if let Some(service) = topic.geometry.clone().filter(|_| !known) {
                    let owner = (ParticipantIndex::FIRST, role.as_str());
                    let volume = MovingGrid::open(self.peers.endpoint(), owner, grid, None)?;
                    self.volumes.push(volume);
                    let grid = grid.name.clone();
                    topics.geometry.push(GeometryTopic { grid, service, subscribers: 1 });
                }
                let reader = self.peers.endpoint().field_reader(&topic.service)?;
                list.push(Tap::of_role(role, kind, grid.clone(), reader));
                topics.outputs.push(topic);
            }
        }
        for (input, given) in configuration.inputs.iter().zip(&setting.given) {
            let wanted = layout.input_grid(&input.field.name).or(input.grid.as_ref());
            let grid = wanted.expect("every input of a setting has a grid").clone();
            let topic = topic(&input.field.name, COORDINATOR, &grid);
            let length = grid.points() * given.kind.components as usize;
            let writer = self.peers.endpoint().field_writer(&topic.service, length, 1)?;
            let header = header(&given.kind, &grid);
            self.inputs.push(Feed {
                given: given.clone(),
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

    /// `Finish`, after which it stays for another run; our ports close, as its own have.
    pub(super) fn rest(&mut self) -> Result<(), Fault> {
        let finish = Command { flags: STAY, ..Command::new(CommandKind::Finish) };
        self.ask(finish, &[])?.done()?.json::<Finished>("a summary")?;
        (self.outputs, self.observed, self.volumes, self.inputs) = Default::default();
        self.accepted = None;
        Ok(())
    }

    /// What can be solved next: the window after the accepted one.
    pub(super) fn next(&self, setting: &Setting) -> Step {
        self.accepted.map_or_else(|| setting.step(0), |step| setting.after(&step))
    }

    /// It has been restored to the state after this step.
    pub(super) fn restored(&mut self, step: &Step) -> Result<(), Fault> {
        self.accepted = Some(*step);
        self.take_geometry(step)
    }

    /// The volumes that observed fields are on, as they are now.
    pub(super) fn volumes(&self) -> impl Iterator<Item = &Grid> {
        self.volumes.iter().map(MovingGrid::grid)
    }

    /// Receives the geometry of volumes; samples are on it from here on.
    fn take_geometry(&mut self, step: &Step) -> Result<(), Fault> {
        for volume in &mut self.volumes {
            while let Some(grid) = volume.take(step)? {
                let on_it = self.observed.iter_mut().filter(|tap| tap.grid().name == grid.name);
                on_it.for_each(|tap| tap.move_to(grid));
            }
        }
        Ok(())
    }

    /// Sends every input, in a variation.
    pub(super) fn feed(&mut self, step: &Step, variation: u32) -> Result<(), Fault> {
        for feed in &mut self.inputs {
            let values = feed.given.values(&feed.grid, variation);
            feed.send(&values, step)?;
        }
        Ok(())
    }

    /// `Solve` with what was sent last, not yet answered.
    pub(super) fn post_solve(&mut self, step: &Step) -> Result<(), Fault> {
        let mut command = Command::about(CommandKind::Solve, step);
        for (slot, feed) in self.inputs.iter().enumerate() {
            command.expected[slot] = feed.header.sequence;
        }
        self.post(command, &[])
    }

    /// `Solve` with what was sent last.
    pub(super) fn ask_solve(&mut self, step: &Step) -> Result<Answer, Fault> {
        self.post_solve(step)?;
        self.answer("Solve")
    }

    /// A solve that has to go through, with every output.
    pub(super) fn solve(&mut self, step: &Step) -> Result<Solved, Fault> {
        let reply = self.ask_solve(step)?.done()?.reply;
        Ok(Solved { reply, outputs: self.collect(step)? })
    }

    /// Inputs in a variation, and a solve with them.
    pub(super) fn solve_with(&mut self, step: &Step, variation: u32) -> Result<Solved, Fault> {
        self.feed(step, variation)?;
        self.solve(step)
    }

    /// A window that is solved, with inputs in a variation, and accepted: its outputs, and the observed
    /// fields.
    pub(super) fn published(&mut self, step: &Step, variation: u32) -> Result<Values, Fault> {
        let mut values = self.solve_with(step, variation)?.outputs;
        values.extend(self.accept(step, true)?);
        Ok(values)
    }

    /// `Accept`; with the observed fields if asked for.
    pub(super) fn accept(&mut self, step: &Step, observe: bool) -> Result<Values, Fault> {
        let mut command = Command::about(CommandKind::Accept, step);
        self.accepted = Some(*step);
        if !observe && self.volumes.is_empty() {
            self.post(command, &[])?;
            return Ok(Values::new());
        }
        command.flags = if observe { OBSERVE } else { 0 };
        self.ask(command, &[])?.done()?;
        self.none_of_outputs("Accept")?;
        let observed = if observe { &mut self.observed[..] } else { &mut [] };
        let values = collected(observed, step)?;
        self.take_geometry(step)?;
        Ok(values)
    }

    /// `Accept`, with the figures that it was connected for.
    pub(super) fn accept_with_figures(&mut self, step: &Step) -> Result<Vec<u8>, Fault> {
        self.accepted = Some(*step);
        let command = Command { flags: FIGURES, ..Command::about(CommandKind::Accept, step) };
        let body = self.ask(command, &[])?.done()?.body;
        self.none_of_outputs("Accept")?;
        Ok(body)
    }

    /// Exactly one sample of every output, none of an observed field.
    pub(super) fn collect(&mut self, step: &Step) -> Result<Values, Fault> {
        let values = collected(&mut self.outputs, step)?;
        for tap in &mut self.observed {
            let name = tap.kind().name.clone();
            if tap.take(step)?.is_some() {
                return broken(format!("it sends `{name}` without Accept and OBSERVE"));
            }
        }
        Ok(values)
    }

    /// No output has come after something that is not to send any.
    pub(super) fn none_of_outputs(&mut self, after: &str) -> Result<(), Fault> {
        for tap in &mut self.outputs {
            let name = tap.kind().name.clone();
            if !matches!(tap.take(&Step::STEADY), Ok(None)) {
                return broken(format!("it sends `{name}` after {after}"));
            }
        }
        Ok(())
    }

    /// Answers still, after what it has been through.
    pub(super) fn lives_on(&mut self, after: &str) -> Result<(), Fault> {
        let answer = self.ask(Command::new(CommandKind::Describe), &[]);
        let answer = answer.and_then(Answer::done);
        answer.map(|_| ()).map_err(|fault| fault.at(&format!("after {after}")))
    }

    /// Receives heartbeats for a while.
    pub(super) fn listen(&mut self, time: Duration) -> Result<(), Fault> {
        let Self { peers, beats, .. } = self;
        let waited = peers.idle(time, || beats.push(Instant::now()));
        waited.map_err(|stopped| self.fault(stopped, "while idle"))
    }

    /// It has been let go, or must go by itself: how it ended, and whether anything is left.
    pub(super) fn leave(self, why: &str) -> Result<Exit, Fault> {
        let gone = self.peers.supervisor().wait_for_exits(LEAVE);
        let (exit, info) = (self.ended(), self.peers.info().clone());
        drop(self);
        match exit {
            Some(exit) if gone => nothing_left(&info).map(|()| exit),
            _ => late(format!("it still runs {:.0} s after {why}", LEAVE.as_secs_f64())),
        }
    }

    /// As if the coordinator were killed: its locks are free, its ports and files stay as they are.
    pub(super) fn abandon(self) -> Abandoned {
        let Self { guard, outputs, observed, volumes, inputs, peers, .. } = self;
        std::mem::forget((outputs, observed, volumes, inputs));
        let (supervisor, info) = peers.abandon(guard);
        Abandoned { supervisor, info, since: Instant::now() }
    }
}

/// Exactly one sample of each, as labelled, with finite values.
fn collected(taps: &mut [Tap], step: &Step) -> Result<Values, Fault> {
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

/// The first value in which two sets of fields differ, in words.
pub(super) fn difference(found: &Values, expected: &Values) -> Option<String> {
    found.iter().zip(expected).find_map(|((name, now), (_, then))| {
        let differs = |(a, b): (&f64, &f64)| a.to_bits() != b.to_bits();
        let index = now.iter().zip(then).position(differs)?;
        Some(format!("`{name}`[{index}] is {:e} instead of {:e}", now[index], then[index]))
    })
}
