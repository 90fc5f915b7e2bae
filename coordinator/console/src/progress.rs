//! Progress of a run: a bar on a terminal, plain lines elsewhere, JSON lines on request, nothing
//! with `--quiet`.

use crate::feed::Feed;
use indicatif::{ProgressBar, ProgressStyle};
use run::format::{clock, quantity};
use run::progress::Work;
use std::cell::Cell;
use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

/// Time between two plain lines about windows.
const PLAIN: Duration = Duration::from_secs(5);
/// Time between two plain lines about long work, and before the first.
const PLAIN_WORK: Duration = Duration::from_secs(10);
/// Longest expected time that is announced [s].
const LONGEST: f64 = 1e7;
/// Template of the line on a terminal while a participant works long.
const WORK: &str = "{spinner} {elapsed} {msg}";
/// Time between two frames of the spinner.
const TURN: Duration = Duration::from_millis(120);

/// Target of progress.
#[derive(Debug)]
pub enum Progress {
    /// Progress is not shown.
    Silent,
    /// A bar on a terminal.
    Bar {
        /// The bar.
        bar: ProgressBar,
        /// Style for windows; `None` if there are too few to show.
        windows: Option<&'static str>,
        /// The bar shows long work.
        working: Cell<bool>,
    },
    /// Lines in a file or a pipe.
    Lines {
        /// Total number of windows.
        total: Option<u64>,
        /// Time of the last line.
        last: Cell<Instant>,
    },
    /// JSON lines for a program.
    Fed {
        /// The lines.
        feed: Feed,
        /// Total number of windows.
        total: Option<u64>,
        /// Finished windows.
        done: Cell<u64>,
    },
}

impl Progress {
    /// Chooses how to show the progress of `total` windows, `None` if nobody knows how many, which
    /// are expected to take so long \[s\].
    #[must_use]
    pub fn new(quiet: bool, total: Option<u64>, expected: f64) -> Self {
        if quiet {
            Self::Silent
        } else if let Some(feed) = Feed::wanted() {
            Self::Fed { feed, total, done: Cell::new(0) }
        } else if std::io::stderr().is_terminal() {
            let bar = total.map_or_else(ProgressBar::no_length, ProgressBar::new);
            let windows = match total {
                Some(0 | 1) => None,
                Some(_) => Some("{bar:40} {pos}/{len} windows {msg} {eta} left"),
                None => Some("{pos} windows {msg} {elapsed}"),
            };
            bar.set_style(style(windows.unwrap_or(WORK)));
            if windows.is_none() {
                let expected = Duration::from_secs_f64(expected.clamp(0.0, LONGEST));
                bar.set_message(format!("of about {} expected", clock(expected)));
                bar.enable_steady_tick(TURN);
            }
            Self::Bar { bar, windows, working: Cell::new(false) }
        } else {
            Self::Lines { total, last: Cell::new(Instant::now()) }
        }
    }

    /// Returns the bar, if progress is shown on a terminal.
    #[must_use]
    pub fn bar(&self) -> Option<&ProgressBar> {
        match self {
            Self::Bar { bar, .. } => Some(bar),
            Self::Silent | Self::Lines { .. } | Self::Fed { .. } => None,
        }
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

impl run::progress::Progress for Progress {
    fn window(&self, done: u64, reached: f64) {
        match self {
            Self::Bar { bar, windows: Some(template), working } => {
                let worked = working.replace(false);
                if worked {
                    bar.set_style(style(template));
                }
                bar.set_position(done);
                if worked || done.is_power_of_two() || done.is_multiple_of(64) {
                    bar.set_message(format!("t = {reached}", reached = quantity(reached, "s", 4)));
                }
            }
            Self::Lines { total, last } if *total != Some(1) && last.get().elapsed() > PLAIN => {
                let of = total.map_or_else(String::new, |total| format!(" of {total}"));
                let _ = writeln!(
                    std::io::stderr(),
                    "window {done}{of}, t = {reached}",
                    reached = quantity(reached, "s", 5)
                );
                last.set(Instant::now());
            }
            Self::Fed { feed, total, done: before } => {
                before.set(done);
                feed.tell(
                    (Some(done), *total),
                    "windows",
                    &format!("t = {reached}", reached = quantity(reached, "s", 4)),
                );
            }
            Self::Silent | Self::Bar { .. } | Self::Lines { .. } => {}
        }
    }

    fn working(&self, work: &Work<'_>) {
        match self {
            Self::Bar { bar, working, .. } => {
                if !working.replace(true) {
                    bar.set_style(style(WORK));
                }
                bar.set_message(work.to_string());
            }
            Self::Lines { last, .. } if last.get().elapsed() > PLAIN_WORK => {
                let _ = writeln!(std::io::stderr(), "{work}");
                last.set(Instant::now());
            }
            Self::Fed { feed, total, done } => {
                feed.tell((Some(done.get()), *total), "windows", &work.to_string());
            }
            Self::Silent | Self::Lines { .. } => {}
        }
    }

    fn finish(&self) {
        match self {
            Self::Bar { bar, .. } => bar.finish_and_clear(),
            Self::Fed { feed, .. } => feed.finish(),
            Self::Silent | Self::Lines { .. } => {}
        }
    }
}
