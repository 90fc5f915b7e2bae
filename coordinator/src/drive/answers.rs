//! Lines of standard output. A thread writes them, so that signals and processes are seen while whoever
//! drives the run does not read.

use console::output;
use run::error::RunError;
use std::cell::Cell;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

/// Between two looks at processes and signals while a line is written.
const LOOK: Duration = Duration::from_millis(20);
/// Deadline for writing the last line.
const LAST_WORDS: Duration = Duration::from_secs(1);

/// Destination of the answers.
#[derive(Debug)]
pub(super) struct Answers {
    lines: Sender<String>,
    written: Receiver<Result<(), RunError>>,
    /// Lines that are on their way.
    pending: Cell<u32>,
}

impl Answers {
    pub(super) fn open() -> Self {
        let (lines, given) = channel::<String>();
        let (report, written) = channel();
        std::thread::spawn(move || {
            while let Ok(line) = given.recv() {
                if report.send(output::print_raw(&line)).is_err() {
                    return;
                }
            }
        });
        Self { lines, written, pending: Cell::new(0) }
    }

    /// Writes a line; `look` is called again and again until that is done.
    ///
    /// # Errors
    /// The line cannot be written; what `look` has seen.
    pub(super) fn write(
        &self,
        line: String,
        mut look: impl FnMut() -> Result<(), RunError>,
    ) -> Result<(), RunError> {
        self.give(line);
        while self.pending.get() > 0 {
            match self.written.recv_timeout(LOOK) {
                Ok(result) => {
                    self.pending.set(self.pending.get() - 1);
                    result?;
                }
                Err(RecvTimeoutError::Timeout) => look()?,
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
            }
        }
        Ok(())
    }

    /// Writes the last line, if it is read soon.
    ///
    /// # Errors
    /// The line cannot be written.
    pub(super) fn write_last(&self, line: String) -> Result<(), RunError> {
        self.give(line);
        let until = Instant::now() + LAST_WORDS;
        while self.pending.get() > 0 {
            match self.written.recv_timeout(until.saturating_duration_since(Instant::now())) {
                Ok(result) => {
                    self.pending.set(self.pending.get() - 1);
                    result?;
                }
                Err(_) => return Ok(()),
            }
        }
        Ok(())
    }

    fn give(&self, line: String) {
        // The thread ends only after this end of the channel.
        let _ = self.lines.send(line);
        self.pending.set(self.pending.get() + 1);
    }
}
