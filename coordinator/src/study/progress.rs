//! How far a study is, by the work that its runs are expected to take: a bar on a terminal, plain lines
//! elsewhere, nothing with `--quiet`.

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
pub(crate) struct Steps {
    /// Expected work of each, in any unit.
    work: Vec<f64>,
    begun: usize,
    since: Instant,
    show: Show,
}

#[derive(Debug)]
enum Show {
    Nowhere,
    Bar(ProgressBar),
    Lines(Instant),
}

impl Steps {
    /// A study of so many steps, of which nobody knows that one takes longer than another.
    #[must_use]
    pub(crate) fn new(quiet: bool, total: usize) -> Self {
        Self::of_work(quiet, vec![1.0; total])
    }

    /// A study whose steps are expected to take this work.
    #[must_use]
    pub(crate) fn of_work(quiet: bool, work: Vec<f64>) -> Self {
        let show = if quiet {
            Show::Nowhere
        } else if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(PARTS as u64);
            let style = ProgressStyle::with_template("{bar:30} {wide_msg}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            Show::Bar(bar)
        } else {
            Show::Lines(Instant::now())
        };
        Self { work, begun: 0, since: Instant::now(), show }
    }

    /// The next step begins; `what` it is.
    pub(crate) fn step(&mut self, what: &str) {
        let done = part(&self.work, self.begun);
        self.begun += 1;
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

/// The part of all work that the first steps are.
fn part(work: &[f64], steps: usize) -> f64 {
    let sum = |work: &[f64]| work.iter().sum::<f64>();
    let all = sum(work);
    if all > 0.0 { sum(&work[..steps.min(work.len())]) / all } else { 0.0 }
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
        let work = [1.0, 1.0, 1.0, 60.0];
        let done = part(&work, 3);
        let left = left(Duration::from_secs(3), done).unwrap();
        assert!((left.as_secs_f64() - 60.0).abs() < 1e-9);
        assert_eq!(super::left(Duration::from_secs(3), part(&work, 0)), None);
        assert_eq!(part(&[], 1), 0.0);
    }
}
