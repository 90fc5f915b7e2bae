//! The runs of a sweep, some at a time; what has been run is never run again.

use super::study::{Row, Study};
use crate::study::axis::Axis;
use crate::study::folder::StudyFolder;
use crate::study::levels::reason;
use crate::study::output::Kept;
use crate::study::progress::Steps;
use crate::study::quantity::Quantities;
use crate::study::{Variant, ends_study, run};
use run::error::RunError;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread;
use std::time::{Duration, Instant};

/// Time after which what has been found is written.
const WRITTEN: Duration = Duration::from_secs(1);

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
}

/// How a run has ended, and the seconds that it took.
type Ended = (Result<Value, RunError>, f64);

/// Runs every point that `study` lacks; its rows are in the order of the points, however many are run at a time.
///
/// # Errors
/// The user has stopped it, the file system.
pub(super) fn fill(study: &mut Study, how: &How<'_>, folder: &StudyFolder) -> Result<(), RunError> {
    let points: Vec<Point> = study.missing().into_iter().map(|at| Point::new(study, at)).collect();
    let mut steps = Steps::new(how.quiet, points.len());
    let (next, stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
    let outcome = thread::scope(|scope| {
        let (send, receive) = mpsc::channel();
        for job in 0..how.jobs.min(points.len()) {
            let (send, points, next, stopped) = (send.clone(), &points, &next, &stopped);
            scope.spawn(move || work(how, job, points, next, stopped, &send));
        }
        drop(send);
        collect(study, how, &points, folder, &mut steps, &receive, &stopped)
    });
    steps.finish();
    study.rows.sort_by(|a, b| a.at.cmp(&b.at));
    study.complete = outcome.is_ok();
    if outcome.is_err() {
        study.write(folder)?;
    }
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

    fn told(&self) -> String {
        let each: Vec<String> =
            self.set.iter().map(|(key, value)| format!("{key} = {value}")).collect();
        each.join(", ")
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

/// Takes what the jobs send, as rows in the order of the points, and writes it now and then. When the user has stopped one
/// of them, what the others have found is taken still.
fn collect(
    study: &mut Study,
    how: &How<'_>,
    points: &[Point],
    folder: &StudyFolder,
    steps: &mut Steps,
    receive: &Receiver<(usize, Ended)>,
    stopped: &AtomicBool,
) -> Result<(), RunError> {
    let mut early: BTreeMap<usize, Ended> = BTreeMap::new();
    let (mut turn, mut outcome) = (0, Ok(()));
    let mut written = Instant::now();
    for (n, ended) in receive {
        steps.step(&points[n].told());
        early.insert(n, ended);
        while let Some(first) =
            early.first_entry().filter(|one| *one.key() == turn || outcome.is_err())
        {
            let (n, (ended, wall_s)) = first.remove_entry();
            turn = n + 1;
            if let Err(error) = study.take(&points[n].at, ended, wall_s, how.quantities) {
                stopped.store(true, Ordering::Relaxed);
                outcome = outcome.and(Err(error));
            }
        }
        if written.elapsed() > WRITTEN {
            study.write(folder)?;
            written = Instant::now();
        }
    }
    outcome
}

impl Study {
    /// Takes the end of a run as the row of its point.
    fn take(
        &mut self,
        at: &[usize],
        ended: Result<Value, RunError>,
        wall_s: f64,
        quantities: &Quantities,
    ) -> Result<(), RunError> {
        let mut row = Row { at: at.to_vec(), values: BTreeMap::new(), failed: None, wall_s };
        match ended {
            Ok(summary) => {
                let all = quantities.all(&summary);
                for one in all.iter().filter(|one| !one.key.starts_with("coupling.")) {
                    let Some(value) = one.value(&summary) else { continue };
                    row.values.insert(one.key.clone(), value);
                    self.learn(one);
                }
            }
            Err(error) if ends_study(&error) => return Err(error),
            Err(error) => row.failed = Some(reason(&error)),
        }
        self.wall_s += wall_s;
        self.rows.push(row);
        Ok(())
    }
}
