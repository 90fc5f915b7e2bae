//! Participant `left` written without [`proto::participant`]: it sends every message itself, so
//! that it can break the protocol in ways the library does not allow.

use crate::toy::{LEFT_VALUE, Toy};
use proto::configuration::{Configuration, FieldOnGrid, Layout};
use proto::description::Description;
use proto::field::GEOMETRY;
use proto::grid::{Grid, Structured};
use proto::message::{
    Command, CommandKind, FieldHeader, Finished, Label, RECEIVED_POWER, Reply, Status, Topics,
    WANTED_WINDOW,
};
use proto::model::Solver;
use proto::run_dir::RunDir;
use proto::transport::{
    Beat, Doorbell, Endpoint, FieldReader, FieldWriter, Receiver, Ringer, TransportError,
};
use std::ffi::OsString;
use std::path::Path;
use std::time::{Duration, Instant};

/// Describes itself like `left`, and joins a run as the rogue. Returns the exit code.
pub fn main_from(arguments: Vec<OsString>) -> u8 {
    match arguments.iter().position(|a| a == "--join").and_then(|at| arguments.get(at + 1)) {
        Some(folder) => u8::from(take_part(Path::new(folder)).is_err()),
        None => proto::participant::main_from(arguments, &Toy::LEFT),
    }
}

/// Description of `left`; with the argument `escapes`, a summary that would clear a terminal.
fn description() -> Description {
    let mut description = Toy::LEFT.description();
    if std::env::args().any(|argument| argument == "escapes") {
        "\u{1b}[2J\nno errors".clone_into(&mut description.models[0].summary);
    }
    description
}

/// Faults of a participant whose grid moves in every window.
const MOVING: &[&str] = &[
    "old-revision",
    "falling",
    "flat",
    "fraction",
    "truncated",
    "other-grid",
    "repeated",
    "grown",
    "unpublished",
];

struct Field {
    writer: FieldWriter,
    inputs: Vec<FieldReader>,
    header: FieldHeader,
    grid: Grid,
    /// Port of the grid's geometry, with the header of the last one sent.
    geometry: Option<(FieldWriter, FieldHeader)>,
}

struct Rogue {
    fault: String,
    fault_window: u64,
    field: Option<Field>,
}

fn take_part(folder: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let run = RunDir::join(folder, "left")?;
    let endpoint = Endpoint::open(run.info())?;
    let doorbell = endpoint.doorbell("left")?;
    let replies = endpoint.reply_sender("left")?;
    let coordinator = endpoint.ringer("coordinator")?;
    let commands = endpoint.command_receiver("left")?;
    coordinator.ring()?;
    let mut rogue = Rogue { fault: String::new(), fault_window: 0, field: None };
    loop {
        let (command, body) = next(&doorbell, &commands)?;
        let kind = CommandKind::from_number(command.kind).ok_or("unknown command")?;
        let mut answer = rogue.handle(&endpoint, kind, &command, &body)?;
        let mut reply = rogue.reply(&command);
        let fault = TransitionFault::at(kind);
        if rogue.is_at(&command, "lost-reply") || matches!(fault, Some(TransitionFault::LostReply))
        {
            return beat(&coordinator, Some(Beat::idle_after(command.sequence)));
        }
        match fault {
            Some(TransitionFault::Exit) => std::process::exit(3),
            Some(TransitionFault::Busy) => return beat(&coordinator, Some(Beat::Busy)),
            Some(TransitionFault::Silent) => return beat(&coordinator, None),
            Some(TransitionFault::Reply(change)) => change(&mut reply, &mut answer),
            Some(TransitionFault::LostReply) | None => {}
        }
        replies.send(&reply, &answer)?;
        coordinator.ring()?;
        if kind == CommandKind::Finish {
            return Ok(());
        }
    }
}

/// Sends this heartbeat, or none, until the run ends, for at most 60 s.
fn beat(coordinator: &Ringer, beat: Option<Beat>) -> Result<(), Box<dyn std::error::Error>> {
    for _ in 0..1200 {
        beat.map_or(Ok(()), |beat| coordinator.beat(0, beat))?;
        std::thread::sleep(Duration::from_millis(50));
    }
    Ok(())
}

/// Fault at a command of any kind, from the argument `at=KIND:FAULT`.
#[derive(Clone, Copy)]
enum TransitionFault {
    /// The process ends.
    Exit,
    /// The command is worked on for ever.
    Busy,
    /// Neither a heartbeat nor a reply.
    Silent,
    /// The heartbeat says that the command has been dealt with, and there is no reply.
    LostReply,
    /// A wrong reply.
    Reply(fn(&mut Reply, &mut Vec<u8>)),
}

impl TransitionFault {
    /// Returns the fault at this command.
    fn at(kind: CommandKind) -> Option<Self> {
        let named = |argument: String| {
            let (at, fault) = argument.strip_prefix("at=")?.split_once(':')?;
            (at == format!("{kind:?}")).then(|| fault.to_owned())
        };
        let fault = std::env::args().find_map(named)?;
        let change: fn(&mut Reply, &mut Vec<u8>) = match fault.as_str() {
            "exit" => return Some(Self::Exit),
            "busy" => return Some(Self::Busy),
            "silent" => return Some(Self::Silent),
            "lost-reply" => return Some(Self::LostReply),
            "failed" => |reply, body| {
                reply.status = Status::Failed as u32;
                *body = br#"{"error": "on purpose"}"#.to_vec();
            },
            "refused" => |reply, body| {
                reply.status = Status::Refused as u32;
                *body = br#"{"key": "left.delay", "reason": "on purpose", "fix": "none"}"#.to_vec();
            },
            "status" => |reply, _| reply.status = 9,
            "protocol" => |reply, _| reply.protocol = 0,
            "sequence" => |reply, _| reply.sequence -= 1,
            "body" => |_, body| *body = b"{".to_vec(),
            "none" => |_, _| (),
            other => panic!("there is no fault {other}"),
        };
        Some(Self::Reply(change))
    }
}

fn next(
    doorbell: &Doorbell,
    commands: &Receiver<Command>,
) -> Result<(Command, Vec<u8>), TransportError> {
    let deadline = Instant::now() + Duration::from_secs(60);
    doorbell.wait(
        || {
            if Instant::now() > deadline {
                std::process::exit(1);
            }
            let message = commands.receive()?;
            Ok(message.map(|m| (*m.header(), m.body().to_vec())))
        },
        |_, _| (),
    )
}

impl Rogue {
    fn is_at(&self, command: &Command, fault: &str) -> bool {
        let moves = MOVING.contains(&fault) && fault != "old-revision";
        let when = if moves { CommandKind::Accept } else { CommandKind::Solve };
        command.kind == when as u32 && command.window == self.fault_window && self.fault == fault
    }

    fn reply(&self, command: &Command) -> Reply {
        let mut reply = Reply::new(Status::Done, command.sequence);
        if self.is_at(command, "old-reply") {
            reply.protocol = 0;
        }
        if self.is_at(command, "wrong-answer") {
            reply.sequence -= 1;
        }
        let at = |fault: &str| self.is_at(command, fault);
        let wish = |reply: &mut Reply, window| {
            (reply.wanted_window, reply.present) = (window, WANTED_WINDOW);
        };
        let power = |reply: &mut Reply, power| {
            (reply.received_power, reply.present) = (power, RECEIVED_POWER);
        };
        match () {
            () if at("time-is-no-number") => reply.model_seconds = f64::NAN,
            () if at("negative-time") => reply.model_seconds = -1e-9,
            () if at("negative-wish") => wish(&mut reply, -1.0),
            () if at("endless-wish") => wish(&mut reply, f64::INFINITY),
            () if at("infinite-power") => power(&mut reply, f64::NEG_INFINITY),
            () if at("power-once") => power(&mut reply, 0.0),
            () => {}
        }
        reply
    }

    fn handle(
        &mut self,
        endpoint: &Endpoint,
        kind: CommandKind,
        command: &Command,
        body: &[u8],
    ) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
        match kind {
            CommandKind::Describe => return Ok(serde_json::to_vec(&description())?),
            CommandKind::Configure => {
                let configuration: Configuration = serde_json::from_slice(body)?;
                self.fault = configuration.case.text("left.fault")?.to_owned();
                self.fault_window = configuration.case.integer("left.fault_window")? as u64;
                let setup = Toy::LEFT.configure(&configuration)?;
                return Ok(serde_json::to_vec(&self.layout(setup.layout()))?);
            }
            CommandKind::Connect => {
                self.field = Some(open(endpoint, &serde_json::from_slice(body)?)?);
            }
            CommandKind::Initialise | CommandKind::Solve => self.publish(command)?,
            CommandKind::Accept => self.move_grid(command)?,
            CommandKind::Finish => return Ok(serde_json::to_vec(&Finished::default())?),
            _ => {}
        }
        Ok(Vec::new())
    }

    /// Returns the layout, with the fault applied.
    fn layout(&self, honest: &Layout) -> Layout {
        let mut layout = honest.clone();
        if MOVING.contains(&self.fault.as_str()) {
            layout.moving = vec![layout.grids[0].name.clone()];
        }
        let flat = Structured::contact_plane(0.0, 0.0, 0.0, 1.0, 3, 2);
        let wish = match self.fault.as_str() {
            "wish-flat" => {
                layout.grids.push(Grid::structured("own", flat));
                ("right_value", "own")
            }
            "wish-nowhere" => ("right_value", "own"),
            "wish-unheard" => ("pressure", "numbers"),
            _ => return layout,
        };
        layout.inputs = vec![FieldOnGrid { field: wish.0.to_owned(), grid: wish.1.to_owned() }];
        layout
    }

    /// Moves the grid by 1 along x and publishes the geometry; wrongly in the window of the fault.
    fn move_grid(&mut self, command: &Command) -> Result<(), Box<dyn std::error::Error>> {
        let at = |fault: &str| self.is_at(command, fault);
        let (falls, other, repeats) = (at("falling"), at("other-grid"), at("repeated"));
        let (flat, part, short) = (at("flat"), at("fraction"), at("truncated"));
        let (grown, silent) = (at("grown"), at("unpublished"));
        let Some(Field { grid, header, geometry: Some((writer, label)), .. }) = &mut self.field
        else {
            return Ok(());
        };
        let mut shape = *grid.as_structured().ok_or("the grid is structured")?;
        shape.origin[0] += 1.0;
        shape.ni += usize::from(grown);
        *grid = Grid { revision: grid.revision + 1, ..Grid::structured(&grid.name, shape) };
        header.grid_revision = grid.revision;
        if silent {
            return Ok(());
        }
        let mut values = [0.0; 12];
        grid.encode_geometry(&mut values);
        if flat {
            values[1] = 0.0;
        }
        if part {
            values[3] += 0.5;
        }
        label.sequence += u64::from(!repeats);
        label.grid_revision = if falls { 1 } else { grid.revision };
        (label.window, label.iteration) = (command.window, command.iteration);
        (label.start, label.end) = (command.start, command.end);
        if other {
            label.grid = Label::new("other");
        }
        let values = &values[usize::from(short)..];
        let mut loan = writer.loan(values.len())?;
        loan.values().copy_from_slice(values);
        Ok(writer.publish(loan, label)?)
    }

    fn publish(&mut self, command: &Command) -> Result<(), TransportError> {
        let at = |fault: &str| self.is_at(command, fault);
        let (short, label, skip, silent) =
            (at("short"), at("label"), at("sequence"), at("silence"));
        let (unannounced, old) = (at("unannounced"), at("old-revision"));
        let Some(field) = &mut self.field else { return Ok(()) };
        for input in &field.inputs {
            while input.receive()?.is_some() {}
        }
        if silent {
            return Ok(());
        }
        let mut header = field.header;
        header.sequence += if skip { 2 } else { 1 };
        header.window = command.window;
        header.iteration = command.iteration;
        (header.start, header.end) = (command.start, command.end);
        field.header = header;
        if label {
            header.name = Label::new("pressure");
        }
        header.grid_revision += u64::from(unannounced);
        header.grid_revision -= u64::from(old);
        let mut loan = field.writer.loan(header.points as usize - usize::from(short))?;
        loan.values().fill(1.0);
        field.writer.publish(loan, &header)
    }
}

fn open(endpoint: &Endpoint, topics: &Topics) -> Result<Field, Box<dyn std::error::Error>> {
    let topic = topics.outputs.first().ok_or("no output")?;
    let inputs: Result<Vec<_>, _> =
        topics.inputs.iter().map(|t| endpoint.field_reader(&t.service)).collect();
    let points = topic.grid.points();
    let writer = endpoint.field_writer(&topic.service, points, topic.subscribers)?;
    let geometry = topics.geometry.first().map(|moving| -> Result<_, TransportError> {
        let writer = endpoint.field_writer(&moving.service, 12, moving.subscribers)?;
        let label = FieldHeader {
            protocol: proto::PROTOCOL_VERSION,
            components: GEOMETRY.components,
            points: 4,
            name: Label::new(GEOMETRY.name),
            unit: Label::new(GEOMETRY.unit),
            producer: Label::new("left"),
            grid: Label::new(&moving.grid),
            ..FieldHeader::default()
        };
        Ok((writer, label))
    });
    let header = FieldHeader {
        protocol: proto::PROTOCOL_VERSION,
        components: 1,
        points: points as u64,
        grid_revision: topic.grid.revision,
        name: Label::new(LEFT_VALUE.name),
        unit: Label::new(LEFT_VALUE.unit),
        producer: Label::new("left"),
        grid: Label::new(&topic.grid.name),
        ..FieldHeader::default()
    };
    let (inputs, geometry) = (inputs?, geometry.transpose()?);
    Ok(Field { writer, inputs, header, grid: topic.grid.clone(), geometry })
}
