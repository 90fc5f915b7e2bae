//! The participant `left` without [`proto::participant`]: every message by hand, so that it can
//! break the contract in ways that the library does not allow.

use crate::toy::{LEFT_VALUE, Toy};
use proto::configuration::Configuration;
use proto::message::{
    Command, CommandKind, FieldHeader, Finished, Label, OBSERVE, Reply, Status, Topics,
};
use proto::model::Solver;
use proto::run_dir::RunDir;
use proto::transport::{Doorbell, Endpoint, FieldReader, FieldWriter, Receiver, TransportError};
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Describes itself like `left`, and joins as a rogue.
pub fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().collect();
    match arguments.iter().position(|a| a == "--join").and_then(|at| arguments.get(at + 1)) {
        Some(folder) => match take_part(Path::new(folder)) {
            Ok(()) => ExitCode::SUCCESS,
            Err(_) => ExitCode::FAILURE,
        },
        None => proto::participant::main(&Toy::LEFT),
    }
}

struct Field {
    writer: FieldWriter,
    inputs: Vec<FieldReader>,
    header: FieldHeader,
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
        let answer = rogue.handle(&endpoint, kind, &command, &body)?;
        if kind == CommandKind::Accept && command.flags & OBSERVE == 0 {
            continue;
        }
        replies.send(&rogue.reply(&command), &answer)?;
        coordinator.ring()?;
        if kind == CommandKind::Finish {
            return Ok(());
        }
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
        |_| (),
    )
}

impl Rogue {
    fn is_at(&self, command: &Command, fault: &str) -> bool {
        let solving = command.kind == CommandKind::Solve as u32;
        solving && command.window == self.fault_window && self.fault == fault
    }

    fn reply(&self, command: &Command) -> Reply {
        let mut reply = Reply::new(Status::Done, command.sequence);
        if self.is_at(command, "old-reply") {
            reply.protocol = 0;
        }
        if self.is_at(command, "wrong-answer") {
            reply.sequence -= 1;
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
            CommandKind::Describe => return Ok(serde_json::to_vec(&Toy::LEFT.description())?),
            CommandKind::Configure => {
                let configuration: Configuration = serde_json::from_slice(body)?;
                self.fault = configuration.case.text("left.fault")?.to_owned();
                self.fault_window = configuration.case.integer("left.fault_window")? as u64;
                let setup = Toy::LEFT.configure(&configuration)?;
                return Ok(serde_json::to_vec(setup.layout())?);
            }
            CommandKind::Initialise => {
                self.field = Some(open(endpoint, &serde_json::from_slice(body)?)?);
                self.publish(command)?;
            }
            CommandKind::Solve => self.publish(command)?,
            CommandKind::Finish => return Ok(serde_json::to_vec(&Finished::default())?),
            _ => {}
        }
        Ok(Vec::new())
    }

    fn publish(&mut self, command: &Command) -> Result<(), TransportError> {
        let at = |fault: &str| self.is_at(command, fault);
        let (short, label, skip, silent) =
            (at("short"), at("label"), at("sequence"), at("silence"));
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
    writer.wait_for_subscribers(Instant::now() + Duration::from_secs_f64(topics.deadline))?;
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
    Ok(Field { writer, inputs: inputs?, header })
}
