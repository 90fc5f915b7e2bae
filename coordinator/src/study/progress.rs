//! How far a study is: a bar on a terminal, plain lines elsewhere, nothing with `--quiet`.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

/// Time between two plain lines.
const PLAIN: Duration = Duration::from_secs(5);

/// The steps of a study.
#[derive(Debug)]
pub(crate) struct Steps {
    total: usize,
    begun: usize,
    show: Show,
}

#[derive(Debug)]
enum Show {
    Nowhere,
    Bar(ProgressBar),
    Lines(Instant),
}

impl Steps {
    /// A study of so many steps.
    #[must_use]
    pub(crate) fn new(quiet: bool, total: usize) -> Self {
        let show = if quiet {
            Show::Nowhere
        } else if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(total as u64);
            let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {wide_msg} {eta} left");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            Show::Bar(bar)
        } else {
            Show::Lines(Instant::now())
        };
        Self { total, begun: 0, show }
    }

    /// The next step begins; `what` it is.
    pub(crate) fn step(&mut self, what: &str) {
        self.begun += 1;
        match &mut self.show {
            Show::Nowhere => {}
            Show::Bar(bar) => {
                bar.set_position(self.begun as u64 - 1);
                bar.set_message(what.to_owned());
            }
            Show::Lines(last) if last.elapsed() > PLAIN => {
                let (begun, total) = (self.begun, self.total);
                let _ = writeln!(std::io::stderr(), "{begun} of {total}: {what}");
                *last = Instant::now();
            }
            Show::Lines(_) => {}
        }
    }

    /// Writes something while the bar steps aside.
    pub(crate) fn aside(&self, write: impl FnOnce()) {
        match &self.show {
            Show::Bar(bar) => bar.suspend(write),
            Show::Nowhere | Show::Lines(_) => write(),
        }
    }

    /// The study is over.
    pub(crate) fn finish(self) {
        if let Show::Bar(bar) = self.show {
            bar.finish_and_clear();
        }
    }
}
