//! Participants that outlive a run.
//!
//! While [`keep`] or [`start_early`] is in force on a thread, planning starts the participants of a
//! case and asks these processes for their descriptions and estimates. The run then uses the same
//! processes. With [`keep`], the participants of a successful run stay for the next run, if all of
//! them are reusable ([`contract::description::Description::reusable`]). Any failure ends the
//! processes, and the next run starts new ones.

use crate::deadlines::Deadlines;
use crate::error::RunError;
use crate::peers::{ParticipantSlot, Peers, Phase};
use crate::programs::Program;
use crate::session::{layout_fault, open_files};
use contract::configuration::{Configuration, Estimate, Layout};
use contract::description::Description;
use contract::message::{Command, CommandKind};
use std::cell::RefCell;
use std::marker::PhantomData;
use std::time::Duration;

/// Number of topics of a participant, assumed when the limit of open files is checked before
/// planning.
const TOPICS: usize = 4;

/// Lifetime of participants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RetainedParticipants {
    /// Every run starts its own participants.
    No,
    /// Participants live from the planning of a run to its end.
    ForOneRun,
    /// Participants stay from run to run.
    ForAll,
}

/// Participants of this thread that wait for a run.
struct Crew {
    kept: RetainedParticipants,
    peers: Option<Peers>,
}

thread_local! {
    static CREW: RefCell<Crew> = const { RefCell::new(Crew { kept: RetainedParticipants::No, peers: None }) };
}

/// Guard that keeps participants on this thread. Dropping the guard dismisses the waiting
/// participants.
#[derive(Debug)]
#[must_use]
pub struct RetentionGuard {
    before: RetainedParticipants,
    /// Makes the guard neither `Send` nor `Sync`: the participants belong to its thread.
    of_thread: PhantomData<*const ()>,
}

/// Lets participants of this thread's runs stay for the next run, until the guard is dropped.
pub fn keep() -> RetentionGuard {
    RetentionGuard::new(RetainedParticipants::ForAll)
}

/// Lets planning on this thread start the participants of its run, until the guard is dropped.
pub fn start_early() -> RetentionGuard {
    RetentionGuard::new(RetainedParticipants::ForOneRun)
}

impl RetentionGuard {
    fn new(kept: RetainedParticipants) -> Self {
        let before = CREW.with_borrow_mut(|crew| std::mem::replace(&mut crew.kept, kept));
        Self { before, of_thread: PhantomData }
    }
}

impl Drop for RetentionGuard {
    fn drop(&mut self) {
        CREW.with_borrow_mut(|crew| crew.kept = self.before);
        if self.before == RetainedParticipants::No {
            leave();
        }
    }
}

/// Returns whether participants stay after a run.
pub(crate) fn stays() -> bool {
    CREW.with_borrow(|crew| crew.kept == RetainedParticipants::ForAll)
}

/// Keeps the participants of a run that has ended.
pub(crate) fn stay(peers: Peers) {
    let before = CREW.with_borrow_mut(|crew| crew.peers.replace(peers));
    before.into_iter().for_each(Peers::dismiss);
}

/// Takes the waiting participants, if they hold all these seats and are alive. Otherwise dismisses
/// them.
pub(crate) fn take(seats: &[ParticipantSlot]) -> Option<Peers> {
    let peers = CREW.with_borrow_mut(|crew| crew.peers.take())?;
    match peers.seated(seats) {
        Ok(peers) => Some(peers),
        Err(others) => {
            others.dismiss();
            None
        }
    }
}

/// Returns the shared memory of the waiting participants [byte].
pub(crate) fn held_memory() -> u64 {
    CREW.with_borrow(|crew| crew.peers.as_ref().map_or(0, Peers::held_memory))
}

/// Dismisses the waiting participants.
pub(crate) fn leave() {
    let peers = CREW.with_borrow_mut(|crew| crew.peers.take());
    peers.into_iter().for_each(Peers::dismiss);
}

/// Starts participants and asks for their descriptions, unless some wait already or none are kept.
/// If that fails, planning starts a process for each question and reports the error.
pub(crate) fn start(seats: &[ParticipantSlot], patience: Duration) {
    let wanted =
        CREW.with_borrow(|crew| crew.kept != RetainedParticipants::No && crew.peers.is_none());
    if !wanted || seats.is_empty() || seats.iter().any(|seat| seat.attach) {
        return;
    }
    match described(seats, patience) {
        Ok(peers) => CREW.with_borrow_mut(|crew| crew.peers = Some(peers)),
        Err(error) => tracing::debug!("participants are not started for planning: {error}"),
    }
}

/// Starts participants, waits until they have joined, and keeps their descriptions.
fn described(seats: &[ParticipantSlot], patience: Duration) -> Result<Peers, RunError> {
    open_files::provide(seats.len(), TOPICS * seats.len(), false)?;
    let deadlines =
        Deadlines { start: patience, build: patience, solve: patience, heartbeat: patience };
    let mut peers = Peers::start(seats, deadlines, None)?;
    peers.join()?;
    peers.phase = Phase::Configuring;
    for one in peers.all().keys() {
        peers.post(one, Command::new(CommandKind::Describe), &[], true)?;
    }
    for (one, seat) in peers.all().keys().zip(seats) {
        let message = peers.done(one, patience)?;
        let description: Description = serde_json::from_slice(message.body())
            .map_err(|error| peers.misbehaved(one, error.to_string()))?;
        seat.program.learn(&seat.role, description)?;
    }
    Ok(peers)
}

/// Asks a waiting participant for its estimate. Returns `None` if no participant runs this program,
/// or if it fails or answers with a faulty layout. Planning then asks a new process.
pub(crate) fn estimate(
    program: &Program,
    configuration: &Configuration,
    patience: Duration,
) -> Option<Estimate> {
    CREW.with_borrow_mut(|crew| {
        let peers = crew.peers.as_mut()?;
        let is_it =
            |seat: &ParticipantSlot| seat.role == configuration.role && seat.program == *program;
        let one = peers.seats().iter().position(is_it)?.into();
        peers.phase = Phase::Configuring;
        let body = serde_json::to_vec(configuration).expect("a configuration is plain data");
        let asked = peers.post(one, Command::new(CommandKind::Configure), &body, true);
        let estimate = match asked.and_then(|()| peers.done(one, patience)) {
            Ok(message) => serde_json::from_slice::<Layout>(message.body())
                .ok()
                .filter(|layout| layout_fault(configuration, layout).is_none())
                .map(Estimate::Layout),
            Err(RunError::Refused { refusal, .. }) => Some(Estimate::Refused(refusal)),
            Err(_) => None,
        };
        if estimate.is_none() {
            crew.peers = None;
        }
        estimate
    })
}
