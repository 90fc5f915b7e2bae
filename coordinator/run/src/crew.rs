//! Participants that stay after a run, for the next one on the same thread.
//!
//! While [`keep`] is in force, the participants of a run that has ended well stay, if all of them are
//! reusable ([`contract::description::Description::reusable`]). They are asked for their estimates
//! while the next run is planned, and take part in it if it has the same programs in the same roles.
//! Whatever goes wrong ends the processes, and the next run starts new ones.

use crate::peers::{Peers, Phase, Seat};
use crate::programs::Program;
use contract::configuration::{Configuration, Estimate};
use contract::message::{Command, CommandKind};
use std::cell::RefCell;
use std::marker::PhantomData;
use std::time::Duration;

/// Participants of this thread that wait for a run.
enum Crew {
    /// None stay.
    Leaves,
    /// Those that have stayed, if any.
    Stays(Option<Peers>),
}

thread_local! {
    static CREW: RefCell<Crew> = const { RefCell::new(Crew::Leaves) };
}

/// Lets participants stay on this thread. Dropping it lets them leave.
#[derive(Debug)]
#[must_use]
pub struct Keeps {
    /// The outermost one of the thread.
    outermost: bool,
    /// Of one thread.
    of_thread: PhantomData<*const ()>,
}

/// From here on participants of this thread's runs stay for the next run.
pub fn keep() -> Keeps {
    let outermost = CREW.with_borrow_mut(|crew| {
        let leaves = matches!(crew, Crew::Leaves);
        if leaves {
            *crew = Crew::Stays(None);
        }
        leaves
    });
    Keeps { outermost, of_thread: PhantomData }
}

impl Drop for Keeps {
    fn drop(&mut self) {
        if self.outermost
            && let Crew::Stays(Some(peers)) = CREW.replace(Crew::Leaves)
        {
            peers.dismiss();
        }
    }
}

/// Whether participants stay after a run.
pub(crate) fn stays() -> bool {
    CREW.with_borrow(|crew| matches!(crew, Crew::Stays(_)))
}

/// Keeps the participants of a run that has ended.
pub(crate) fn stay(peers: Peers) {
    let before = CREW.replace(Crew::Stays(Some(peers)));
    debug_assert!(matches!(before, Crew::Stays(None)));
}

/// Those that have stayed, if they are these and all of them live; others leave.
pub(crate) fn take(seats: &[Seat]) -> Option<Peers> {
    let peers = CREW.with_borrow_mut(|crew| match crew {
        Crew::Leaves => None,
        Crew::Stays(peers) => peers.take(),
    })?;
    if peers.seats() == seats && peers.supervisor().exits().is_empty() {
        return Some(peers);
    }
    peers.dismiss();
    None
}

/// What a participant that has stayed makes of a configuration; `None` if there is none of this
/// program, or it does not answer: it is left to a new process then.
pub(crate) fn estimate(
    program: &Program,
    configuration: &Configuration,
    patience: Duration,
) -> Option<Estimate> {
    CREW.with_borrow_mut(|crew| {
        let Crew::Stays(Some(peers)) = crew else { return None };
        let is_it = |seat: &Seat| seat.role == configuration.role && seat.program == *program;
        let one = peers.seats().iter().position(is_it)?.into();
        peers.phase = Phase::Configuring;
        let body = serde_json::to_vec(configuration).expect("a configuration is plain data");
        let asked = peers.post(one, Command::new(CommandKind::Configure), &body, true);
        let estimate = match asked.and_then(|()| peers.done(one, patience)) {
            Ok(message) => serde_json::from_slice(message.body()).ok().map(Estimate::Layout),
            Err(crate::error::RunError::Refused { refusal, .. }) => {
                Some(Estimate::Refused(refusal))
            }
            Err(_) => None,
        };
        if estimate.is_none() {
            *crew = Crew::Stays(None);
        }
        estimate
    })
}
