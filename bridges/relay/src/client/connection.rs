//! Connection to a server.

use super::{Client, ClientError};
use crate::frame::Frame;
use crate::handshake::connect;
use crate::link::{End, Link};
use contract::text::one_line;
use proto::run_dir::RunDir;
use std::io::Write;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Interval between checks of the link.
const LOOK: Duration = Duration::from_millis(50);
/// Maximum wait for the server to close the connection.
const FAREWELL: Duration = Duration::from_secs(1);

/// Membership in a run, left in order when the process ends.
pub(super) type Membership = Arc<Mutex<Option<RunDir>>>;

/// Monitored connection to a server. Losing it ends the process.
pub(super) struct Connection {
    pub(super) link: Link,
}

impl Connection {
    pub(super) fn open(client: &Client, membership: &Membership) -> Result<Self, ClientError> {
        let Client { address, key, patience, silence, .. } = client;
        let sealed = connect(address, key, *patience)
            .map_err(|error| ClientError::of(format!("{address}: {error}")))?;
        let (address, membership) = (address.clone(), Arc::clone(membership));
        let link = Link::open(sealed, *silence, move |end| {
            let (words, code) = match end {
                End::Lost(why) => (format!("the link to {address} is lost: {why}"), 1),
                End::Told(code, words) => (words, code),
            };
            let words = words.strip_prefix("error: ").unwrap_or(&words);
            let _ = writeln!(std::io::stderr(), "error: {words}");
            leave(&membership, code);
        });
        Ok(Self { link: link.map_err(ClientError::of)? })
    }

    /// Returns the next message of the server; a final error message becomes an error. Waits
    /// without limit: the monitor ends the process if the link is lost.
    pub(super) fn next(&self) -> Result<Vec<u8>, ClientError> {
        loop {
            let message = match self.link.within(LOOK) {
                Ok(Some(message)) => message,
                Ok(None) => continue,
                // The monitor reports the reason and ends the process.
                Err(_) if self.link.lost().is_none() => {
                    std::thread::sleep(LOOK);
                    continue;
                }
                Err(fault) => return Err(ClientError::of(fault)),
            };
            if let Frame::Ended { code, words } = Frame::read(&message).map_err(ClientError::of)? {
                let words = one_line(words).into_owned();
                return Err(ClientError { words, code: code.max(1) });
            }
            return Ok(message);
        }
    }

    pub(super) fn send(&self, frame: &Frame<'_>) -> Result<(), ClientError> {
        self.link.sending.send(frame).map_err(ClientError::of)
    }

    /// Closes the connection in order.
    pub(super) fn close(self) {
        self.link.close(FAREWELL);
    }
}

/// Leaves the run in order and ends the process, whatever other threads do.
pub(super) fn leave(membership: &Membership, code: u8) -> ! {
    drop(membership.lock().map(|mut run| run.take()));
    std::process::exit(code.into());
}

/// Error for a message of the server that does not fit the protocol.
pub(super) fn out_of_turn() -> ClientError {
    ClientError::of("the server sent an unexpected message")
}

/// Removes `reusable` from a description, because the link to the server closes after a run.
/// Invalid JSON is returned unchanged.
pub(super) fn of_one_run(said: Vec<u8>) -> Vec<u8> {
    match serde_json::from_slice::<serde_json::Map<String, serde_json::Value>>(&said) {
        Ok(mut description) => {
            description.remove("reusable");
            serde_json::to_vec_pretty(&description).expect("what was parsed is written")
        }
        Err(_) => said,
    }
}
