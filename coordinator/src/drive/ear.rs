//! Lines of standard input. A thread waits for them, so that signals and processes are seen meanwhile.

use std::io::{BufRead, Read};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

/// Longer lines are none of the language.
const LONGEST: u64 = 1 << 20;

/// Where lines come from.
pub(super) struct Ear(Receiver<Result<String, String>>);

/// What has been heard.
#[derive(Debug, PartialEq)]
pub(super) enum Heard {
    Line(String),
    /// A line that is no text, or too long.
    Noise(String),
    Nothing,
    End,
}

impl Ear {
    /// Listens to this input until it ends.
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

    /// The next line, if one comes within this time.
    pub(super) fn hear(&self, patience: Duration) -> Heard {
        match self.0.recv_timeout(patience) {
            Ok(Ok(line)) => Heard::Line(line),
            Ok(Err(what)) => Heard::Noise(what),
            Err(RecvTimeoutError::Timeout) => Heard::Nothing,
            Err(RecvTimeoutError::Disconnected) => Heard::End,
        }
    }
}

/// A line; `None` at the end.
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
