//! Standard output: what cannot be written there is an error, unless its reader has gone away.

use contract::text::visible;
use run::error::{Failure, RunError};
use std::io::{self, Write};

/// Writes a text, all of it, with what would control a terminal as escapes.
///
/// # Errors
/// It cannot be written, to a full device for example.
pub fn print(text: &str) -> Result<(), RunError> {
    print_raw(&visible(text))
}

/// Writes a text as it is: one of which everything from outside is visible.
///
/// # Errors
/// It cannot be written.
pub fn print_raw(text: &str) -> Result<(), RunError> {
    let mut out = io::stdout();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        // `| head` has read what it wanted.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(|error| failure(&error)),
    }
}

/// Standard output failed.
#[must_use]
pub fn failure(error: &io::Error) -> RunError {
    RunError::Failed(Failure {
        who: "standard output".to_owned(),
        when: "while a result was printed".to_owned(),
        what: error.to_string(),
        fix: "check what it is redirected to; files that were written are complete".to_owned(),
    })
}

/// Writes texts as a command goes on. The first that cannot be written is an error of the command's end:
/// what it computes is worth more than its words.
#[derive(Debug)]
pub struct Speaker {
    quiet: bool,
    said: Result<(), RunError>,
}

impl Speaker {
    /// One that writes, or a quiet one.
    #[must_use]
    pub fn new(quiet: bool) -> Self {
        Self { quiet, said: Ok(()) }
    }

    /// It writes nothing.
    #[must_use]
    pub fn is_quiet(&self) -> bool {
        self.quiet
    }

    /// Writes a text.
    pub fn say(&mut self, text: &str) {
        if !self.quiet && self.said.is_ok() {
            self.said = print(text);
        }
    }

    /// How a command has ended that has come to this outcome.
    ///
    /// # Errors
    /// That of the outcome, and that something could not be written.
    pub fn end(self, outcome: Result<(), RunError>) -> Result<(), RunError> {
        match outcome {
            Ok(()) => self.said,
            Err(error) => Err(error.and(self.said)),
        }
    }
}
