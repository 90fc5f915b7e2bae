//! Progress of a study, weighted by the expected work of its runs: a bar on a terminal, plain lines
//! elsewhere, JSON lines on request, nothing with `--quiet`.

use crate::feed::Feed;
use indicatif::{ProgressBar, ProgressStyle};
use run::format::clock;
use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

/// Time between two plain lines.
const PLAIN: Duration = Duration::from_secs(5);
/// Number of parts of the bar.
const PARTS: f64 = 1000.0;

/// The steps of a study.
#[derive(Debug)]
pub struct Steps {
    /// Expected work of each step, in any unit.
    work: Vec<f64>,
    /// Sum of all work.
    all: f64,
    begun: usize,
    /// Sum of the work of finished steps.
    done: f64,
    since: Instant,
    show: Show,
}

#[derive(Debug)]
enum Show {
    Nowhere,
    Bar(ProgressBar),
    Lines(Instant),
    Fed(Feed),
}

impl Steps {
    /// Returns a study of equal steps.
    #[must_use]
    pub fn new(quiet: bool, total: usize) -> Self {
        Self::of_work(quiet, vec![1.0; total])
    }

    /// Returns a study with the expected work of each step.
    #[must_use]
    pub fn of_work(quiet: bool, work: Vec<f64>) -> Self {
        let show = if quiet {
            Show::Nowhere
        } else if let Some(feed) = Feed::wanted() {
            Show::Fed(feed)
        } else if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(PARTS as u64);
            let style = ProgressStyle::with_template("{bar:30} {wide_msg}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            Show::Bar(bar)
        } else {
            Show::Lines(Instant::now())
        };
        let all = work.iter().sum();
        Self { work, all, begun: 0, done: 0.0, since: Instant::now(), show }
    }

    /// Begins the next step, described by `what`.
    pub fn step(&mut self, what: &str) {
        self.reach(self.begun + 1, what);
    }

    /// Begins or continues a step, counted from 1 and described by `what`.
    pub fn reach(&mut self, step: usize, what: &str) {
        let passed = self.begun.saturating_sub(1)..step.saturating_sub(1).min(self.work.len());
        self.done += self.work.get(passed).unwrap_or_default().iter().sum::<f64>();
        self.begun = self.begun.max(step);
        let done = if self.all > 0.0 { self.done / self.all } else { 0.0 };
        let left = left(self.since.elapsed(), done);
        tracing::debug!(done, left_s = left.map(|left| left.as_secs_f64()), what, "step");
        let (begun, total) = (self.begun, self.work.len());
        let line = match left {
            Some(left) => format!("{begun} of {total}, {} left: {what}", clock(left)),
            None => format!("{begun} of {total}: {what}"),
        };
        match &mut self.show {
            Show::Nowhere => {}
            Show::Bar(bar) => {
                bar.set_position((PARTS * done) as u64);
                bar.set_message(line);
            }
            Show::Lines(last) if last.elapsed() > PLAIN => {
                let _ = writeln!(std::io::stderr(), "{line}");
                *last = Instant::now();
            }
            Show::Lines(_) => {}
            // The step that has begun is not finished.
            Show::Fed(feed) => {
                let counted = (Some(begun.saturating_sub(1) as u64), Some(total as u64));
                feed.tell(counted, "steps", &line);
            }
        }
    }

    /// Writes while the bar steps aside.
    pub fn aside<T>(&self, write: impl FnOnce() -> T) -> T {
        match &self.show {
            Show::Bar(bar) => bar.suspend(write),
            Show::Nowhere | Show::Lines(_) | Show::Fed(_) => write(),
        }
    }

    /// Ends the study.
    pub fn finish(self) {
        match self.show {
            Show::Bar(bar) => bar.finish_and_clear(),
            Show::Fed(feed) => {
                let all = Some(self.work.len() as u64);
                feed.tell((all, all), "steps", "");
                feed.finish();
            }
            Show::Nowhere | Show::Lines(_) => {}
        }
    }
}

/// Returns the time left at the pace so far, or `None` before the first step has finished.
fn left(elapsed: Duration, done: f64) -> Option<Duration> {
    (done > 0.0).then(|| elapsed.mul_f64((1.0 - done).max(0.0) / done))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_goes_by_work() {
        // After three quick runs, a run of a minute is nearly all of the work.
        let mut steps = Steps::of_work(true, vec![1.0, 1.0, 1.0, 60.0]);
        (0..3).for_each(|_| steps.step(""));
        assert_eq!((steps.begun, steps.done), (3, 2.0));
        steps.reach(4, "");
        steps.reach(4, "");
        assert_eq!((steps.begun, steps.done, steps.all), (4, 3.0, 63.0));
        let left = |done| left(Duration::from_secs(3), done);
        assert!((left(steps.done / steps.all).unwrap().as_secs_f64() - 60.0).abs() < 1e-9);
        assert_eq!(left(0.0), None);
        let mut none = Steps::new(true, 0);
        none.step("");
        assert_eq!(none.done, 0.0);
    }
}
