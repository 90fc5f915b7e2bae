//! Connection to a server. Over it the remote program answers requests of the coordinator before a
//! run.

use super::files::send_files;
use super::{Client, ClientError};
use crate::frame::{Frame, Question};
use crate::handshake::connect;
use crate::link::{End, Link};
use contract::description::Description;
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

    /// Sends a request to the remote program and returns its standard output.
    pub(super) fn ask(&self, question: Question, input: &[u8]) -> Result<Vec<u8>, ClientError> {
        self.send(&Frame::Ask { question, input })?;
        let answer = self.next()?;
        match Frame::read(&answer).map_err(ClientError::of)? {
            Frame::Answer { code: 0, said } => Ok(said.to_vec()),
            Frame::Answer { code, said } => {
                let words = one_line(&String::from_utf8_lossy(said)).into_owned();
                Err(ClientError { words, code })
            }
            _ => Err(out_of_turn()),
        }
    }

    /// Asks the remote program for its description.
    pub(super) fn description(&self) -> Result<Description, ClientError> {
        let said = self.ask(Question::Describe, &[])?;
        serde_json::from_slice(&said).map_err(|error| {
            ClientError::of(format!("the description of the remote program is not valid: {error}"))
        })
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

/// Runs the remote program with `--describe`, `--estimate` or `--advise` and returns its standard
/// output.
///
/// # Errors
/// Fails if the server cannot be reached or has a different key, or the program fails.
pub fn ask(client: &Client, option: &str, input: &[u8]) -> Result<Vec<u8>, ClientError> {
    let connection = Connection::open(client, &Membership::default())?;
    let question = match option {
        "--estimate" => Question::Estimate,
        "--advise" => Question::Advise,
        _ => Question::Describe,
    };
    if question == Question::Estimate {
        let description = connection.description()?;
        send_files(&connection.link.sending, &description, input)?;
    }
    let mut said = connection.ask(question, input)?;
    if question == Question::Describe {
        said = of_one_run(said);
    }
    connection.close();
    Ok(said)
}
