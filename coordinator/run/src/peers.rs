//! Participants of a run as partners in a conversation: they start, join, receive commands and
//! reply.
//!
//! The session of a run, a replay and the conformance checks drive participants through [`Peers`].
//! Every wait checks the same conditions, at least every [`Doorbell::NAP`]: replies, signals of the
//! user, processes that have ended, failed replies of other participants, heartbeats, and the
//! deadline. A wait that ends early returns [`Stopped`]. If that ends the run, it becomes an error
//! that names participant, phase, reason and fix.

mod advance;
mod layout;
mod patience;
mod peer;
mod phase;
mod questions;
mod stopped;

pub use layout::{layout_fault, volume_fault};
pub use peer::Peer;
pub use phase::Phase;
pub use stopped::{Delay, Stopped};

use crate::deadlines::Deadlines;
use crate::error::{Failure, RunError, machine_failure};
use crate::program::Program;
use crate::progress::{Progress, Work, silent};
use crate::record::Recorder;
use crate::signals;
use crate::supervise::{Exit, Launch, Supervisor};
use arrayvec::ArrayVec;
use contract::configuration::{Configuration, Layout};
use contract::message::{Command, CommandKind, MOST_PARTICIPANTS, Reply, Status};
use coupling::ParticipantIndex;
use patience::Patience;
use proto::run_dir::{RunDir, RunInfo};
use proto::transport::{Beat, Doorbell, Endpoint, Message, TransportError};
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;
use std::time::{Duration, Instant};
use typed_index_collections::{TiSlice, TiVec};

/// Name under which the coordinator itself sends fields; no role may have this name.
pub const COORDINATOR: &str = "coordinator";

/// Longest time that a participant may take to end after its last reply.
pub const LEAVE: Duration = Duration::from_secs(2);

/// A role of a run, and the program that plays it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParticipantSlot {
    /// Role to play.
    pub role: String,
    /// The program that plays it.
    pub program: Program,
    /// The participant is started by hand; the run waits for it.
    pub attach: bool,
}

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
            let name = (seat.role.as_str(), seat.program.name());
            Ok(Peer::new(name, seat.attach, commands, replies, ringer))
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
        for one in self.all.keys().filter(|one| !places.contains(&usize::from(*one))) {
            if self.post(one, Command::new(CommandKind::Finish), &[]).is_err() {
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
        for one in self.all.keys() {
            if let Err(error) = self.post(one, Command::new(CommandKind::Finish), &[]) {
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

    /// Waits until every participant has joined.
    ///
    /// # Errors
    /// A participant has ended or is late, or the user has interrupted the run.
    pub fn join(&mut self) -> Result<(), RunError> {
        for one in self.all.keys() {
            let attached = self.all[one].is_attached();
            let patience = if attached { self.deadlines.solve } else { self.deadlines.start };
            self.joined(one, patience).map_err(|stopped| self.error(stopped))?;
        }
        Ok(())
    }

    /// Waits until a participant has joined.
    ///
    /// # Errors
    /// The reason why the wait ended early.
    pub fn joined(&mut self, one: ParticipantIndex, patience: Duration) -> Result<(), Stopped> {
        let mut waited = Patience::new();
        let Self { all, doorbell, supervisor, run, deadlines, phase, .. } = self;
        let watch = Watch { supervisor, run, phase: *phase, deadlines };
        let failed = |error| Stopped::Transport(one, error);
        let poll = || -> Result<_, Stopped> {
            // A participant that has not joined has no heartbeat yet.
            all[one].beat_received(Beat::Busy);
            if all[one].is_up() {
                // Connects to the replies of the participant. From here on its last reply is
                // received, even if its process has ended by then.
                all[one].receive().map_err(failed)?;
                return Ok(Some(()));
            }
            watch.look(all, one, waited.waited(), patience)?;
            Ok(None)
        };
        doorbell.wait(poll, |_, _| ())
    }

    /// Sends a command under the next sequence number.
    ///
    /// # Errors
    /// The participant has ended, or cannot be reached.
    pub fn post(
        &mut self,
        one: ParticipantIndex,
        command: Command,
        body: &[u8],
    ) -> Result<(), RunError> {
        self.send(one, command, body).map_err(|error| self.transport_failed(one, error))
    }

    /// Sends a command like [`Peers::post`], and returns the plain error of the transport.
    ///
    /// # Errors
    /// The participant cannot be reached.
    pub fn send(
        &mut self,
        one: ParticipantIndex,
        command: Command,
        body: &[u8],
    ) -> Result<(), TransportError> {
        let command = self.all[one].post(command, body)?;
        if let Some(recorder) = &self.recorder {
            recorder.command(one, &command, body);
        }
        Ok(())
    }

    /// Waits for the reply to the last command of a participant. `beat` is called at every
    /// heartbeat. The patience starts anew whenever the participant reports progress.
    ///
    /// # Errors
    /// The reason why the wait ended early.
    pub fn wait(
        &mut self,
        one: ParticipantIndex,
        patience: Duration,
        beat: impl FnMut(),
    ) -> Result<Message<Reply>, Stopped> {
        self.wait_for(&[one], patience, beat).map(|(_, reply)| reply)
    }

    /// Waits for the reply of the first of these participants, or for an earlier failed reply of
    /// any other. Returns the participant with its reply. All other replies stay in their queues.
    fn wait_for(
        &mut self,
        pending: &[ParticipantIndex],
        patience: Duration,
        mut beat: impl FnMut(),
    ) -> Result<(ParticipantIndex, Message<Reply>), Stopped> {
        let one = pending[0];
        let Self {
            all,
            hearts,
            doorbell,
            endpoint,
            supervisor,
            run,
            deadlines,
            phase,
            recorder,
            screen,
            ..
        } = self;
        let watch = Watch { supervisor, run, phase: *phase, deadlines };
        let all = RefCell::new(all);
        let mut waited = Patience::new();
        let poll = || -> Result<_, Stopped> {
            let mut all = all.borrow_mut();
            if let Some(found) = replied(&all, pending)? {
                return Ok(Some(found));
            }
            let advanced = all[one].has_advanced(endpoint);
            if advanced.map_err(|error| Stopped::Transport(one, error))? {
                waited = Patience::new();
                show(&all[one], *phase, &**screen);
            }
            match watch.look(&mut all, one, waited.waited(), patience) {
                Ok(()) => Ok(None),
                // A reply sent just before a participant ended still counts.
                Err(reason) => replied(&all, pending)?.map(Some).ok_or(reason),
            }
        };
        let heard = |index: usize, what| {
            if let Some(Some(one)) = hearts.get(index) {
                all.borrow_mut()[*one].beat_received(what);
                beat();
            }
        };
        let (who, reply) = doorbell.wait(poll, heard)?;
        if let Some(recorder) = recorder {
            recorder.reply(who, reply.header(), reply.body());
        }
        Ok((who, reply))
    }

    /// Lets time pass while watching processes and signals; `beat` is called at every heartbeat.
    ///
    /// # Errors
    /// A process has ended, or the user has interrupted the run.
    pub fn idle(&mut self, time: Duration, beat: impl FnMut()) -> Result<(), Stopped> {
        let until = Instant::now() + time;
        self.attend(|| (Instant::now() >= until).then_some(()), beat)
    }

    /// Waits for an event that does not come from a participant, while watching processes and
    /// signals. `found` is polled whenever the doorbell of the coordinator rings, and `beat` is
    /// called at every heartbeat.
    ///
    /// # Errors
    /// A process has ended, or the user has interrupted the run.
    pub fn attend<T>(
        &mut self,
        mut found: impl FnMut() -> Option<T>,
        mut beat: impl FnMut(),
    ) -> Result<T, Stopped> {
        let Self { doorbell, supervisor, all, .. } = self;
        let poll = || -> Result<_, Stopped> {
            interrupted_or_exited(supervisor, all, |_| false)?;
            Ok(found())
        };
        doorbell.wait(poll, |_, _| beat())
    }

    /// Waits for the reply to the last command of a participant, whatever its status.
    ///
    /// # Errors
    /// The wait ended early; the reason as the error of a run.
    pub fn reply(
        &mut self,
        one: ParticipantIndex,
        patience: Duration,
    ) -> Result<Message<Reply>, RunError> {
        self.wait(one, patience, || ()).map_err(|stopped| self.error(stopped))
    }

    /// Waits for the next reply of the pending participants, and removes its sender from the list.
    /// Returns `None` once the list is empty. Replies come in the order of the list, but a failed
    /// reply comes as soon as it arrives. The inner result is an error if the participant reports a
    /// failure; the others can still be waited for.
    ///
    /// # Errors
    /// A participant refuses the case, violates the contract, has ended, or is late.
    pub fn next_reply(
        &mut self,
        pending: &mut Participants,
        patience: impl Fn(ParticipantIndex) -> Duration,
    ) -> Result<Option<Answer>, RunError> {
        let Some(&first) = pending.first() else { return Ok(None) };
        let waited = self.wait_for(pending, patience(first), || ());
        let (one, message) = waited.map_err(|stopped| self.error(stopped))?;
        pending.retain(|other| *other != one);
        Ok(Some((one, self.judge(one, message)?)))
    }

    /// Waits for the reply to the last command, and returns an error unless the command succeeded.
    ///
    /// # Errors
    /// The participant refuses or fails, violates the contract, has ended, or is late.
    pub fn done(
        &mut self,
        one: ParticipantIndex,
        patience: Duration,
    ) -> Result<Message<Reply>, RunError> {
        let message = self.reply(one, patience)?;
        self.judge(one, message)?
    }

    /// Checks a reply. The inner result is an error if the command has failed.
    fn judge(
        &self,
        one: ParticipantIndex,
        message: Message<Reply>,
    ) -> Result<Result<Message<Reply>, RunError>, RunError> {
        let (reply, body) = (message.header(), message.body());
        match Status::from_number(reply.status) {
            _ if reply.protocol != contract::PROTOCOL_VERSION => {
                let theirs = reply.protocol;
                Err(self.misbehaved(one, format!("it speaks protocol {theirs}")))
            }
            _ if reply.sequence != self.all[one].sequence() => {
                let (found, expected) = (reply.sequence, self.all[one].sequence());
                Err(self
                    .misbehaved(one, format!("it answered command {found} instead of {expected}")))
            }
            Some(Status::Done) => Ok(Ok(message)),
            Some(Status::Refused) => Err(self.all[one].refused(body)),
            Some(Status::Failed) => Ok(Err(self.failed(one, peer::failure_text(body)))),
            None => {
                let status = reply.status;
                Err(self.misbehaved(one, format!("it replied with the unknown status {status}")))
            }
        }
    }

    /// Returns the error of a participant that failed for this reason.
    #[must_use]
    pub fn failed(&self, one: ParticipantIndex, what: String) -> RunError {
        self.failure(one, what, stopped::MESSAGES.to_owned())
    }

    /// Returns the error of a participant that violated the contract.
    #[must_use]
    pub fn misbehaved(&self, one: ParticipantIndex, what: String) -> RunError {
        let fix = "the program violates the participant contract (docs/ARCHITECTURE.md)";
        self.failure(one, what, fix.to_owned())
    }

    /// Returns the error of a participant that failed in the current phase.
    #[must_use]
    pub fn failure(&self, one: ParticipantIndex, what: String, fix: String) -> RunError {
        let (who, when) = (self.all[one].who(), self.phase.to_string());
        RunError::Failed(Failure { who, when, what, fix })
    }

    /// Returns the error of a failed exchange with a participant.
    #[must_use]
    pub fn transport_failed(&self, one: ParticipantIndex, error: TransportError) -> RunError {
        self.error(Stopped::Transport(one, error))
    }

    /// Returns the reason why a wait ended early as the error of a run.
    #[must_use]
    pub fn stopped(&self, stopped: Stopped) -> RunError {
        self.error(stopped)
    }

    fn error(&self, stopped: Stopped) -> RunError {
        let stopped = match stopped {
            Stopped::Transport(one, error) => {
                self.exit_soon().map_or(Stopped::Transport(one, error), Stopped::Exited)
            }
            other => other,
        };
        stopped.error(&self.all, self.phase)
    }

    /// Returns the actual cause of a participant's error: the end of another participant's process,
    /// if there was one, or else the error itself.
    #[must_use]
    pub fn cause(&self, error: RunError) -> RunError {
        let RunError::Failed(failure) = &error else { return error };
        let is_other = |exit: &Exit| {
            let own = |peer: &Peer| peer.role() == exit.role && peer.who() == failure.who;
            !exit.is_success() && !self.all.iter().any(own)
        };
        match self.exit_soon().filter(is_other) {
            Some(exit) => self.error(Stopped::Exited(exit)),
            None => error,
        }
    }

    /// Returns a process that ends within 100 ms: the cause of an error often is that a participant
    /// has just died.
    fn exit_soon(&self) -> Option<Exit> {
        let until = Instant::now() + Duration::from_millis(100);
        while Instant::now() < until {
            if let Some(exit) = self.exits().into_iter().next() {
                return Some(exit);
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        None
    }

    /// Waits until the participants that have been asked to finish have ended, for [`LEAVE`] at
    /// most.
    pub fn wait_for_exits(&self) {
        if !self.supervisor.wait_for_exits(LEAVE) {
            tracing::warn!("a participant did not end after Finish and is killed");
        }
    }

    /// Ends like a killed coordinator: releases the locks, and leaves ports and files as they are.
    #[must_use]
    pub fn abandon(self, mut guard: ProcessGuard) -> (Arc<Supervisor>, RunInfo) {
        guard.0 = None;
        let Self { supervisor, all, doorbell, endpoint, run, .. } = self;
        // A killed process does not close its ports in order, so leak them deliberately.
        std::mem::forget((all, doorbell, endpoint));
        (supervisor, run.info().clone())
    }

    /// Returns the guard that ends the processes before other ports in the run close.
    #[must_use]
    pub fn end_first(&self) -> ProcessGuard {
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

    /// Returns the description of the run.
    #[must_use]
    pub fn info(&self) -> &RunInfo {
        self.run.info()
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

/// Shows the progress of a participant.
fn show(peer: &Peer, phase: Phase, screen: &dyn Progress) {
    if let Some((report, left)) = peer.advance() {
        screen.working(&Work { role: peer.role(), doing: phase.doing(), report, left });
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

/// Returns the reply of the first of these participants, or a failed reply of any other.
fn replied(
    all: &TiSlice<ParticipantIndex, Peer>,
    pending: &[ParticipantIndex],
) -> Result<Option<(ParticipantIndex, Message<Reply>)>, Stopped> {
    for (place, &one) in pending.iter().enumerate() {
        let failed = |error| Stopped::Transport(one, error);
        if (place == 0 || all[one].has_failed().map_err(failed)?)
            && let Some(message) = all[one].receive().map_err(failed)?
        {
            return Ok(Some((one, message)));
        }
    }
    Ok(None)
}

/// Conditions that are watched while waiting.
struct Watch<'a> {
    supervisor: &'a Supervisor,
    run: &'a RunDir,
    phase: Phase,
    deadlines: &'a Deadlines,
}

impl Watch<'_> {
    /// Returns an error if there is a reason to stop waiting.
    fn look(
        &self,
        all: &mut TiSlice<ParticipantIndex, Peer>,
        one: ParticipantIndex,
        waited: Duration,
        patience: Duration,
    ) -> Result<(), Stopped> {
        // A participant that has been asked to finish may have ended regularly, unless the wait is
        // for its reply.
        let in_peace = |role: &str| self.phase == Phase::Finishing && role != all[one].role();
        let left = |exit: &Exit| in_peace(&exit.role) && exit.is_success();
        interrupted_or_exited(self.supervisor, all, left)?;
        // A participant started by hand is not a child process: its lock shows its death.
        let has_left = |peer: &Peer| {
            peer.is_attached() && !in_peace(peer.role()) && self.run.has_left(peer.role())
        };
        if self.phase != Phase::Starting
            && let Some(gone) = all.position(has_left)
        {
            return Err(Stopped::Gone(gone));
        }
        if all[one].has_dealt_with_it() {
            return Err(Stopped::ReplyLost(one));
        }
        let silence = all[one].silence();
        if silence > self.deadlines.heartbeat {
            return Err(Stopped::Silent(one, silence));
        }
        if waited > patience {
            return Err(Stopped::Late(one, Delay { waited: patience, silence }));
        }
        Ok(())
    }
}

/// Returns the exits of these participants so far.
fn exits(supervisor: &Supervisor, all: &TiSlice<ParticipantIndex, Peer>) -> Vec<Exit> {
    let mut exits = supervisor.exits();
    exits.retain(|exit| all.iter().any(|peer| peer.role() == exit.role));
    exits
}

/// Returns an error if the user has interrupted the run, or a process has ended unexpectedly.
fn interrupted_or_exited(
    supervisor: &Supervisor,
    all: &TiSlice<ParticipantIndex, Peer>,
    in_peace: impl Fn(&Exit) -> bool,
) -> Result<(), Stopped> {
    if let Some(signal) = signals::received() {
        return Err(Stopped::Interrupted(signal));
    }
    match exits(supervisor, all).into_iter().find(|exit| !in_peace(exit)) {
        Some(exit) => {
            let signal = exit.status.and_then(signals::received_like);
            Err(signal.map_or(Stopped::Exited(exit), Stopped::Interrupted))
        }
        None => Ok(()),
    }
}
