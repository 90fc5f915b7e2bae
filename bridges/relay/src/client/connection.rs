//! The link to a server, over which the program there answers what the coordinator asks before a
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

/// From one look at the link to the next.
const LOOK: Duration = Duration::from_millis(50);
/// Longest wait for the server to close the connection.
const FAREWELL: Duration = Duration::from_secs(1);

/// A membership that is left in order when the process ends.
pub(super) type Membership = Arc<Mutex<Option<RunDir>>>;

/// A link to a server; with it ends the process.
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

    /// The next message of the server; its last words are an error. That it comes, or the link is lost,
    /// is the monitor's to see.
    pub(super) fn next(&self) -> Result<Vec<u8>, ClientError> {
        loop {
            let message = match self.link.within(LOOK) {
                Ok(Some(message)) => message,
                Ok(None) => continue,
                // The monitor says why, and ends the process.
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

    /// Asks the program there; what it has written to its standard output.
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

    /// Description of the program there.
    pub(super) fn description(&self) -> Result<Description, ClientError> {
        let said = self.ask(Question::Describe, &[])?;
        serde_json::from_slice(&said).map_err(|error| {
            ClientError::of(format!("the description of the program there is not valid: {error}"))
        })
    }

    /// Leaves, as was to be expected.
    pub(super) fn close(self) {
        self.link.close(FAREWELL);
    }
}

/// Ends the process, whatever its other threads do; the run's folder is left in order.
pub(super) fn leave(membership: &Membership, code: u8) -> ! {
    drop(membership.lock().map(|mut run| run.take()));
    std::process::exit(code.into());
}

/// The server does not follow the conversation.
pub(super) fn out_of_turn() -> ClientError {
    ClientError::of("the server says something out of turn")
}

/// A description without `reusable`: the link to the server closes with a run. What is none stays as it
/// is.
pub(super) fn of_one_run(said: Vec<u8>) -> Vec<u8> {
    match serde_json::from_slice::<serde_json::Map<String, serde_json::Value>>(&said) {
        Ok(mut description) => {
            description.remove("reusable");
            serde_json::to_vec_pretty(&description).expect("what was parsed is written")
        }
        Err(_) => said,
    }
}

/// Asks the program at the server `--describe`, `--estimate` or `--advise`; what it says.
///
/// # Errors
/// The server is not reached or has another key; the program fails.
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
