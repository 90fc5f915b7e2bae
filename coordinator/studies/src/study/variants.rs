//! Runs of one case with changed values, for studies that compare figures. The runs write no
//! fields.

use super::bench::Bench;
use super::finished::Run;
use super::runner::{Attempt, Maker, Outcome, Point};
use super::spent::{RunCost, Stopwatch};
use super::{ends_study, expected_run_seconds, expected_seconds};
use console::case_arguments::Changes;
use run::error::RunError;
use run::plan::Planned;
use run::results::ResultFolder;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

/// Largest number of points that are planned before the first run, for the progress display.
const MOST_PLANNED: usize = 64;

/// Runs of one case with changed values.
pub(crate) struct Variants<'a> {
    /// The case file.
    pub(crate) case: &'a Path,
    /// Repetitions of each run; the shortest times count.
    pub(crate) repeat: u32,
    /// Runs with a longer expected time are skipped \[s\].
    pub(crate) longest_run: f64,
}

impl<'a> Variants<'a> {
    /// Returns the maker of runs of a case, each performed once.
    pub(crate) fn of(case: &'a Path) -> Self {
        Self { case, repeat: 1, longest_run: f64::INFINITY }
    }

    fn once(&self, changes: &Changes, scratch: &Path, bench: &mut Bench) -> Outcome {
        let stopwatch = Stopwatch::start();
        let planned = match bench.planned(self.case, changes) {
            Ok(planned) => planned,
            Err(error) => return Outcome::Failed(error),
        };
        let (seconds, limit) = (expected_seconds(&planned.plan), self.longest_run);
        if seconds > limit {
            let why = format!("{seconds:.1} s expected, above --longest-run {limit} s");
            return Outcome::LeftOut(why);
        }
        let folder = ResultFolder::transient(scratch);
        match folder.and_then(|folder| bench.run_planned(&planned, stopwatch.since, &folder)) {
            Ok(summary) => {
                let spent = RunCost::of(&summary, &stopwatch);
                let closed_forms = closed_forms(&planned);
                Outcome::Finished(Box::new(Run { summary, spent, closed_forms }))
            }
            Err(error) => Outcome::Failed(error),
        }
    }
}

impl Maker for Variants<'_> {
    type Made = Run;

    /// Expected times \[s\]. Points that are skipped or cannot be planned count as zero. Many
    /// points count as equal, because each would have to be planned before the first one runs.
    fn work(&self, points: &[(usize, &Point)], bench: &mut Bench) -> Result<Vec<f64>, RunError> {
        if points.len() > MOST_PLANNED {
            return Ok(vec![1.0; points.len()]);
        }
        let expected = |(_, point): &(usize, &Point)| match bench.planned(self.case, &point.changes)
        {
            Err(error) if ends_study(&error) => Err(error),
            planned => {
                let made = planned.ok();
                let made = made.filter(|one| expected_seconds(&one.plan) <= self.longest_run);
                Ok(expected_run_seconds(made.as_ref()))
            }
        };
        points.iter().map(expected).collect()
    }

    /// Performs a run with its repetitions.
    fn make(&self, (_, point): (usize, &Point), bench: &mut Bench, scratch: &Path) -> Attempt {
        let silent = point.changes.with("output.fields", "none");
        let begun = Instant::now();
        let mut made: Option<Run> = None;
        for _ in 0..self.repeat {
            match self.once(&silent, scratch, bench) {
                Outcome::Finished(run) => made = Some(run.with_least_times_of(made)),
                outcome => return Attempt { outcome, wall_s: begun.elapsed().as_secs_f64() },
            }
        }
        let run = made.expect("a run is made once at least");
        Attempt { wall_s: run.spent.wall_s, outcome: Outcome::Finished(Box::new(run)) }
    }
}

/// Quantities for which participants have a closed form. The first participant that knows a
/// quantity wins.
fn closed_forms(planned: &Planned) -> BTreeMap<String, f64> {
    let estimates = planned.plan.participants.iter().filter_map(|p| p.estimate.as_ref());
    let mut found = BTreeMap::new();
    for (key, value) in estimates.flat_map(|layout| &layout.closed_forms) {
        found.entry(key.clone()).or_insert(*value);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use run::fleet::Fleet;

    /// Only few points are planned for the progress display; each plan of a long table would delay
    /// the first run, and an interruption.
    #[test]
    fn a_long_table_is_not_planned_before_its_first_run() {
        let variants = Variants::of(Path::new("absent.toml"));
        let mut bench = Bench::new(Fleet::for_one_run());
        let point = Point { name: String::new(), changes: Changes::default() };
        // Points that cannot be planned have no work.
        assert_eq!(variants.work(&[(0, &point); 2], &mut bench).unwrap(), [0.0; 2]);
        let many = vec![(0, &point); MOST_PLANNED + 1];
        assert_eq!(variants.work(&many, &mut bench).unwrap(), vec![1.0; many.len()]);
    }
}
