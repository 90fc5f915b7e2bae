//! The runner of studies: performs the runs of a list of points, several at a time. Runs that
//! finished before an interruption are not repeated.

use super::arguments::StudyArguments;
use super::bench::Bench;
use super::finished::{FinishedRuns, Run};
use super::folder::StudyFolder;
use super::spent::{RunCost, Stopwatch};
use super::{ends_study, expected_run_seconds, expected_seconds};
use console::case_arguments::Changes;
use console::steps::Steps;
use run::error::RunError;
use run::plan::Planned;
use run::results::ResultFolder;
use run::scratch::Scratch;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Sender};
use std::thread;
use std::time::Instant;

/// Largest number of points that are planned before the first run, for the progress display.
const MOST_PLANNED: usize = 64;

/// A run to perform.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// Name on the screen.
    pub(crate) name: String,
    /// Changes of the case.
    pub(crate) changes: Changes,
}

/// Outcome of a run.
pub(crate) enum Outcome {
    /// The run finished.
    Finished(Box<Run>),
    /// The run was skipped for this reason.
    LeftOut(String),
    /// The run failed.
    Failed(RunError),
}

/// A run with all its repetitions.
pub(crate) struct Attempt {
    /// Outcome of the run.
    pub(crate) outcome: Outcome,
    /// Shortest wall-clock time of all repetitions \[s\].
    pub(crate) wall_s: f64,
}

/// Performs single runs of a case. The runs write no fields.
struct Maker<'a> {
    case: &'a Path,
    arguments: &'a StudyArguments,
    repeat: u32,
    longest_run: f64,
}

/// Performs the runs of a study.
pub(crate) struct Runner<'a> {
    case: &'a Path,
    arguments: &'a StudyArguments,
    /// Participants of runs that are performed one by one.
    pub(crate) bench: Bench,
    quiet: bool,
    scratch: Scratch,
    /// Repetitions of each run; the shortest times count.
    pub(crate) repeat: u32,
    /// Number of runs at a time.
    pub(crate) jobs: usize,
    /// Runs with a longer expected time are skipped \[s\].
    pub(crate) longest_run: f64,
    /// Finished runs and their folder, for a study that can be resumed.
    finished: Option<(FinishedRuns, &'a StudyFolder)>,
}

impl<'a> Runner<'a> {
    /// Prepares runs of a case, one at a time.
    ///
    /// # Errors
    /// The temporary folder for the results cannot be created.
    pub(crate) fn new(
        case: &'a Path,
        arguments: &'a StudyArguments,
        bench: Bench,
        quiet: bool,
    ) -> Result<Self, RunError> {
        Ok(Self {
            case,
            arguments,
            bench,
            quiet,
            scratch: Scratch::new()?,
            repeat: 1,
            jobs: 1,
            longest_run: f64::INFINITY,
            finished: None,
        })
    }

    /// Keeps finished runs in the folder of the study until it is complete, and reuses the ones
    /// already there unless the study is to be replaced.
    ///
    /// # Errors
    /// The folder holds runs of another case.
    pub(crate) fn keep_finished(
        mut self,
        none: FinishedRuns,
        folder: &'a StudyFolder,
    ) -> Result<Self, RunError> {
        let finished = match self.arguments.replace {
            true => none,
            false => none.resume(folder.path())?,
        };
        let count = finished.count();
        if count > 0 {
            tracing::warn!(
                "{count} runs of the interrupted study are reused; --replace repeats all{}",
                finished.unseen()
            );
        }
        self.finished = Some((finished, folder));
        Ok(self)
    }

    /// Removes the finished runs once the study is complete.
    pub(crate) fn complete(self) -> Result<(), RunError> {
        self.finished.map_or(Ok(()), |(_, folder)| FinishedRuns::remove(folder))
    }

    /// Performs the runs of these points and passes each to `take` when it ends: in order with one
    /// job, in order of completion with several.
    ///
    /// # Errors
    /// The user interrupted the study, the file system failed, or `take` returned an error.
    pub(crate) fn run(
        &mut self,
        points: &[Point],
        take: impl FnMut(usize, Attempt) -> Result<(), RunError>,
    ) -> Result<(), RunError> {
        let ended = match self.jobs.min(points.len()) {
            0 | 1 => self.one_by_one(points, take),
            jobs => self.side_by_side(points, jobs, take),
        };
        if let (Err(error), Some((finished, folder))) = (&ended, &self.finished)
            && error.is_interrupt()
            && finished.count() > 0
        {
            let (count, path) = (finished.count(), folder.path().display());
            tracing::warn!(
                "{count} finished runs are kept in {path}; the same command resumes with them"
            );
        }
        ended
    }

    fn one_by_one(
        &mut self,
        points: &[Point],
        mut take: impl FnMut(usize, Attempt) -> Result<(), RunError>,
    ) -> Result<(), RunError> {
        let mut steps = Steps::of_work(self.quiet, self.work(points)?);
        for (n, point) in points.iter().enumerate() {
            steps.step(&point.name);
            let attempt = match self.finished(point) {
                Some(known) => known,
                None => {
                    let maker = self.maker();
                    maker.make(&point.changes, self.scratch.path(), &mut self.bench)
                }
            };
            self.keep(point, &attempt)?;
            take_unless_ended(n, attempt, &mut take)?;
        }
        steps.finish();
        Ok(())
    }

    /// Performs several runs at a time, each on a thread with its own participants.
    fn side_by_side(
        &mut self,
        points: &[Point],
        jobs: usize,
        mut take: impl FnMut(usize, Attempt) -> Result<(), RunError>,
    ) -> Result<(), RunError> {
        let mut steps = Steps::new(self.quiet, points.len());
        let mut open = Vec::new();
        for (n, point) in points.iter().enumerate() {
            match self.finished(point) {
                Some(known) => take(n, known)?,
                None => open.push((n, point)),
            }
        }
        // Every job has participants of its own.
        self.bench.fleet.dismiss();
        let queue = Queue::new(&open);
        let scratch = self.scratch.path().to_owned();
        let (maker, cases) = (self.maker(), self.bench.cases().clone());
        let outcome = thread::scope(|scope| {
            let (send, receive) = mpsc::channel();
            for job in 0..jobs {
                let (send, maker, queue) = (send.clone(), &maker, &queue);
                let (folder, cases) = (scratch.join(job.to_string()), cases.clone());
                scope.spawn(move || {
                    let mut bench = Bench::with(cases, maker.arguments.fleet());
                    maker.work_off(queue, &mut bench, &folder, &send);
                });
            }
            drop(send);
            let mut outcome = Ok(());
            // After an interruption, results of the other threads are still collected.
            for (n, attempt) in receive {
                steps.step(&points[n].name);
                let taken = self
                    .keep(&points[n], &attempt)
                    .and_then(|()| take_unless_ended(n, attempt, &mut take));
                if let Err(error) = taken {
                    queue.stop();
                    outcome = outcome.and(Err(error));
                }
            }
            outcome
        });
        steps.finish();
        outcome
    }

    fn maker(&self) -> Maker<'a> {
        let Self { case, arguments, repeat, longest_run, .. } = *self;
        Maker { case, arguments, repeat, longest_run }
    }

    /// Expected work of the points \[s\], used for the progress display only. Points that are
    /// finished, skipped or cannot be planned count as zero. Many points count as equal, because
    /// each would have to be planned before the first one runs.
    ///
    /// # Errors
    /// The user interrupted the study.
    fn work(&mut self, points: &[Point]) -> Result<Vec<f64>, RunError> {
        if self.quiet || points.len() > MOST_PLANNED {
            return Ok(vec![1.0; points.len()]);
        }
        let expected = |point: &Point| {
            if self.finished(point).is_some() {
                return Ok(0.0);
            }
            match self.bench.planned(self.case, &point.changes) {
                Err(error) if ends_study(&error) => Err(error),
                planned => {
                    let made = planned.ok();
                    let made = made.filter(|one| expected_seconds(&one.plan) <= self.longest_run);
                    Ok(expected_run_seconds(made.as_ref()))
                }
            }
        };
        points.iter().map(expected).collect()
    }

    fn finished(&self, point: &Point) -> Option<Attempt> {
        let (finished, _) = self.finished.as_ref()?;
        let run = finished.run(&point.changes.options())?.clone();
        Some(Attempt { wall_s: run.spent.wall_s, outcome: Outcome::Finished(Box::new(run)) })
    }

    fn keep(&mut self, point: &Point, attempt: &Attempt) -> Result<(), RunError> {
        match (&mut self.finished, &attempt.outcome) {
            (Some((finished, folder)), Outcome::Finished(run)) => {
                finished.add(point.changes.options(), run, folder)
            }
            _ => Ok(()),
        }
    }
}

/// Passes an attempt to `take`, unless its error ends the whole study.
fn take_unless_ended(
    n: usize,
    attempt: Attempt,
    take: &mut impl FnMut(usize, Attempt) -> Result<(), RunError>,
) -> Result<(), RunError> {
    match attempt.outcome {
        Outcome::Failed(error) if error.is_interrupt() => Err(error),
        outcome => take(n, Attempt { outcome, ..attempt }),
    }
}

/// Points that wait for a thread.
struct Queue<'a> {
    open: &'a [(usize, &'a Point)],
    next: AtomicUsize,
    stopped: AtomicBool,
}

impl<'a> Queue<'a> {
    fn new(open: &'a [(usize, &'a Point)]) -> Self {
        Self { open, next: AtomicUsize::new(0), stopped: AtomicBool::new(false) }
    }

    /// Takes the next point with its number. `None` if none is left or the study has stopped.
    fn next(&self) -> Option<(usize, &'a Point)> {
        let place = || self.next.fetch_add(1, Ordering::Relaxed);
        (!self.stopped.load(Ordering::Relaxed)).then(place).and_then(|n| self.open.get(n).copied())
    }

    fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }
}

impl Maker<'_> {
    /// Performs runs until none is left or the study has stopped.
    fn work_off(
        &self,
        queue: &Queue<'_>,
        bench: &mut Bench,
        folder: &Path,
        send: &Sender<(usize, Attempt)>,
    ) {
        while let Some((n, point)) = queue.next() {
            if send.send((n, self.make(&point.changes, folder, bench))).is_err() {
                return;
            }
        }
    }

    /// Performs a run with its repetitions.
    fn make(&self, changes: &Changes, scratch: &Path, bench: &mut Bench) -> Attempt {
        let silent = changes.with("output.fields", "none");
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

    /// Only few points are planned for the progress display; each plan of a long table would delay
    /// the first run, and an interruption.
    #[test]
    fn a_long_table_is_not_planned_before_its_first_run() {
        let arguments = StudyArguments { out: None, replace: false, fresh: true };
        let mut runner =
            Runner::new(Path::new("absent.toml"), &arguments, arguments.bench(), false).unwrap();
        let point = Point { name: String::new(), changes: Changes::default() };
        // Points that cannot be planned have no work.
        assert_eq!(runner.work(&vec![point.clone(); 2]).unwrap(), [0.0; 2]);
        let many = MOST_PLANNED + 1;
        assert_eq!(runner.work(&vec![point; many]).unwrap(), vec![1.0; many]);
    }
}
