//! Participants of a run as partners in a conversation: they start, join, receive commands and
//! reply.
//!
//! The session of a run, a replay and the conformance checks drive participants through [`Peers`].
//! Every wait checks the same conditions, at least every [`Doorbell::NAP`]: replies, signals of the
//! user, processes that have ended, failed replies of other participants, heartbeats, and the
//! deadline. A wait that ends early returns [`Stopped`]. If that ends the run, it becomes an error
//! that names participant, phase, reason and fix.

mod advance;
mod errors;
mod layout;
mod patience;
mod peer;
mod phase;
mod questions;
mod slot;
mod stopped;
mod waiting;

pub use layout::{layout_fault, volume_fault};
pub use peer::Peer;
pub use phase::Phase;
pub use slot::ParticipantSlot;
pub use stopped::{Delay, Stopped};

use crate::deadlines::Deadlines;
use crate::error::{RunError, machine_failure};
use crate::progress::{Progress, silent};
use crate::record::Recorder;
use crate::supervise::{Exit, Launch, Supervisor};
use arrayvec::ArrayVec;
use contract::configuration::{Configuration, Layout};
use contract::message::{Command, CommandKind, MOST_PARTICIPANTS, Reply};
use coupling::ParticipantIndex;
use patience::Patience;
use proto::run_dir::{RunDir, RunInfo};
use proto::transport::{Doorbell, Endpoint, Message, TransportError};
use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;
use typed_index_collections::{TiSlice, TiVec};

/// Name under which the coordinator itself sends fields; no role may have this name.
pub const COORDINATOR: &str = "coordinator";

/// Longest time that a participant may take to end after its last reply.
pub const LEAVE: Duration = Duration::from_secs(2);

/// Ends the processes when it is dropped.
///
/// An owner of further ports in the run has this guard as its first field, and its [`Peers`] as the
/// last. Thus processes end first, ports close next, and the run's folder goes last.
#[derive(Debug)]
pub struct ProcessGuard(Option<Arc<Supervisor>>);

impl ProcessGuard {
    /// Disarms the guard: the processes live on.
    pub(crate) fn spare(mut self) {
        self.0 = None;
    }
}

impl Drop for ProcessGuard {
    fn drop(&mut self) {
        if let Some(supervisor) = &self.0 {
            supervisor.end_all();
        }
    }
}

/// Some of the participants of a run, stored without allocation.
pub(crate) type Participants = ArrayVec<ParticipantIndex, MOST_PARTICIPANTS>;

/// The participant that has replied, and its reply or the failure that it reports.
pub type Answer = (ParticipantIndex, Result<Message<Reply>, RunError>);

/// The participants of a run.
// Fields drop in this order: processes end first, ports close next, the run's folder goes last.
#[derive(Debug)]
pub struct Peers {
    seats: Vec<ParticipantSlot>,
    supervisor: Arc<Supervisor>,
    recorder: Option<Arc<Recorder>>,
    all: TiVec<ParticipantIndex, Peer>,
    /// Participant of each heartbeat number; `None` for a dismissed participant.
    hearts: Vec<Option<ParticipantIndex>>,
    doorbell: Doorbell,
    endpoint: Endpoint,
    run: RunDir,
    deadlines: Deadlines,
    screen: Rc<dyn Progress>,
    /// Shared memory that the participants still hold from the previous run [byte].
    held_memory: u64,
    /// The configuration of each participant that is in force, and the layout that it gave.
    configured: TiVec<ParticipantIndex, Option<(Configuration, Layout)>>,
    /// Current phase, for messages.
    pub phase: Phase,
}

impl Peers {
    /// Creates a run and starts its participants, without waiting for them to join. With a
    /// recorder, commands and replies are recorded.
    ///
    /// # Errors
    /// The run's folder or ports cannot be created, or a program does not start.
    pub fn start(
        seats: &[ParticipantSlot],
        deadlines: Deadlines,
        recorder: Option<Arc<Recorder>>,
    ) -> Result<Self, RunError> {
        let roles: Vec<String> = seats.iter().map(|seat| seat.role.clone()).collect();
        let run = RunDir::create(&roles).map_err(|error| {
            machine_failure(
                "the machine",
                "while preparing the run",
                &error,
                "COSIM_RUNTIME_DIR may name another folder of yours in memory",
            )
        })?;
        let info = run.info().clone();
        let (prefix, folder) = (&info.prefix, info.folder.display());
        tracing::info!(prefix, %folder, "run created");
        let opened = |error: TransportError| {
            machine_failure("shared memory", "while preparing the run", &error, "check /dev/shm")
        };
        let endpoint = Endpoint::open(&info).map_err(opened)?;
        let doorbell = endpoint.doorbell(COORDINATOR).map_err(opened)?;
        let peer = |seat: &ParticipantSlot| {
            let commands = endpoint.command_sender(&seat.role)?;
            let replies = endpoint.reply_receiver(&seat.role)?;
            let ringer = endpoint.ringer(&seat.role)?;
            Ok(Peer::new(seat, commands, replies, ringer))
        };
        let all: Result<TiVec<ParticipantIndex, Peer>, TransportError> =
            seats.iter().map(peer).collect();
        let all = all.map_err(opened)?;
        let supervisor = Arc::new(launch(seats, &info)?);
        let (screen, phase) = (silent(), Phase::Starting);
        let hearts = all.keys().map(Some).collect();
        let configured = all.iter().map(|_| None).collect();
        let seats = seats.to_vec();
        Ok(Self {
            seats,
            hearts,
            supervisor,
            recorder,
            all,
            doorbell,
            endpoint,
            run,
            deadlines,
            screen,
            held_memory: 0,
            configured,
            phase,
        })
    }

    /// Detaches the participants from the run that has ended. They keep holding this much shared
    /// memory [byte].
    #[must_use]
    pub(crate) fn after_run(self, held_memory: u64) -> Self {
        let configured = self.all.iter().map(|_| None).collect();
        Self { recorder: None, screen: silent(), held_memory, configured, ..self }
    }

    /// Returns the shared memory that the participants hold between two runs [byte].
    pub(crate) fn held_memory(&self) -> u64 {
        self.held_memory
    }

    /// Sets the limits of the waits from now on.
    pub(crate) fn set_deadlines(&mut self, deadlines: Deadlines) {
        self.deadlines = deadlines;
    }

    /// Attaches the participants to another run.
    #[must_use]
    pub(crate) fn for_run(self, deadlines: Deadlines, recorder: Option<Arc<Recorder>>) -> Self {
        Self { deadlines, recorder, ..self }
    }

    /// Reduces the participants to these seats, in this order, and asks all others to leave.
    ///
    /// # Errors
    /// A seat is missing, or a participant has ended; returns the participants unchanged.
    pub(crate) fn seated(mut self, seats: &[ParticipantSlot]) -> Result<Self, Box<Self>> {
        let place = |seat: &ParticipantSlot| self.seats.iter().position(|own| own == seat);
        let places: Option<Vec<usize>> = seats.iter().map(place).collect();
        let Some(places) = places.filter(|_| self.exits().is_empty()) else {
            return Err(Box::new(self));
        };
        for participant in
            self.all.keys().filter(|participant| !places.contains(&usize::from(*participant)))
        {
            if self.post(participant, Command::new(CommandKind::Finish), &[]).is_err() {
                return Err(Box::new(self));
            }
        }
        let now = |before: ParticipantIndex| {
            places.iter().position(|place| *place == usize::from(before)).map(Into::into)
        };
        self.hearts = self.hearts.iter().map(|heart| heart.and_then(now)).collect();
        let mut known = |place: &usize| self.configured[ParticipantIndex::from(*place)].take();
        let configured = places.iter().map(&mut known).collect();
        let mut before: Vec<Option<Peer>> = self.all.into_iter().map(Some).collect();
        let all = places.iter().filter_map(|place| before[*place].take()).collect();
        Ok(Self { all, configured, seats: seats.to_vec(), ..self })
    }

    /// Returns the exits of the participants so far.
    fn exits(&self) -> Vec<Exit> {
        exits(&self.supervisor, &self.all)
    }

    /// Asks waiting participants to leave, and waits for their exits.
    pub(crate) fn dismiss(mut self) {
        self.phase = Phase::Finishing;
        for participant in self.all.keys() {
            if let Err(error) = self.post(participant, Command::new(CommandKind::Finish), &[]) {
                tracing::debug!("a waiting participant has ended: {error}");
                return;
            }
        }
        self.wait_for_exits();
    }

    /// Shows the progress of long work on this screen from now on.
    pub fn show_on(&mut self, screen: &Rc<dyn Progress>) {
        self.screen = Rc::clone(screen);
    }

    /// Sends a command under the next sequence number.
    ///
    /// # Errors
    /// The participant has ended, or cannot be reached.
    pub fn post(
        &mut self,
        participant: ParticipantIndex,
        command: Command,
        body: &[u8],
    ) -> Result<(), RunError> {
        self.send(participant, command, body)
            .map_err(|error| self.transport_failed(participant, error))
    }

    /// Sends a command like [`Peers::post`], and returns the plain error of the transport.
    ///
    /// # Errors
    /// The participant cannot be reached.
    pub fn send(
        &mut self,
        participant: ParticipantIndex,
        command: Command,
        body: &[u8],
    ) -> Result<(), TransportError> {
        let command = self.all[participant].post(command, body)?;
        if let Some(recorder) = &self.recorder {
            recorder.command(participant, &command, body);
        }
        Ok(())
    }

    /// Waits until the participants that have been asked to finish have ended, for [`LEAVE`] at
    /// most.
    pub fn wait_for_exits(&self) {
        if !self.supervisor.wait_for_exits(LEAVE) {
            tracing::warn!("a participant did not end after Finish and is killed");
        }
    }

    /// Returns the guard that ends the processes before other ports in the run close.
    #[must_use]
    pub fn process_guard(&self) -> ProcessGuard {
        ProcessGuard(Some(Arc::clone(&self.supervisor)))
    }

    /// Returns the seats of the run.
    #[must_use]
    pub fn seats(&self) -> &[ParticipantSlot] {
        &self.seats
    }

    /// Returns every participant, in the order of the seats.
    #[must_use]
    pub fn all(&self) -> &TiSlice<ParticipantIndex, Peer> {
        &self.all
    }

    /// Returns the folder and the locks of the run.
    #[must_use]
    pub fn run(&self) -> &RunDir {
        &self.run
    }

    /// Returns the services of the run.
    #[must_use]
    pub fn endpoint(&self) -> &Endpoint {
        &self.endpoint
    }

    /// Returns the limits of the waits.
    #[must_use]
    pub fn deadlines(&self) -> &Deadlines {
        &self.deadlines
    }

    /// Returns the recorder of the run, if it is recorded.
    #[must_use]
    pub fn recorder(&self) -> Option<&Arc<Recorder>> {
        self.recorder.as_ref()
    }

    /// Returns the supervisor of the processes.
    #[must_use]
    pub fn supervisor(&self) -> &Supervisor {
        &self.supervisor
    }
}

fn launch(seats: &[ParticipantSlot], info: &RunInfo) -> Result<Supervisor, RunError> {
    let started = seats.iter().filter(|seat| !seat.attach);
    let launch =
        |seat: &ParticipantSlot| Launch { role: seat.role.clone(), program: seat.program.clone() };
    let launches: Vec<Launch> = started.map(launch).collect();
    let supervisor = Supervisor::start(&launches, &info.folder).map_err(|(who, error)| {
        machine_failure(&who, "while starting", &error, "check the command of this participant")
    })?;
    for seat in seats.iter().filter(|seat| seat.attach) {
        let (role, program) = (&seat.role, seat.program.command_line());
        let folder = info.folder.display();
        tracing::warn!("waiting for {role}: start `{program} --join {folder} --role {role}`");
    }
    Ok(supervisor)
}

/// Returns the exits of these participants so far.
fn exits(supervisor: &Supervisor, all: &TiSlice<ParticipantIndex, Peer>) -> Vec<Exit> {
    let mut exits = supervisor.exits();
    exits.retain(|exit| all.iter().any(|peer| peer.role() == exit.role));
    exits
}
