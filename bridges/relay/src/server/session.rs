//! Conversation with one client: questions before a run, and possibly the run.

use super::config::{CONVERSATIONS, ServerConfig};
use super::drive::{Over, run};
use super::processes::Processes;
use crate::frame::Frame;
use crate::link::{Fault, Link};
use crate::record::Sealed;
use contract::text::one_line;
use run::signals;
use std::time::{Duration, Instant};

/// Interval between checks of the link.
const LOOK: Duration = Duration::from_millis(50);
/// Maximum wait for the client to read the final message.
const FAREWELL: Duration = Duration::from_secs(5);

/// Reason for the early end of a conversation.
enum Ends {
    /// The link is lost, so that the client cannot be informed.
    Lost(String),
    /// The client receives this exit code and message.
    Told { code: u8, words: String },
}

impl From<Fault> for Ends {
    fn from(fault: Fault) -> Self {
        Self::Lost(fault.to_string())
    }
}

impl From<Over> for Ends {
    fn from(over: Over) -> Self {
        let Over { code, words } = over;
        Self::Told { code, words }
    }
}

fn told(words: impl std::fmt::Display) -> Ends {
    Ends::Told { code: 1, words: words.to_string() }
}

/// Serves a client until it leaves, or refuses it if there is no room. Returns true if there was a
/// run.
pub(super) fn talk(sealed: Sealed, config: &ServerConfig, has_room: bool) -> bool {
    let processes = Processes::default();
    let ends = processes.clone();
    let link = match Link::open(sealed, config.silence, move |_| ends.let_go()) {
        Ok(link) => link,
        Err(error) => {
            tracing::warn!("a call is not answered: {error}");
            return false;
        }
    };
    let mut session = Session { link, processes, config, run: None };
    let ended = match has_room {
        true => session.talk(),
        false => {
            Err(told(format!("the server has {CONVERSATIONS} conversations, which is the maximum")))
        }
    };
    // After a finished run, the way in which the client leaves does not matter.
    if session.run == Some(Course::Finished) {
        tracing::info!("the run is finished");
        return true;
    }
    let why = match (session.link.lost(), ended) {
        (Some(lost), Err(Ends::Told { words, .. })) => format!("the link is lost: {lost}; {words}"),
        (Some(lost), _) => format!("the link is lost: {lost}"),
        (None, Err(Ends::Lost(why))) => why,
        (None, Err(Ends::Told { code, words })) => {
            session.tell(code, &words);
            words
        }
        (None, Ok(())) => "the client has left".to_owned(),
    };
    match session.run {
        Some(_) => tracing::warn!("the run is over: {}", one_line(&why)),
        None => tracing::debug!("{}", one_line(&why)),
    }
    session.run.is_some()
}

/// Stage of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Course {
    Begun,
    Finished,
}

struct Session<'a> {
    link: Link,
    processes: Processes,
    config: &'a ServerConfig,
    run: Option<Course>,
}

impl Session<'_> {
    fn talk(&mut self) -> Result<(), Ends> {
        loop {
            let Some(message) = self.link.within(LOOK)? else {
                if let Some(signal) = signals::received() {
                    return Err(told(format!("the server was interrupted by {signal}")));
                }
                continue;
            };
            match Frame::read(&message).map_err(Fault::from)? {
                Frame::Join { packing } => {
                    let begun = || self.run = Some(Course::Begun);
                    run((self.config, packing), &self.link, &self.processes, begun)?;
                    self.run = self.run.map(|_| Course::Finished);
                }
                Frame::Bye => return Ok(()),
                _ => return Err(told("the client sent an unexpected message")),
            }
        }
    }

    /// Sends the final message and waits for the client to read it.
    fn tell(&self, code: u8, words: &str) {
        let words = one_line(words);
        // Sent twice: as a message for a waiting client, and as a sign for the monitor of its link.
        let ended = Frame::Ended { code, words: &words };
        if self.link.sending.send(&ended).is_ok() && self.link.sending.sign(&ended).is_ok() {
            let until = Instant::now() + FAREWELL;
            while !self.link.is_over() && Instant::now() < until {
                std::thread::sleep(LOOK / 10);
            }
        }
    }
}
