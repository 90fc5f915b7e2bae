//! Participants that outlive a run.
//!
//! While [`keep`] or [`start_early`] is in force on a thread, planning starts the participants of a
//! case and asks these processes for their descriptions and estimates; the run then uses them. With
//! [`keep`], the participants of a run that succeeded also stay for the next one, if all of them are
//! reusable ([`contract::description::Description::reusable`]). Any failure ends the processes, and
//! the next run starts new ones.

use crate::deadlines::Deadlines;
use crate::error::RunError;
use crate::peers::{Peers, Phase, Seat};
use crate::programs::Program;
use crate::session::{layout_fault, open_files};
use contract::configuration::{Configuration, Estimate, Layout};
use contract::description::Description;
use contract::message::{Command, CommandKind};
use std::cell::RefCell;
use std::marker::PhantomData;
use std::time::Duration;

/// Topics of a participant, assumed when the limit of open files is checked before planning.
const TOPICS: usize = 4;

/// Lifetime of participants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kept {
    /// A run starts its own.
    No,
    /// From the planning of a run to its end.
    ForOneRun,
    /// From run to run.
    ForAll,
}

/// Participants of this thread that wait for a run.
struct Crew {
    kept: Kept,
    peers: Option<Peers>,
}

thread_local! {
    static CREW: RefCell<Crew> = const { RefCell::new(Crew { kept: Kept::No, peers: None }) };
}

/// Keeps participants on this thread. Dropping it dismisses those that wait.
#[derive(Debug)]
#[must_use]
pub struct Keeps {
    before: Kept,
    /// Makes it stay on its thread.
    of_thread: PhantomData<*const ()>,
}

/// Lets participants of this thread's runs stay for the next run, from here on.
pub fn keep() -> Keeps {
    Keeps::new(Kept::ForAll)
}

/// Lets planning on this thread start the participants of its run, from here on.
pub fn start_early() -> Keeps {
    Keeps::new(Kept::ForOneRun)
}

impl Keeps {
    fn new(kept: Kept) -> Self {
        let before = CREW.with_borrow_mut(|crew| std::mem::replace(&mut crew.kept, kept));
        Self { before, of_thread: PhantomData }
    }
}

impl Drop for Keeps {
    fn drop(&mut self) {
        CREW.with_borrow_mut(|crew| crew.kept = self.before);
        if self.before == Kept::No {
            leave();
        }
    }
}

/// Returns whether participants stay after a run.
pub(crate) fn stays() -> bool {
    CREW.with_borrow(|crew| crew.kept == Kept::ForAll)
}

/// Keeps the participants of a run that has ended.
pub(crate) fn stay(peers: Peers) {
    let before = CREW.with_borrow_mut(|crew| crew.peers.replace(peers));
    before.into_iter().for_each(Peers::dismiss);
}

/// Takes the participants that wait, if they hold all these seats and are alive. Participants in
/// other seats are dismissed.
pub(crate) fn take(seats: &[Seat]) -> Option<Peers> {
    let peers = CREW.with_borrow_mut(|crew| crew.peers.take())?;
    match peers.seated(seats) {
        Ok(peers) => Some(peers),
        Err(others) => {
            others.dismiss();
            None
        }
    }
}

/// Returns the shared memory that the participants that wait hold [byte].
pub(crate) fn held_memory() -> u64 {
    CREW.with_borrow(|crew| crew.peers.as_ref().map_or(0, Peers::held_memory))
}

/// Dismisses the participants that wait.
pub(crate) fn leave() {
    let peers = CREW.with_borrow_mut(|crew| crew.peers.take());
    peers.into_iter().for_each(Peers::dismiss);
}

/// Starts participants and asks for their descriptions, unless some wait already or none are kept.
/// If that fails, planning starts a process for each question and reports the error.
pub(crate) fn start(seats: &[Seat], patience: Duration) {
    let wanted = CREW.with_borrow(|crew| crew.kept != Kept::No && crew.peers.is_none());
    if !wanted || seats.is_empty() || seats.iter().any(|seat| seat.attach) {
        return;
    }
    match described(seats, patience) {
        Ok(peers) => CREW.with_borrow_mut(|crew| crew.peers = Some(peers)),
        Err(error) => tracing::debug!("participants are not started for planning: {error}"),
    }
}

/// Starts participants, waits until they have joined, and keeps their descriptions.
fn described(seats: &[Seat], patience: Duration) -> Result<Peers, RunError> {
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

/// Asks a participant that waits for its estimate. `None` if no participant runs this program, or if
/// it fails or answers with a faulty layout; planning asks a new process then.
pub(crate) fn estimate(
    program: &Program,
    configuration: &Configuration,
    patience: Duration,
) -> Option<Estimate> {
    CREW.with_borrow_mut(|crew| {
        let peers = crew.peers.as_mut()?;
        let is_it = |seat: &Seat| seat.role == configuration.role && seat.program == *program;
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
