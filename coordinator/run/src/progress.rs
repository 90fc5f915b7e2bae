//! Progress of a run, and of long work in it.

use crate::format::clock;
use contract::message::ProgressReport;
use contract::text::one_line;
use std::fmt;
use std::rc::Rc;
use std::time::Duration;

/// Shows the progress of a run; `()` shows nothing.
pub trait Progress: fmt::Debug {
    /// Reports that `done` windows are complete, up to the time `reached` [s].
    fn window(&self, done: u64, reached: f64);

    /// Reports that a participant has advanced in long work.
    fn working(&self, work: &Work<'_>);

    /// Reports the end of the run.
    fn finish(&self);
}

/// Returns a display that shows nothing.
#[must_use]
pub fn silent() -> Rc<dyn Progress> {
    Rc::new(())
}

impl Progress for () {
    fn window(&self, _done: u64, _reached: f64) {}

    fn working(&self, _work: &Work<'_>) {}

    fn finish(&self) {}
}

/// Long work of a participant, as counted by the participant.
#[derive(Clone, Copy, Debug)]
pub struct Work<'a> {
    /// Role of the participant.
    pub role: &'a str,
    /// Present participle for the current command ("building").
    pub doing: &'a str,
    /// Newest report.
    pub report: ProgressReport,
    /// Remaining time at the pace so far, if known.
    pub left: Option<Duration>,
}

/// Formats the work like "thermal building: factorising 37/60, 0:23 left".
impl fmt::Display for Work<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ProgressReport { done, of, what, .. } = self.report;
        write!(f, "{} {}: ", self.role, self.doing)?;
        match one_line(what.as_str()) {
            what if what.is_empty() => {}
            what => write!(f, "{what} ")?,
        }
        match of {
            0 => write!(f, "{done}")?,
            of => write!(f, "{done}/{of}")?,
        }
        self.left.map_or(Ok(()), |left| write!(f, ", {} left", clock(left)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::message::Label;

    #[test]
    fn work_reads_as_one_line() {
        let shown = |what: &str, of, left: Option<u64>| {
            let report = ProgressReport { sequence: 1, done: 37, of, what: Label::new(what) };
            let left = left.map(Duration::from_secs);
            Work { role: "thermal", doing: "building", report, left }.to_string()
        };
        let line = "thermal building: factorising 37/60, 0:23 left";
        assert_eq!(shown("factorising", 60, Some(23)), line);
        assert_eq!(shown("", 60, Some(7384)), "thermal building: 37/60, 2:03:04 left");
        assert_eq!(shown("\u{1b}[2J", 0, None), "thermal building: \\u{1b}[2J 37");
    }
}
