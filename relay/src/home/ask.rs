//! What the coordinator asks a program before a run, asked of the far end's.

use super::files::send_files;
use super::keeper::{Ears, Keeper, Membership};
use super::{Home, HomeError};
use crate::fabric::Fabric;
use crate::frame::{Frame, Question};
use crate::greet::call;
use crate::line::{Incoming, Sending};
use contract::description::Description;
use contract::text::one_line;
use std::sync::Arc;
use std::time::Duration;

/// From one look at the line to the next.
const LOOK: Duration = Duration::from_millis(50);

/// A line that is kept; lost, the process ends.
pub(super) struct Kept {
    pub(super) sending: Arc<Sending>,
    pub(super) messages: Incoming,
    pub(super) ears: Ears,
    // What is dropped first ends first: the keeper before the network.
    keeper: Keeper,
    fabric: Fabric,
}

impl Kept {
    pub(super) fn open(home: &Home, membership: &Membership) -> Result<Self, HomeError> {
        let fabric = Fabric::connect(&home.endpoint, &home.certificates, home.patience)
            .map_err(HomeError::of)?;
        let line = call(&fabric, &home.key, home.patience)
            .map_err(|error| HomeError::of(format!("{}: {error}", home.endpoint)))?;
        let ears = Ears::default();
        let keeper = Keeper::start(
            (line.life, line.hold),
            Arc::clone(&line.sending),
            Arc::clone(&ears),
            (home.endpoint.clone(), home.silence),
            Arc::clone(membership),
        );
        Ok(Self { sending: line.sending, messages: line.messages, ears, keeper, fabric })
    }

    /// The next message of the far end; its last words are an error. That it comes, or the line is lost, is the
    /// keeper's to see.
    pub(super) fn next(&mut self) -> Result<Vec<u8>, HomeError> {
        loop {
            let Some(message) = self.messages.within(LOOK).map_err(HomeError::of)? else {
                continue;
            };
            if let Frame::Ended { code, words } = Frame::read(&message).map_err(HomeError::of)? {
                let words = one_line(words).into_owned();
                return Err(HomeError { words, code: code.max(1) });
            }
            return Ok(message);
        }
    }

    /// Asks the far program; what it has written to its standard output.
    pub(super) fn ask(&mut self, question: Question, input: &[u8]) -> Result<Vec<u8>, HomeError> {
        self.sending.send(&Frame::Ask { question, input }).map_err(HomeError::of)?;
        let answer = self.next()?;
        match Frame::read(&answer).map_err(HomeError::of)? {
            Frame::Answer { code: 0, said } => Ok(said.to_vec()),
            Frame::Answer { code, said } => {
                let words = one_line(&String::from_utf8_lossy(said)).into_owned();
                Err(HomeError { words, code })
            }
            _ => Err(out_of_turn()),
        }
    }

    /// What the far program says of itself.
    pub(super) fn description(&mut self) -> Result<Description, HomeError> {
        let said = self.ask(Question::Describe, &[])?;
        serde_json::from_slice(&said).map_err(|error| {
            HomeError::of(format!("the far program's description is not valid: {error}"))
        })
    }

    /// Leaves, as was to be expected. The far end closes the line when it has read so; nobody keeps it then.
    pub(super) fn close(self) {
        drop(self.keeper);
        let _ = self.sending.send(&Frame::Bye);
        drop(self.fabric);
    }
}

/// The far end does not follow the conversation.
pub(super) fn out_of_turn() -> HomeError {
    HomeError::of("the far end says something out of turn")
}

/// A description without `reusable`: the line to the far end closes with a run. What is none stays as it
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

/// Asks the far program `--describe`, `--estimate` or `--advise`; what it says.
///
/// # Errors
/// The far end is not reached or has another key; the program fails.
pub fn ask(home: &Home, option: &str, input: &[u8]) -> Result<Vec<u8>, HomeError> {
    let mut kept = Kept::open(home, &Membership::default())?;
    let question = match option {
        "--estimate" => Question::Estimate,
        "--advise" => Question::Advise,
        _ => Question::Describe,
    };
    if question == Question::Estimate {
        let description = kept.description()?;
        send_files(&kept.sending, &description, input)?;
    }
    let mut said = kept.ask(question, input)?;
    if question == Question::Describe {
        said = of_one_run(said);
    }
    kept.close();
    Ok(said)
}
