//! Lines of standard input and output.
//!
//! A thread serves each stream, so that signals and processes are noticed while no line arrives,
//! and while the driving program does not read.

use console::output;
use run::error::RunError;
use std::cell::Cell;
use std::io::{BufRead, Read};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel, sync_channel};
use std::time::{Duration, Instant};

/// Longest line of a request.
const LONGEST: u64 = 1 << 20;

/// Lines of standard input.
pub(super) struct LineReader(Receiver<Result<String, String>>);

/// A line of standard input, or the reason why there is none.
#[derive(Debug, PartialEq)]
pub(super) enum Received {
    /// A line with its line end.
    Line(String),
    /// A line that is not UTF-8, or is too long.
    Invalid(String),
    /// No line arrived in time.
    Nothing,
    /// The input has ended.
    End,
}

impl LineReader {
    /// Reads an input until it ends.
    pub(super) fn open(input: impl BufRead + Send + 'static) -> Self {
        let (sender, receiver) = sync_channel(1);
        std::thread::spawn(move || {
            let mut input = input;
            while let Some(line) = read(&mut input) {
                if sender.send(line).is_err() {
                    return;
                }
            }
        });
        Self(receiver)
    }

    /// Returns the next line that arrives within a time.
    pub(super) fn receive(&self, patience: Duration) -> Received {
        match self.0.recv_timeout(patience) {
            Ok(Ok(line)) => Received::Line(line),
            Ok(Err(what)) => Received::Invalid(what),
            Err(RecvTimeoutError::Timeout) => Received::Nothing,
            Err(RecvTimeoutError::Disconnected) => Received::End,
        }
    }
}

/// Reads a line; `None` at the end.
fn read(input: &mut impl BufRead) -> Option<Result<String, String>> {
    let mut line = Vec::new();
    let found = input.by_ref().take(LONGEST).read_until(b'\n', &mut line).ok()?;
    if found == 0 {
        return None;
    }
    if line.last() != Some(&b'\n') && found as u64 == LONGEST {
        input.skip_until(b'\n').ok()?;
        return Some(Err(format!("the line is longer than {LONGEST} bytes")));
    }
    Some(String::from_utf8(line).map_err(|_| "the line is not UTF-8".to_owned()))
}

/// Interval of checks of processes and signals while a line is written.
const LOOK: Duration = Duration::from_millis(20);
/// Deadline for writing the last line.
const LAST_WORDS: Duration = Duration::from_secs(1);

/// Lines of standard output.
#[derive(Debug)]
pub(super) struct LineWriter {
    lines: Sender<String>,
    written: Receiver<Result<(), RunError>>,
    /// Number of lines that are being written.
    pending: Cell<u32>,
}

impl LineWriter {
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

    /// Writes a line, and calls `look` repeatedly until it is written.
    ///
    /// # Errors
    /// The line cannot be written, or `look` has failed.
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

    /// Writes the last line within a deadline.
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
        // The thread ends when this end of the channel is dropped.
        let _ = self.lines.send(line);
        self.pending.set(self.pending.get() + 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::Cursor;

    fn all(bytes: Vec<u8>) -> Vec<Result<String, String>> {
        let mut input = Cursor::new(bytes);
        std::iter::from_fn(|| read(&mut input)).collect()
    }

    #[test]
    fn lines_are_told_apart() {
        let long = vec![b'x'; LONGEST as usize + 7];
        let text = [b"a\n\n".as_slice(), &long, b"\n\xff\nlast"].concat();
        let lines = all(text);
        assert_eq!(lines[..2], [Ok("a\n".to_owned()), Ok("\n".to_owned())]);
        assert!(lines[2].as_ref().unwrap_err().contains("longer"));
        assert!(lines[3].as_ref().unwrap_err().contains("UTF-8"));
        assert_eq!(lines[4..], [Ok("last".to_owned())]);
    }

    proptest! {
        #[test]
        fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let lines = bytes.split(|b| *b == b'\n').filter(|l| !l.is_empty()).count();
            assert!(all(bytes).len() >= lines);
        }
    }
}
