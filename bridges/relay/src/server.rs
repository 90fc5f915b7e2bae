//! Server side of the relay. It waits for clients; for each it runs the program as a participant of
//! a local run of its own.

mod config;
mod doorstep;
mod drive;
mod place;
mod processes;
mod session;

use crate::handshake::accept;
use crate::key::Key;
use crate::routes::Components;
use config::{CONVERSATIONS, ServerConfig};
use contract::description::Description;
use doorstep::Doorstep;
use run::fleet::described;
use run::peers::ParticipantSlot;
use run::program::Program;
use run::signals;
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

/// Interval between checks for signals.
const LOOK: Duration = Duration::from_millis(50);
/// Settings of a server.
#[derive(Debug)]
pub struct Server {
    /// Address to listen on, for example `0.0.0.0:7447`.
    pub address: String,
    /// Key shared by both ends.
    pub key: Key,
    /// Program that takes part, with its arguments.
    pub command: Vec<String>,
    /// Silence of the client after which the link counts as lost.
    pub silence: Duration,
    /// True to end after one run.
    pub once: bool,
}

/// Error of a server.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct ServerError(String);

impl ServerError {
    fn of(words: impl std::fmt::Display) -> Self {
        Self(words.to_string())
    }
}

/// Serves clients until a signal arrives, or for one run.
///
/// # Errors
/// Fails if the program does not describe itself, or the address cannot be listened on.
pub fn serve(server: Server) -> Result<(), ServerError> {
    let Server { address, key, command, silence, once } = server;
    let program = Program::of_role("", Some(&command));
    let description = describe(&program)?;
    let cannot =
        |error: std::io::Error| ServerError(format!("cannot listen on {address}: {error}"));
    let listener = TcpListener::bind(&address).map_err(cannot)?;
    let components = Components::described(&description);
    let json = serde_json::to_vec(&description).expect("a description is plain data");
    let role = description.role;
    let listening = listener.local_addr().map_err(cannot)?;
    tracing::info!("listening on {listening}: {} plays {role}", program.name());
    let config =
        Arc::new(ServerConfig { program, role, description: json, components, key, silence });
    let callers = callers(listener);
    let (doorstep, conversations) = (Doorstep::default(), Conversations::default());
    let runs = Arc::new(AtomicUsize::new(0));
    let mut threads = Vec::new();
    while signals::received().is_none() && !(once && runs.load(Ordering::SeqCst) > 0) {
        let stream = match callers.recv_timeout(LOOK) {
            Ok(stream) => stream,
            Err(RecvTimeoutError::Timeout) => continue,
            Err(RecvTimeoutError::Disconnected) => break,
        };
        threads.retain(|thread: &std::thread::JoinHandle<()>| !thread.is_finished());
        let Some(waiting) = doorstep.enter(&stream) else { continue };
        let (config, runs) = (Arc::clone(&config), Arc::clone(&runs));
        let conversations = conversations.clone();
        threads.push(std::thread::spawn(move || {
            let accepted = accept(stream, &config.key, Instant::now() + doorstep::PATIENCE);
            drop(waiting);
            match accepted {
                Ok(sealed) => {
                    // Dropped at the end of the thread, also after a panic.
                    let slot = conversations.slot();
                    if session::talk(sealed, &config, slot.is_some()) {
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

/// Accepts connections on a thread of its own. Further ones wait in the queue of the system.
fn callers(listener: TcpListener) -> Receiver<TcpStream> {
    let (sender, callers) = sync_channel(0);
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            match stream.map(|stream| sender.send(stream)) {
                Ok(Ok(())) => {}
                Ok(Err(_)) => return,
                // For example, too many open files.
                Err(_) => std::thread::sleep(LOOK),
            }
        }
    });
    callers
}

/// Number of open conversations.
#[derive(Clone, Default)]
struct Conversations(Arc<AtomicUsize>);

/// Place of a conversation, freed on drop.
struct Slot(Conversations);

impl Conversations {
    /// Reserves a place; `None` if all are taken.
    fn slot(&self) -> Option<Slot> {
        let next = |count| (count < CONVERSATIONS).then_some(count + 1);
        let taken = self.0.fetch_update(Ordering::SeqCst, Ordering::SeqCst, next);
        taken.is_ok().then(|| Slot(self.clone()))
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        self.0.0.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Reads and checks the description of the program, before any client connects.
fn describe(program: &Program) -> Result<Description, ServerError> {
    let role = "participant".to_owned();
    let seat = ParticipantSlot { role, program: program.clone(), attach: false };
    let described = described(&[seat]).map_err(ServerError::of)?;
    described.into_iter().next().ok_or_else(|| ServerError::of("there is no description"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_conversation_that_panics_leaves_its_slot() {
        let conversations = Conversations::default();
        for _ in 0..2 * CONVERSATIONS {
            let slot = conversations.slot().unwrap();
            let thread = std::thread::spawn(move || {
                let _slot = slot;
                panic!("as a conversation may");
            });
            assert!(thread.join().is_err());
        }
        let all: Vec<_> = (0..CONVERSATIONS).map(|_| conversations.slot().unwrap()).collect();
        assert!(conversations.slot().is_none());
        drop(all);
        assert!(conversations.slot().is_some());
    }
}
