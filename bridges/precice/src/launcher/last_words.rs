//! Standard error of a program: passed on, with the last line kept for the message about its end.

use std::collections::VecDeque;
use std::io::{Read, Write};
use std::process::ChildStderr;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Number of bytes at the end of the output that are kept.
const KEPT: usize = 4096;
/// Longest line in a message [character].
const LONGEST: usize = 300;
/// Time for the rest of the output after the program has ended. A process that the program started
/// may hold the pipe open.
const REST: Duration = Duration::from_millis(100);

/// End of the output of a program.
#[derive(Debug)]
pub(super) struct LastWords {
    tail: Arc<Mutex<VecDeque<u8>>>,
    /// Closed when all output has been passed on.
    open: Receiver<()>,
}

impl LastWords {
    /// Passes on the standard error of a program in a thread.
    pub(super) fn of(output: Option<ChildStderr>) -> Self {
        let tail = Arc::default();
        let (open, closed) = channel::<()>();
        if let Some(output) = output {
            let tail = Arc::clone(&tail);
            std::thread::spawn(move || {
                pass_on(output, &tail);
                drop(open);
            });
        }
        Self { tail, open: closed }
    }

    /// Returns the last line that has text, after the program has ended.
    pub(super) fn take(&self) -> Option<String> {
        let _ = self.open.recv_timeout(REST);
        let tail: Vec<u8> =
            self.tail.lock().unwrap_or_else(PoisonError::into_inner).iter().copied().collect();
        last_line(&tail)
    }
}

fn pass_on(mut output: impl Read, tail: &Mutex<VecDeque<u8>>) {
    let mut buffer = [0; KEPT];
    while let Ok(count) = output.read(&mut buffer) {
        if count == 0 {
            return;
        }
        let mut tail = tail.lock().unwrap_or_else(PoisonError::into_inner);
        tail.extend(&buffer[..count]);
        let excess = tail.len().saturating_sub(KEPT);
        tail.drain(..excess);
        drop(tail);
        // Without a reader of the launcher's own output, the program still goes on.
        let _ = std::io::stderr().write_all(&buffer[..count]);
    }
}

/// Returns the last line that has text, without characters that would change a message.
fn last_line(output: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(output);
    let line = text.lines().rev().map(str::trim).find(|line| !line.is_empty())?;
    let start: String = line.chars().take(LONGEST).collect();
    Some(proto::text::one_line(&start).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_line_with_text_is_kept() {
        let said = b"Traceback:\n  File\nModuleNotFoundError: No module named 'precice'\n\n";
        let tail = Mutex::default();
        pass_on(&[vec![b'x'; 2 * KEPT], said.to_vec()].concat()[..], &tail);
        let tail: Vec<u8> = tail.into_inner().unwrap().into();
        assert_eq!(tail.len(), KEPT);
        let expected = "ModuleNotFoundError: No module named 'precice'";
        assert_eq!(last_line(&tail).as_deref(), Some(expected));
        assert_eq!(last_line(b" \n\n"), None);
        assert_eq!(last_line(&[b'y'; KEPT]).unwrap().len(), LONGEST);
    }
}
