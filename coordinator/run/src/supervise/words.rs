//! Standard output and error of a participant, copied into the log line by line, up to a limit.

use contract::text::one_line;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};
use tokio::io::{AsyncBufRead, AsyncBufReadExt, AsyncRead, AsyncReadExt, BufReader};
use tokio::task::JoinHandle;

/// Length at which a line is split in the log [byte].
const LONGEST_LINE: u64 = 64 * 1024;

/// Space in the log for the lines of one participant [byte].
const ROOM: usize = 8 << 20;
/// Size of a log line besides its text: time, role, braces [byte].
const FRAME: usize = 128;
/// Number of last lines that are logged after the limit: they show how the process ended.
const LAST: usize = 20;

/// Lines written by a participant.
#[derive(Debug)]
pub(super) struct ProcessOutput {
    role: String,
    room: usize,
    last: Option<String>,
    /// Number of lines beyond the limit, and the newest of them.
    left_out: u64,
    newest: VecDeque<String>,
}

impl ProcessOutput {
    pub(super) fn new(role: &str) -> Self {
        let (role, newest) = (role.to_owned(), VecDeque::new());
        Self { role, room: ROOM, last: None, left_out: 0, newest }
    }

    fn line(&mut self, line: &str) {
        let taken = line.len() + FRAME;
        self.last = Some(line.to_owned());
        if self.left_out == 0 && taken <= self.room {
            self.room -= taken;
            return self.log(line);
        }
        if self.left_out == 0 {
            let mebibytes = ROOM >> 20;
            let role = &self.role;
            tracing::warn!(role, "it has written {mebibytes} MiB; further lines are omitted");
        }
        self.left_out += 1;
        self.newest.push_back(line.to_owned());
        if self.newest.len() > LAST {
            self.newest.pop_front();
        }
    }

    fn log(&self, line: &str) {
        tracing::info!(target: "participant", role = self.role, "{line}");
    }

    /// Ends the output: logs the newest omitted lines, and returns the last line of all.
    pub(super) fn end(&mut self) -> Option<String> {
        let newest = std::mem::take(&mut self.newest);
        let lines = self.left_out - newest.len() as u64;
        if lines > 0 {
            tracing::warn!(role = self.role, lines, "lines were omitted; the last ones follow");
        }
        newest.iter().for_each(|line| self.log(line));
        self.last.take()
    }
}

/// Copies a process's output into the log.
pub(super) fn relay(
    pipe: impl AsyncRead + Unpin + Send + 'static,
    words: &Arc<Mutex<ProcessOutput>>,
) -> JoinHandle<()> {
    let words = Arc::clone(words);
    tokio::spawn(async move {
        let mut pipe = BufReader::new(pipe);
        let mut line = Vec::new();
        while next_line(&mut pipe, &mut line).await {
            let line = String::from_utf8_lossy(&line);
            let line = one_line(line.trim_end());
            if !line.is_empty() {
                words.lock().unwrap_or_else(PoisonError::into_inner).line(&line);
            }
        }
    })
}

/// Reads a line, or a piece of a long line. Returns false at the end.
async fn next_line(pipe: &mut (impl AsyncBufRead + Unpin), line: &mut Vec<u8>) -> bool {
    line.clear();
    let mut piece = pipe.take(LONGEST_LINE);
    matches!(piece.read_until(b'\n', line).await, Ok(count) if count > 0)
}
