//! One conversation: questions, and perhaps a run.

use super::config::{CONVERSATIONS, ServerConfig};
use super::drive::{Over, run};
use super::place::Place;
use super::processes::Processes;
use crate::frame::{Frame, Question};
use crate::link::{Fault, Link};
use crate::record::Sealed;
use contract::text::one_line;
use run::signals;
use std::time::{Duration, Instant};

/// From one look at the line to the next.
const LOOK: Duration = Duration::from_millis(50);
/// Longest wait for an answer of the program; who asks has a deadline of his own, and leaves.
const ANSWER: Duration = Duration::from_secs(3600);
/// Last words are read within this time.
const FAREWELL: Duration = Duration::from_secs(5);

/// What ends a conversation early.
enum Ends {
    /// There is nobody to say it to.
    Lost(String),
    /// The client is told.
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

/// A runtime for questions.
pub(super) fn runtime() -> std::io::Result<tokio::runtime::Runtime> {
    tokio::runtime::Builder::new_current_thread().enable_all().build()
}

/// Talks to a client until it leaves, if there is room for it; whether there was a run.
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
            Err(told(format!("the server has {CONVERSATIONS} conversations, and takes no more")))
        }
    };
    // However the client leaves once it has all.
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

/// How far a run is.
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
        let mut place = Place::new(None).map_err(told)?;
        loop {
            let Some(message) = self.link.within(LOOK)? else {
                if let Some(signal) = signals::received() {
                    return Err(told(format!("the server was interrupted by {signal}")));
                }
                continue;
            };
            match Frame::read(&message).map_err(Fault::from)? {
                Frame::Ask { question, input } => self.ask(question, input, &place)?,
                Frame::File { key, ending, last, bytes } => {
                    place.file(key, ending, bytes, last).map_err(told)?;
                }
                Frame::Join { packing } => {
                    self.run = Some(Course::Begun);
                    run(self.config, &self.link, &self.processes, packing)?;
                    self.run = Some(Course::Finished);
                }
                Frame::Bye => return Ok(()),
                _ => return Err(told("the client says something out of turn")),
            }
        }
    }

    /// Asks the program, as long as the one who wants to know is there.
    fn ask(&self, question: Question, input: &[u8], place: &Place) -> Result<(), Ends> {
        let input = match question {
            Question::Estimate => place.configuration(input),
            Question::Describe | Question::Advise => input.to_vec(),
        };
        let ServerConfig { program, role, .. } = self.config;
        let answered = runtime().map_err(told)?.block_on(async {
            let leaves = async {
                while !self.link.is_over() {
                    tokio::time::sleep(LOOK).await;
                }
            };
            tokio::select! {
                answer = program.answer(role, question.option(), input, ANSWER) => Some(answer),
                () = leaves => None,
            }
        });
        let Some(answered) = answered else {
            return Err(Ends::Lost("nobody waits for the answer".to_owned()));
        };
        let (code, said) = match answered {
            Ok(said) => (0, said),
            Err(error) => (1, error.to_string().into_bytes()),
        };
        Ok(self.link.sending.send(&Frame::Answer { code, said: &said })?)
    }

    /// Last words, and the time to read them.
    fn tell(&self, code: u8, words: &str) {
        let words = one_line(words);
        // To whoever waits for a message, and to the monitor of the link if nobody does.
        let ended = Frame::Ended { code, words: &words };
        if self.link.sending.send(&ended).is_ok() && self.link.sending.sign(&ended).is_ok() {
            let until = Instant::now() + FAREWELL;
            while !self.link.is_over() && Instant::now() < until {
                std::thread::sleep(LOOK / 10);
            }
        }
    }
}
