//! The runs of a sweep, some at a time; what has been run is never run again.

use super::rows::Growing;
use super::study::{Row, Study};
use crate::study::arguments::StudyArguments;
use crate::study::axis::Axis;
use crate::study::levels::reason;
use crate::study::quantity::Quantities;
use crate::study::{Variant, ends_study, run};
use console::steps::Steps;
use run::error::RunError;
use serde_json::Value;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Sender};
use std::thread;
use std::time::Instant;

/// How the points are run.
pub(super) struct How<'a> {
    /// The case.
    pub case: &'a Path,
    /// What is changed for all points.
    pub base: &'a Variant,
    /// What a summary has.
    pub quantities: &'a Quantities,
    /// Points at a time.
    pub jobs: usize,
    /// A folder for results that nobody looks at.
    pub scratch: &'a Path,
    /// No progress is shown.
    pub quiet: bool,
    /// Options that decide whether participants stay from point to point.
    pub study: &'a StudyArguments,
}

/// How a run has ended, and the seconds that it took.
type Ended = (Result<Value, RunError>, f64);

/// Runs every point that a sweep lacks, some at a time; each is in the file as soon as it is found.
///
/// # Errors
/// The user has stopped it, the file system.
pub(super) fn fill(sweep: &mut Growing, how: &How<'_>) -> Result<(), RunError> {
    let study = &sweep.study;
    let points: Vec<Point> =
        study.missing().into_iter().map(|number| Point::new(study, study.point(number))).collect();
    let mut steps = Steps::new(how.quiet, points.len());
    let (next, stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
    let outcome = thread::scope(|scope| {
        let (send, receive) = mpsc::channel();
        for job in 0..how.jobs.min(points.len()) {
            let (send, points, next, stopped) = (send.clone(), &points, &next, &stopped);
            scope.spawn(move || work(how, job, points, next, stopped, &send));
        }
        drop(send);
        let mut outcome = Ok(());
        // When the user has stopped one of them, what the others have found is taken still.
        for (n, (ended, wall_s)) in receive {
            steps.step(&sweep.study.told(&points[n].at));
            let row = sweep.study.row(&points[n].at, ended, wall_s, how.quantities);
            if let Err(error) = row.and_then(|row| sweep.add(row)) {
                stopped.store(true, Ordering::Relaxed);
                outcome = outcome.and(Err(error));
            }
        }
        outcome
    });
    steps.finish();
    outcome
}

/// A point to run.
struct Point {
    at: Vec<usize>,
    set: Vec<(String, String)>,
}

impl Point {
    fn new(study: &Study, at: Vec<usize>) -> Self {
        let value = |(one, at): (&Axis, &usize)| (one.key.clone(), one.values[*at].clone());
        let set = study.vary.iter().zip(&at).map(value).collect();
        Self { at, set }
    }
}

/// Runs points until there is none left, or the sweep has stopped.
fn work(
    how: &How<'_>,
    job: usize,
    points: &[Point],
    next: &AtomicUsize,
    stopped: &AtomicBool,
    send: &Sender<(usize, Ended)>,
) {
    let _participants = how.study.keep();
    let folder = how.scratch.join(job.to_string());
    while !stopped.load(Ordering::Relaxed) {
        let n = next.fetch_add(1, Ordering::Relaxed);
        let Some(point) = points.get(n) else { return };
        let since = Instant::now();
        let set = |all: Variant, (key, value): &(String, String)| all.with(key, value);
        let variant = point.set.iter().fold(how.base.clone(), set);
        let ended = run(how.case, &variant.with("output.fields", "none"), &folder);
        if send.send((n, (ended, since.elapsed().as_secs_f64()))).is_err() {
            return;
        }
    }
}

impl Study {
    /// The end of a run as the row of its point.
    fn row(
        &mut self,
        at: &[usize],
        ended: Result<Value, RunError>,
        wall_s: f64,
        quantities: &Quantities,
    ) -> Result<Row, RunError> {
        let mut row = Row { at: at.to_vec(), values: Vec::new(), failed: None, wall_s };
        match ended {
            Ok(summary) => {
                let all = quantities.all(&summary);
                for one in all.iter().filter(|one| !one.key.starts_with("coupling.")) {
                    let Some(value) = one.value(&summary) else { continue };
                    let column = self.learn(one);
                    row.values.resize(row.values.len().max(column + 1), f64::NAN);
                    row.values[column] = value;
                }
            }
            Err(error) if ends_study(&error) => return Err(error),
            Err(error) => row.failed = Some(reason(&error)),
        }
        Ok(row)
    }
}
