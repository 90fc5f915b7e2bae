//! Runs the program as a participant of a local run. Data from the remote coordinator reaches it
//! through shared memory, as if the coordinator were on this machine.
//!
//! Only the start has a deadline here. The coordinator receives every heartbeat, applies all other
//! deadlines, and disconnects when one expires; the participant then ends.

use super::config::ServerConfig;
use super::place::Place;
use super::processes::Processes;
use crate::frame::Frame;
use crate::link::{Fault, Link, Sending};
use crate::pack::Packing;
use crate::routes::{Components, ForwardError, Readers, Routes, SampleError, Writers};
use contract::message::{Command, CommandKind, Reply, StateFile, Status, Topics};
use contract::text::one_line;
use coupling::ParticipantIndex;
use proto::transport::TransportError;
use run::deadlines::Deadlines;
use run::error::RunError;
use run::peers::{COORDINATOR, ParticipantSlot, Peers, Phase, ProcessGuard, Stopped};
use run::progress::{Progress, Work};
use run::supervise::Exit;
use std::fs::File;
use std::io::Read;
use std::os::unix::process::ExitStatusExt;
use std::path::PathBuf;
use std::rc::Rc;
use std::time::{Duration, Instant};

/// Index of the only participant.
const ONE: ParticipantIndex = ParticipantIndex::FIRST;
/// Longer than the deadline of any coordinator.
const FOR_EVER: Duration = Duration::from_secs(365 * 86_400);
const DEADLINES: Deadlines = Deadlines {
    start: Duration::from_secs(300),
    build: FOR_EVER,
    solve: FOR_EVER,
    heartbeat: FOR_EVER,
};
/// Bytes of a state in one message.
const PIECE: u64 = 1 << 20;
/// Time for a process to exit after its connection failed.
const EXITS: Duration = Duration::from_millis(200);

/// Early end of a run: exit code and error message for the client.
#[derive(Debug)]
pub(super) struct Over {
    pub(super) code: u8,
    pub(super) words: String,
}

impl Over {
    fn of(words: impl std::fmt::Display) -> Self {
        Self { code: 1, words: words.to_string() }
    }

    /// Describes the exit of a process: its last words, or how it ended.
    fn exit(exit: &Exit) -> Self {
        let code =
            exit.status.and_then(|status| status.code()).and_then(|code| u8::try_from(code).ok());
        let signal = exit.status.and_then(|status| status.signal());
        let how = match (code, signal) {
            (Some(code), _) => format!("ended with exit code {code}"),
            (None, Some(signal)) => format!("was killed by signal {signal}"),
            (None, None) => "ended".to_owned(),
        };
        let words = match (&exit.last_words, signal) {
            (Some(last), None) => last.clone(),
            (Some(last), Some(_)) => format!("the process at the server {how}, saying: {last}"),
            (None, _) => format!("the process at the server {how}"),
        };
        let killed = || 128 + signal.and_then(|signal| u8::try_from(signal).ok()).unwrap_or(0);
        Self { code: code.unwrap_or_else(killed).max(1), words }
    }
}

macro_rules! over_of {
    ($($error:ty),*) => { $(impl From<$error> for Over {
        fn from(error: $error) -> Self {
            Self::of(error)
        }
    })* };
}
over_of!(Fault, TransportError, ForwardError, SampleError, RunError, std::io::Error);

/// Shows the progress of long work at the client.
struct ToClient(Sending);

impl std::fmt::Debug for ToClient {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("ToClient")
    }
}

impl Progress for ToClient {
    fn window(&self, _done: u64, _reached: f64) {}

    fn working(&self, work: &Work<'_>) {
        // The monitor notices a lost link.
        let _ = self.0.sign(&Frame::Progress(work.report));
    }

    fn finish(&self) {}
}

/// Takes part in a run until the client finishes or leaves. Calls `begun` when the ports of the run
/// are opened, which comes after the questions.
pub(super) fn run(
    (config, packing): (&ServerConfig, Packing),
    link: &Link,
    processes: &Processes,
    begun: impl FnMut(),
) -> Result<(), Over> {
    let ServerConfig { program, role, components, .. } = config;
    let seat = ParticipantSlot { role: role.clone(), program: program.clone(), attach: false };
    let mut peers = Peers::start(&[seat], DEADLINES, None)?;
    processes.end_with(link, peers.process_guard());
    peers.show_on(&(Rc::new(ToClient(link.sending.clone())) as Rc<dyn Progress>));
    let bell = peers.endpoint().ringer(COORDINATOR)?;
    link.ring(Some(Box::new(move || {
        let _ = bell.ring();
    })));
    let place = Place::new(&peers.run().info().folder)?;
    let ends_first = peers.process_guard();
    let mut run = Run {
        _ends_first: ends_first,
        config,
        link,
        packing,
        components: components.clone(),
        ports: None,
        place,
        peers,
    };
    let ended = run.serve(begun);
    link.ring(None);
    let ended = ended.map_err(|over| match run.peers.phase {
        Phase::Starting => over,
        phase if link.lost().is_some() => Over { words: format!("{phase}"), ..over },
        _ => over,
    });
    drop(run);
    processes.let_go();
    ended
}

struct Run<'a> {
    // Drop order: processes end first, then ports close, then the folder of the run is removed.
    _ends_first: ProcessGuard,
    config: &'a ServerConfig,
    link: &'a Link,
    packing: Packing,
    components: Components,
    ports: Option<(Readers, Writers)>,
    place: Place,
    peers: Peers,
}

impl Run<'_> {
    fn serve(&mut self, mut begun: impl FnMut()) -> Result<(), Over> {
        let joined = self.peers.joined(ONE, DEADLINES.start);
        joined.map_err(|stopped| self.over(stopped))?;
        self.link.sending.send(&Frame::Joined { description: &self.config.description })?;
        loop {
            let message = self.next()?;
            match Frame::read(&message).map_err(Fault::from)? {
                Frame::Sample { topic, header, packing, values, bytes } => {
                    let Some((_, writers)) = &self.ports else { return Err(out_of_turn()) };
                    writers.publish(topic, &header, packing, values, bytes)?;
                }
                Frame::File { key, ending, last, bytes } => {
                    self.place.file(key, ending, bytes, last)?;
                }
                Frame::State { part, last, bytes } => self.place.state(part, bytes, last)?,
                Frame::Command(command, body) => {
                    if command.kind == CommandKind::Connect as u32 {
                        tracing::info!("a run has begun");
                        begun();
                    }
                    if self.command(command, body)? {
                        self.peers.wait_for_exits();
                        return Ok(());
                    }
                }
                _ => return Err(out_of_turn()),
            }
        }
    }

    /// Waits for the next message of the client.
    fn next(&mut self) -> Result<Vec<u8>, Over> {
        let Self { peers, link, .. } = self;
        let found = || match link.poll() {
            Ok(None) => None,
            Ok(Some(message)) => Some(Ok(message)),
            Err(fault) => Some(Err(Over::from(fault))),
        };
        let next = peers.attend(found, || {
            let _ = link.sending.sign(&Frame::Beat);
        });
        next.map_err(|stopped| self.over(stopped))?
    }

    /// Passes a command on and sends back its results. Returns true after the last command.
    fn command(&mut self, command: Command, body: &[u8]) -> Result<bool, Over> {
        let kind = CommandKind::from_number(command.kind);
        let (body, topics) = self.local(kind, body)?;
        self.peers.phase = Phase::of(&command);
        self.peers
            .send(ONE, command, &body)
            .map_err(|error| self.over(Stopped::Transport(ONE, error)))?;
        let sending = self.link.sending.clone();
        let reply = self.peers.wait(ONE, FOR_EVER, || {
            let _ = sending.sign(&Frame::Beat);
        });
        let message = reply.map_err(|stopped| self.over(stopped))?;
        let (reply, body): (Reply, Vec<u8>) = (*message.header(), message.body().to_vec());
        drop(message);
        let done = reply.status == Status::Done as u32;
        match (kind, topics) {
            (Some(CommandKind::Connect), Some(_)) if done => {
                let until = Instant::now() + DEADLINES.start;
                if let Some((_, writers)) = &self.ports {
                    writers.wait_for_subscribers(until)?;
                }
            }
            (Some(CommandKind::Connect), _) => self.ports = None,
            (Some(CommandKind::Save), _) if done => self.send_state()?,
            _ => {}
        }
        if matches!(kind, Some(CommandKind::Save | CommandKind::Restore)) {
            self.place.clear_state();
        }
        if let Some((readers, _)) = &self.ports {
            readers.forward(&self.link.sending, self.packing)?;
        }
        self.link.sending.send(&Frame::Reply(reply, &body))?;
        Ok(done && kind == Some(CommandKind::Finish))
    }

    /// Converts the body of a command for this machine. An invalid body is left for the participant
    /// to reject.
    fn local(
        &mut self,
        kind: Option<CommandKind>,
        body: &[u8],
    ) -> Result<(Vec<u8>, Option<Topics>), Over> {
        let body = match kind {
            Some(CommandKind::Configure) => {
                self.components.configured(body);
                self.place.configuration(body)
            }
            Some(CommandKind::Connect) => {
                let Ok(topics) = serde_json::from_slice::<Topics>(body) else {
                    return Ok((body.to_vec(), None));
                };
                self.open(&topics)?;
                let there = serde_json::to_vec(&Routes::at_server(&topics));
                return Ok((there.expect("topics are plain data"), Some(topics)));
            }
            Some(CommandKind::Save | CommandKind::Restore) => {
                let Ok(mut file) = serde_json::from_slice::<StateFile>(body) else {
                    return Ok((body.to_vec(), None));
                };
                file.path = self.place.part(0);
                for (output, part) in file.outputs.iter_mut().zip(1..) {
                    output.path = self.place.part(part);
                }
                serde_json::to_vec(&file).expect("paths of a run are UTF-8")
            }
            _ => body.to_vec(),
        };
        Ok((body, None))
    }

    fn open(&mut self, topics: &Topics) -> Result<(), Over> {
        let routes = Routes::of(topics, &self.components);
        let endpoint = self.peers.endpoint();
        self.ports = None;
        let writers = Writers::open(endpoint, &routes.inward, true)?;
        let readers = Readers::open(endpoint, &routes.outward)?;
        endpoint.close_unused();
        self.link.allow(routes.longest());
        self.ports = Some((readers, writers));
        Ok(())
    }

    /// Sends the state that was just saved.
    fn send_state(&self) -> Result<(), Over> {
        let path: PathBuf = self.place.part(0);
        let mut file = File::open(path)?;
        let mut piece = Vec::new();
        loop {
            piece.clear();
            let count = file.by_ref().take(PIECE).read_to_end(&mut piece)?;
            let last = (count as u64) < PIECE;
            self.link.sending.send(&Frame::State { part: 0, last, bytes: &piece })?;
            if last {
                return Ok(());
            }
        }
    }

    /// Converts the reason why a wait has ended into an error for the client.
    fn over(&self, stopped: Stopped) -> Over {
        match stopped {
            Stopped::Interrupted(signal) => {
                Over::of(format!("the server was interrupted by {signal}"))
            }
            Stopped::Exited(exit) => Over::exit(&exit),
            Stopped::ReplyLost(_) => Over::of(
                "the participant at the server processed the last command, but its reply did not arrive",
            ),
            Stopped::Late(_, delay) => {
                let seconds = delay.waited.as_secs_f64();
                Over::of(format!(
                    "the participant at the server did not join within {seconds:.0} s"
                ))
            }
            Stopped::Silent(..) | Stopped::Gone(_) => {
                Over::of("the participant at the server is gone")
            }
            Stopped::Doorbell(error) => Over::of(one_line(&error.to_string())),
            Stopped::Transport(_, error) => {
                let until = Instant::now() + EXITS;
                while Instant::now() < until {
                    if let Some(exit) = self.peers.supervisor().exits().first() {
                        return Over::exit(exit);
                    }
                    std::thread::sleep(Duration::from_millis(1));
                }
                Over::of(one_line(&error.to_string()))
            }
        }
    }
}

fn out_of_turn() -> Over {
    Over::of("the client sent an unexpected message")
}
