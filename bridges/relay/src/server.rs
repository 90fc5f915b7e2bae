//! The end on the other machine: waits for clients, and for each of them asks the program, or starts it as a
//! participant of a run of its own, which exists here only.

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
use run::programs::Program;
use run::signals;
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

/// From one look at signals to the next.
const LOOK: Duration = Duration::from_millis(50);
/// Longest wait for what the program says of itself.
const DESCRIBE: Duration = Duration::from_secs(30);
/// Settings of a server: address, key and program.
#[derive(Debug)]
pub struct Server {
    /// Address to listen on: `0.0.0.0:7447`.
    pub address: String,
    /// The key that both ends have.
    pub key: Key,
    /// The program that takes part.
    pub command: Vec<String>,
    /// Without a sign of life for so long, the link is lost.
    pub silence: Duration,
    /// Ends after one run.
    pub once: bool,
}

/// Reason why a server fails.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct ServerError(String);

impl ServerError {
    fn of(words: impl std::fmt::Display) -> Self {
        Self(words.to_string())
    }
}

/// Serves until a signal comes, or once.
///
/// # Errors
/// The program does not say what it is; nothing can listen there.
pub fn serve(server: Server) -> Result<(), ServerError> {
    let Server { address, key, command, silence, once } = server;
    let program = Program::of_role("", Some(&command));
    let description = describe(&program)?;
    let cannot =
        |error: std::io::Error| ServerError(format!("cannot listen on {address}: {error}"));
    let listener = TcpListener::bind(&address).map_err(cannot)?;
    let components = Components::described(&description);
    let role = description.role;
    let listening = listener.local_addr().map_err(cannot)?;
    tracing::info!("listening on {listening}: {} plays {role}", program.name());
    let config = Arc::new(ServerConfig { program, role, components, key, silence });
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
                    // Held until the thread ends, by a panic too.
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

/// Connections as they come. One that nobody takes waits in the queue of the system.
fn callers(listener: TcpListener) -> Receiver<TcpStream> {
    let (sender, callers) = sync_channel(0);
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            match stream.map(|stream| sender.send(stream)) {
                Ok(Ok(())) => {}
                Ok(Err(_)) => return,
                // Too many open files, say.
                Err(_) => std::thread::sleep(LOOK),
            }
        }
    });
    callers
}

/// How many conversations there are.
#[derive(Clone, Default)]
struct Conversations(Arc<AtomicUsize>);

/// The place of a conversation, which is free again when it is dropped.
struct Slot(Conversations);

impl Conversations {
    /// `None` if all places are taken.
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

/// What the program says of itself, which is checked before anybody calls.
fn describe(program: &Program) -> Result<Description, ServerError> {
    let runtime = session::runtime().map_err(ServerError::of)?;
    let described = runtime.block_on(program.describe("participant", DESCRIBE));
    let described = described.map_err(ServerError::of)?;
    described.check().map_err(|fault| ServerError(format!("{}: {fault}", program.name())))?;
    Ok(described)
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
