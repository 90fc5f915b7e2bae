//! Progress of a run: a bar on a terminal, plain lines elsewhere, nothing with `--quiet`.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

/// Time between two plain lines.
const PLAIN: Duration = Duration::from_secs(5);

/// Where progress is shown.
#[derive(Debug)]
pub(crate) enum Progress {
    /// Nowhere.
    Silent,
    /// On a terminal.
    Bar(ProgressBar),
    /// In a file or a pipe: a line now and then.
    Lines {
        /// Windows in all.
        total: Option<u64>,
        /// When the last line was written.
        last: Instant,
    },
}

impl Progress {
    /// Chooses how to show the progress of `total` windows; `None` if nobody knows how many.
    #[must_use]
    pub(crate) fn new(quiet: bool, total: Option<u64>) -> Self {
        if quiet || total.is_some_and(|total| total < 2) {
            Self::Silent
        } else if std::io::stderr().is_terminal() {
            let bar = total.map_or_else(ProgressBar::no_length, ProgressBar::new);
            let style = ProgressStyle::with_template(match total {
                Some(_) => "{bar:40} {pos}/{len} windows {msg} {eta} left",
                None => "{pos} windows {msg} {elapsed}",
            });
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            Self::Bar(bar)
        } else {
            Self::Lines { total, last: Instant::now() }
        }
    }

    /// The bar, if that is how progress is shown.
    #[must_use]
    pub(crate) fn bar(&self) -> Option<&ProgressBar> {
        match self {
            Self::Bar(bar) => Some(bar),
            Self::Silent | Self::Lines { .. } => None,
        }
    }
}

impl run::progress::Progress for Progress {
    fn window(&mut self, done: u64, reached: f64) {
        match self {
            Self::Silent => {}
            Self::Bar(bar) => {
                bar.set_position(done);
                if done.is_power_of_two() || done.is_multiple_of(64) {
                    bar.set_message(format!("t = {reached:.3e} s"));
                }
            }
            Self::Lines { total, last } if last.elapsed() > PLAIN => {
                let of = total.map_or_else(String::new, |total| format!(" of {total}"));
                let _ = writeln!(std::io::stderr(), "window {done}{of}, t = {reached:.4e} s");
                *last = Instant::now();
            }
            Self::Lines { .. } => {}
        }
    }

    fn finish(&mut self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}
