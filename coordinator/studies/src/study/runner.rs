//! The runner of studies: performs the runs of a list of points, several at a time. Runs that
//! finished before an interruption are not repeated.

use super::arguments::StudyArguments;
use super::bench::Bench;
use super::finished::{FinishedRuns, Run};
use super::folder::StudyFolder;
use console::case_arguments::Changes;
use console::steps::Steps;
use run::error::RunError;
use run::scratch::Scratch;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Sender};
use std::thread;

/// A run to perform.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// Name on the screen.
    pub(crate) name: String,
    /// Changes of the case.
    pub(crate) changes: Changes,
}

/// Outcome of a run.
pub(crate) enum Outcome<R = Run> {
    /// The run finished.
    Finished(Box<R>),
    /// The run was skipped for this reason.
    LeftOut(String),
    /// The run failed.
    Failed(RunError),
}

/// A run with all its repetitions.
pub(crate) struct Attempt<R = Run> {
    /// Outcome of the run.
    pub(crate) outcome: Outcome<R>,
    /// Shortest wall-clock time of all repetitions \[s\]; 0 for a run before an interruption.
    pub(crate) wall_s: f64,
}

impl<R> Attempt<R> {
    /// Returns the result of a run of a study that has no use for other outcomes.
    ///
    /// # Errors
    /// The run failed or was skipped.
    pub(crate) fn made(self) -> Result<R, RunError> {
        match self.outcome {
            Outcome::Finished(made) => Ok(*made),
            Outcome::LeftOut(why) => Err(RunError::Usage(why)),
            Outcome::Failed(error) => Err(error),
        }
    }
}

/// Performs the single runs of a study. A point is given with its number.
pub(crate) trait Maker: Sync {
    /// Result of a run that has finished.
    type Made: Clone + Send + Serialize + DeserializeOwned;

    /// Returns the words that distinguish a run from all others of the study.
    fn key(&self, point: &Point) -> Vec<String> {
        point.changes.options()
    }

    /// Returns the expected work of each point in any unit, for the progress display only.
    ///
    /// # Errors
    /// The user interrupted the study.
    fn work(&self, points: &[(usize, &Point)], bench: &mut Bench) -> Result<Vec<f64>, RunError>;

    /// Performs a run. `scratch` is a folder for results that are not kept.
    fn make(
        &self,
        point: (usize, &Point),
        bench: &mut Bench,
        scratch: &Path,
    ) -> Attempt<Self::Made>;
}

/// Performs the runs of a study.
pub(crate) struct Runner<'a, M: Maker> {
    /// Performs the single runs.
    pub(crate) maker: M,
    arguments: &'a StudyArguments,
    /// Participants of runs that are performed one by one.
    pub(crate) bench: Bench,
    quiet: bool,
    scratch: Scratch,
    /// Number of runs at a time.
    pub(crate) jobs: usize,
    /// Finished runs and their folder, for a study that can be resumed.
    finished: Option<(FinishedRuns<M::Made>, &'a StudyFolder)>,
}

impl<'a, M: Maker> Runner<'a, M> {
    /// Prepares runs, one at a time.
    ///
    /// # Errors
    /// The temporary folder for the results cannot be created.
    pub(crate) fn new(
        maker: M,
        arguments: &'a StudyArguments,
        bench: Bench,
        quiet: bool,
    ) -> Result<Self, RunError> {
        let scratch = Scratch::new()?;
        Ok(Self { maker, arguments, bench, quiet, scratch, jobs: 1, finished: None })
    }

    /// Keeps finished runs in the folder of the study until it is complete, and reuses the ones
    /// already there unless the study is to be replaced.
    ///
    /// # Errors
    /// The folder holds runs of another case.
    pub(crate) fn keep_finished(
        mut self,
        none: FinishedRuns<M::Made>,
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
        self.finished.map_or(Ok(()), |(_, folder)| FinishedRuns::<M::Made>::remove(folder))
    }

    /// Performs the runs of these points and passes each to `take` when it ends: in order with one
    /// job, in order of completion with several.
    ///
    /// # Errors
    /// The user interrupted the study, the file system failed, or `take` returned an error.
    pub(crate) fn run(
        &mut self,
        points: &[Point],
        take: impl FnMut(usize, Attempt<M::Made>) -> Result<(), RunError>,
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
        mut take: impl FnMut(usize, Attempt<M::Made>) -> Result<(), RunError>,
    ) -> Result<(), RunError> {
        let mut steps = Steps::of_work(self.quiet, self.work(points)?);
        for (n, point) in points.iter().enumerate() {
            steps.step(&point.name);
            let attempt = match self.finished(point) {
                Some(known) => known,
                None => self.maker.make((n, point), &mut self.bench, self.scratch.path()),
            };
            keep(self.finished.as_mut(), self.maker.key(point), &attempt)?;
            steps.aside(|| take_unless_ended(n, attempt, &mut take))?;
        }
        steps.finish();
        Ok(())
    }

    /// Performs several runs at a time, each on a thread with its own participants.
    fn side_by_side(
        &mut self,
        points: &[Point],
        jobs: usize,
        mut take: impl FnMut(usize, Attempt<M::Made>) -> Result<(), RunError>,
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
        let Self { maker, arguments, bench, scratch, finished, .. } = self;
        let (maker, cases) = (&*maker, bench.cases().clone());
        let outcome = thread::scope(|scope| {
            let (send, receive) = mpsc::channel();
            for job in 0..jobs {
                let (send, queue, fleet) = (send.clone(), &queue, &*arguments);
                let (folder, cases) = (scratch.path().join(job.to_string()), cases.clone());
                scope.spawn(move || {
                    let mut bench = Bench::with(cases, fleet.fleet());
                    work_off(queue, maker, &mut bench, &folder, &send);
                });
            }
            drop(send);
            let mut outcome = Ok(());
            // After an interruption, results of the other threads are still collected.
            for (n, attempt) in receive {
                steps.step(&points[n].name);
                let taken = keep(finished.as_mut(), maker.key(&points[n]), &attempt)
                    .and_then(|()| steps.aside(|| take_unless_ended(n, attempt, &mut take)));
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

    /// Expected work of the points, used for the progress display only. Finished points have none.
    ///
    /// # Errors
    /// The user interrupted the study.
    fn work(&mut self, points: &[Point]) -> Result<Vec<f64>, RunError> {
        if self.quiet {
            return Ok(vec![1.0; points.len()]);
        }
        let open = |(_, point): &(usize, &Point)| self.finished(point).is_none();
        let open: Vec<_> = points.iter().enumerate().filter(open).collect();
        let expected = self.maker.work(&open, &mut self.bench)?;
        let mut work = vec![0.0; points.len()];
        for ((n, _), expected) in open.into_iter().zip(expected) {
            work[n] = expected;
        }
        Ok(work)
    }

    fn finished(&self, point: &Point) -> Option<Attempt<M::Made>> {
        let (finished, _) = self.finished.as_ref()?;
        let made = finished.run(&self.maker.key(point))?.clone();
        Some(Attempt { wall_s: 0.0, outcome: Outcome::Finished(Box::new(made)) })
    }
}

/// Adds a run that has finished to the finished runs.
fn keep<R: Clone + Serialize + DeserializeOwned>(
    finished: Option<&mut (FinishedRuns<R>, &StudyFolder)>,
    key: Vec<String>,
    attempt: &Attempt<R>,
) -> Result<(), RunError> {
    match (finished, &attempt.outcome) {
        (Some((finished, folder)), Outcome::Finished(run)) => finished.add(key, run, folder),
        _ => Ok(()),
    }
}

/// Passes an attempt to `take`, unless its error ends the whole study.
fn take_unless_ended<R>(
    n: usize,
    attempt: Attempt<R>,
    take: &mut impl FnMut(usize, Attempt<R>) -> Result<(), RunError>,
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

/// Performs runs until none is left or the study has stopped.
fn work_off<M: Maker>(
    queue: &Queue<'_>,
    maker: &M,
    bench: &mut Bench,
    folder: &Path,
    send: &Sender<(usize, Attempt<M::Made>)>,
) {
    while let Some((n, point)) = queue.next() {
        if send.send((n, maker.make((n, point), bench, folder))).is_err() {
            return;
        }
    }
}
