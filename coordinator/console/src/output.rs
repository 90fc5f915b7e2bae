//! Standard output. Failed writes are errors, unless the reader has closed the pipe.

use contract::text::visible;
use run::error::{Failure, RunError};
use std::io::{self, Write};

/// Writes a text, with control characters escaped.
///
/// # Errors
/// Standard output cannot be written, for example to a full device.
pub fn print(text: &str) -> Result<(), RunError> {
    print_raw(&visible(text))
}

/// Writes a text without escaping; text from outside must be escaped already.
///
/// # Errors
/// Standard output cannot be written.
pub fn print_raw(text: &str) -> Result<(), RunError> {
    let mut out = io::stdout();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        // The reader of the pipe, such as `head`, has closed it.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(|error| failure(&error)),
    }
}

/// Returns the error of standard output.
#[must_use]
pub fn failure(error: &io::Error) -> RunError {
    RunError::Failed(Failure {
        who: "standard output".to_owned(),
        when: "while a result was printed".to_owned(),
        what: error.to_string(),
        fix: "check what it is redirected to; files that were written are complete".to_owned(),
    })
}

/// Writes texts as a command goes on. The first that cannot be written is an error of the command's
/// end: what it computes is worth more than its words.
#[derive(Debug)]
pub struct Speaker {
    quiet: bool,
    said: Result<(), RunError>,
}

impl Speaker {
    /// Returns a writer, or a silent one with `--quiet`.
    #[must_use]
    pub fn new(quiet: bool) -> Self {
        Self { quiet, said: Ok(()) }
    }

    /// Returns a silent writer.
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

    /// Combines the outcome of a command with the first error of writing.
    ///
    /// # Errors
    /// The error of the outcome, and the first failed write.
    pub fn end(self, outcome: Result<(), RunError>) -> Result<(), RunError> {
        match outcome {
            Ok(()) => self.said,
            Err(error) => Err(error.and(self.said)),
        }
    }
}
