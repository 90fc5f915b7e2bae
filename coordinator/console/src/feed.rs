//! Progress for another program: JSON lines on standard error, if `COSIM_PROGRESS` is `json`.
//!
//! `{"progress":{"done":37,"of":110,"what":"windows","words":"t = 1.2e-4 s"}}`; `done` and `of` are
//! null if they are unknown.

use serde_json::json;
use std::cell::RefCell;
use std::io::Write;
use std::time::{Duration, Instant};

/// Environment variable that selects the form of progress.
const FORM: &str = "COSIM_PROGRESS";
/// Shortest time between two lines.
const LEAST: Duration = Duration::from_millis(100);

/// Writer of the lines. Lines that come too early are held back; the last one is written at the
/// end.
#[derive(Debug, Default)]
pub struct Feed(RefCell<Held>);

#[derive(Debug, Default)]
struct Held {
    last: Option<Instant>,
    line: Option<String>,
}

impl Feed {
    /// Returns the feed, if the environment requests it.
    #[must_use]
    pub fn wanted() -> Option<Self> {
        std::env::var_os(FORM).is_some_and(|form| form == "json").then(Self::default)
    }

    /// Reports `done` of `of` steps, with words about them.
    pub fn tell(&self, (done, of): (Option<u64>, Option<u64>), what: &str, words: &str) {
        let told = json!({"progress": {"done": done, "of": of, "what": what, "words": words}});
        let mut held = self.0.borrow_mut();
        held.line = Some(told.to_string());
        if held.last.is_none_or(|last| last.elapsed() >= LEAST) {
            held.write();
        }
    }

    /// Writes the last line that was held back.
    pub fn finish(&self) {
        self.0.borrow_mut().write();
    }
}

impl Held {
    fn write(&mut self) {
        if let Some(line) = self.line.take() {
            let _ = writeln!(std::io::stderr(), "{line}");
            self.last = Some(Instant::now());
        }
    }
}
