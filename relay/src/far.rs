//! The end on the other machine: waits for calls, and for each of them asks the program, or starts it as a
//! participant of a run of its own, which exists here only.

mod drive;
mod guard;
mod offer;
mod place;
mod session;

use crate::fabric::{Certificates, Fabric};
use crate::greet::answer;
use crate::hail::End;
use crate::key::Key;
use crate::routes::Components;
use contract::description::Description;
use offer::Offer;
use run::programs::Program;
use run::signals;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::RecvTimeoutError;
use std::time::Duration;

/// From one look at signals to the next.
const LOOK: Duration = Duration::from_millis(50);
/// Longest wait for what the program says of itself.
const DESCRIBE: Duration = Duration::from_secs(30);
/// Longest wait for the proof of a caller.
const GREETING: Duration = Duration::from_secs(10);
/// Conversations at the same time: a run has one, `conform` and sweeps several.
const CONVERSATIONS: usize = 32;

/// What listens.
#[derive(Debug)]
pub struct Far {
    /// Where: `tcp/0.0.0.0:7447`, `tls/0.0.0.0:7447`.
    pub endpoint: String,
    /// The key that both ends have.
    pub key: Key,
    /// Certificates for `tls`.
    pub certificates: Certificates,
    /// The program that takes part.
    pub command: Vec<String>,
    /// Without a sign of life for so long, the link is lost.
    pub silence: Duration,
    /// Ends after one run.
    pub once: bool,
}

/// How the far end ends badly.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct FarError(String);

/// Serves until a signal comes, or once.
///
/// # Errors
/// The program does not say what it is; nothing can listen there.
pub fn serve(far: Far) -> Result<(), FarError> {
    let program = Program::of_role("", Some(&far.command));
    let description = describe(&program)?;
    let fabric = Fabric::listen(&far.endpoint, &far.certificates)
        .map_err(|error| FarError(error.to_string()))?;
    let calls = fabric.calls().map_err(|error| FarError(error.to_string()))?;
    let components = Components::described(&description);
    let role = description.role;
    tracing::info!("listening on {}: {} plays {role}", far.endpoint, program.name());
    let offer = Arc::new(Offer { program, role, components, key: far.key, silence: far.silence });
    let (talking, runs) = (Arc::new(()), Arc::new(AtomicUsize::new(0)));
    let mut threads = Vec::new();
    while signals::received().is_none() && !(far.once && runs.load(Ordering::SeqCst) > 0) {
        let (name, hello) = match calls.arrived.recv_timeout(LOOK) {
            Ok(call) => call,
            Err(RecvTimeoutError::Timeout) => continue,
            Err(RecvTimeoutError::Disconnected) => break,
        };
        threads.retain(|thread: &std::thread::JoinHandle<()>| !thread.is_finished());
        let Some(slot) = slot(&talking) else {
            tracing::warn!("a call is not answered: there are {CONVERSATIONS} conversations");
            continue;
        };
        let wire = match fabric.wire(&name, End::Far) {
            Ok(wire) => wire,
            Err(error) => {
                tracing::warn!("{error}");
                continue;
            }
        };
        let (offer, runs) = (Arc::clone(&offer), Arc::clone(&runs));
        threads.push(std::thread::spawn(move || {
            // Held until the thread ends, by a panic too.
            let _slot = slot;
            match answer(wire, &hello, &offer.key, GREETING) {
                Ok(line) => {
                    if session::talk(line, &offer) {
                        runs.fetch_add(1, Ordering::SeqCst);
                    }
                }
                Err(error) => tracing::warn!("a call is refused: {error}"),
            }
        }));
    }
    for thread in threads {
        let _ = thread.join();
    }
    Ok(())
}

/// The place of a conversation, which is free again when it is dropped; `None` if all are taken.
fn slot(talking: &Arc<()>) -> Option<Arc<()>> {
    (Arc::strong_count(talking) <= CONVERSATIONS).then(|| Arc::clone(talking))
}

/// What the program says of itself, which is checked before anybody calls.
fn describe(program: &Program) -> Result<Description, FarError> {
    let runtime = session::runtime().map_err(|error| FarError(error.to_string()))?;
    let described = runtime.block_on(program.describe("participant", DESCRIBE));
    let described = described.map_err(|error| FarError(error.to_string()))?;
    described.check().map_err(|fault| FarError(format!("{}: {fault}", program.name())))?;
    Ok(described)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_conversation_that_panics_leaves_its_slot() {
        let talking = Arc::new(());
        for _ in 0..2 * CONVERSATIONS {
            let slot = slot(&talking).unwrap();
            let thread = std::thread::spawn(move || {
                let _slot = slot;
                panic!("as a conversation may");
            });
            assert!(thread.join().is_err());
        }
        let all: Vec<_> = (0..CONVERSATIONS).map(|_| slot(&talking).unwrap()).collect();
        assert!(slot(&talking).is_none());
        drop(all);
        assert!(slot(&talking).is_some());
    }
}
