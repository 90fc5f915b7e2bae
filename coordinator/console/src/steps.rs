//! How far a study is, by the work that its runs are expected to take: a bar on a terminal, plain lines
//! elsewhere, JSON lines for a program that asks for them, nothing with `--quiet`.

use crate::feed::Feed;
use indicatif::{ProgressBar, ProgressStyle};
use run::format::clock;
use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

/// Time between two plain lines.
const PLAIN: Duration = Duration::from_secs(5);
/// Parts of the bar.
const PARTS: f64 = 1000.0;

/// The steps of a study.
#[derive(Debug)]
pub struct Steps {
    /// Expected work of each, in any unit.
    work: Vec<f64>,
    /// The sum of all work.
    all: f64,
    begun: usize,
    /// The sum of the work of the steps before the one that has begun.
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
    /// A study of so many steps, of which nobody knows that one takes longer than another.
    #[must_use]
    pub fn new(quiet: bool, total: usize) -> Self {
        Self::of_work(quiet, vec![1.0; total])
    }

    /// A study whose steps are expected to take this work.
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

    /// The next step begins; `what` it is.
    pub fn step(&mut self, what: &str) {
        self.reach(self.begun + 1, what);
    }

    /// This step, from 1 on, begins, or goes on; `what` it is.
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
            // What has begun is not done.
            Show::Fed(feed) => {
                let counted = (Some(begun.saturating_sub(1) as u64), Some(total as u64));
                feed.tell(counted, "steps", &line);
            }
        }
    }

    /// Writes something while the bar steps aside.
    pub fn aside(&self, write: impl FnOnce()) {
        match &self.show {
            Show::Bar(bar) => bar.suspend(write),
            Show::Nowhere | Show::Lines(_) | Show::Fed(_) => write(),
        }
    }

    /// The study is over.
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

/// What is left, at the pace so far; nobody knows before there is one.
fn left(elapsed: Duration, done: f64) -> Option<Duration> {
    (done > 0.0).then(|| elapsed.mul_f64((1.0 - done).max(0.0) / done))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_goes_by_work() {
        // Three quick runs and one of a minute: after the quick ones nearly all is left.
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
