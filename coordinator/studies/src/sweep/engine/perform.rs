//! Runs the points of a sweep through a scheduler and collects them. Incomplete parts are submitted
//! again.

use super::super::collect;
use super::super::rows::SweepInProgress;
use super::hyperqueue::HyperQueue;
use super::options::{EngineArguments, Name};
use super::scheduler::{ArrayStatus, Scheduler};
use super::slurm::Slurm;
use super::tasks::{PARTS, Tasks};
use crate::study::folder::{MOST_BYTES, StudyFolder};
use console::output::print;
use console::steps::Steps;
use contract::input_file;
use run::error::{Failure, RunError, file_failure};
use run::format::counted;
use run::signals;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::path::PathBuf;
use std::thread::sleep;
use std::time::{Duration, Instant};
use std::{fs, io};

/// The current array.
#[derive(Debug, Serialize, Deserialize)]
struct Array {
    engine: String,
    id: String,
    /// Number of parts of the sweep; the array may hold fewer.
    parts: usize,
}

const ARRAY: &str = "array.json";
/// Shortest and longest interval between two queries of an array. Queries are frequent at first.
const LOOKS: [Duration; 2] = [Duration::from_secs(1), Duration::from_secs(15)];
/// Time without an answer after which a scheduler counts as lost.
const SILENT: Duration = Duration::from_secs(600);
/// Time allowed for a cancelled task to end.
const ENDING: Duration = Duration::from_secs(60);
/// Number of missing points that a message lists.
const NAMED: usize = 8;

impl Name {
    fn scheduler(self) -> Option<&'static dyn Scheduler> {
        match self {
            Self::Slurm => Some(&Slurm),
            Self::Hyperqueue => Some(&HyperQueue),
            Self::Local | Self::List => None,
        }
    }
}

/// Removes the array and the parts of an earlier sweep.
///
/// # Errors
/// The files cannot be removed.
pub(in super::super) fn clear(folder: &StudyFolder) -> Result<(), RunError> {
    folder.remove(ARRAY)?;
    let parts = folder.open()?.join(PARTS);
    match fs::remove_dir_all(&parts) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(file_failure(&parts, &error)),
        _ => Ok(()),
    }
}

/// Lists the folders of all parts that tasks have begun, whatever the number of parts.
///
/// # Errors
/// The folder of the parts cannot be read.
pub(in super::super) fn parts(folder: &StudyFolder) -> Result<Vec<PathBuf>, RunError> {
    let place = folder.open()?.join(PARTS);
    if !place.exists() {
        return Ok(Vec::new());
    }
    let entries = fs::read_dir(&place).and_then(Iterator::collect::<io::Result<Vec<_>>>);
    let entries = entries.map_err(|error| file_failure(&place, &error))?;
    let mut all: Vec<PathBuf> = entries.iter().map(fs::DirEntry::path).collect();
    all.sort();
    Ok(all)
}

/// Checks that a resumed sweep has no active array of another engine, which would run its points
/// twice.
///
/// # Errors
/// There is such an array. The error names the array and the engine.
pub(in super::super) fn refuse_other(folder: &StudyFolder, engine: Name) -> Result<(), RunError> {
    match under_way(folder)
        .filter(|array| engine.scheduler().is_none_or(|one| one.name() != array.engine))
    {
        None => Ok(()),
        Some(Array { engine, id, .. }) => Err(RunError::Usage(format!(
            "array {id} of {engine} may run points of this sweep: wait for it with --engine {engine}, or cancel it \
             and remove {}",
            folder.path().join(ARRAY).display()
        ))),
    }
}

/// Number of parts of the interrupted sweep in this folder.
pub(in super::super) fn parts_under_way(folder: &StudyFolder) -> Option<usize> {
    under_way(folder).map(|array| array.parts)
}

fn under_way(folder: &StudyFolder) -> Option<Array> {
    let text = input_file::read(&folder.path().join(ARRAY), MOST_BYTES).ok()?;
    serde_json::from_slice(&text).ok()
}

/// Prints the commands of the incomplete parts.
///
/// # Errors
/// The files cannot be written, or standard output fails.
pub(in super::super) fn list(sweep: &SweepInProgress, tasks: &Tasks) -> Result<(), RunError> {
    tasks.write()?;
    collect::hand_out(&sweep.study, tasks.parts, |part| tasks.folder(part))?;
    let missing = tasks.missing(&sweep.study);
    let lines: Vec<String> = missing.iter().map(|part| tasks.command(*part) + "\n").collect();
    print(&lines.concat())
}

/// Runs every missing point through a scheduler and collects the results.
///
/// # Errors
/// The scheduler fails, points are still missing after all retries, the user interrupts, or the
/// file system fails.
pub(in super::super) fn fill(
    sweep: &mut SweepInProgress,
    tasks: &Tasks,
    asked: &EngineArguments,
    folder: &StudyFolder,
    quiet: bool,
) -> Result<(), RunError> {
    let Some(scheduler) = asked.engine.scheduler() else { return Ok(()) };
    let options = asked.engine_options.as_deref().map_or(Some(Vec::new()), shlex::split);
    let options = options.ok_or_else(|| {
        RunError::Usage("--engine-options contains an unclosed quotation mark".to_owned())
    })?;
    let hours = Duration::from_secs_f64(asked.deadline.clamp(0.0, 1e6) * 3600.0);
    let way = ArrayMonitor { scheduler, tasks, folder, until: Instant::now() + hours, quiet };
    if let Some(array) = under_way(folder).filter(|array| array.engine == scheduler.name()) {
        way.follow(sweep, &array.id)?;
    }
    for _ in 0..=asked.retries {
        let missing = tasks.missing(&sweep.study);
        if missing.is_empty() {
            return Ok(());
        }
        tasks.write()?;
        collect::hand_out(&sweep.study, tasks.parts, |part| tasks.folder(part))?;
        let id = scheduler.submit(tasks, &missing, &options);
        // Tasks that were never submitted have no logs.
        let id = id.map_err(|what| way.failure_with(what, scheduler.fix()))?;
        let array = Array { engine: scheduler.name().to_owned(), id, parts: tasks.parts };
        folder.write(ARRAY, contract::text::json(&array).as_bytes())?;
        way.follow(sweep, &array.id)?;
    }
    missing_points(sweep, tasks).map_or(Ok(()), |text| Err(way.failure(text)))
}

/// Context for following an array.
struct ArrayMonitor<'a> {
    scheduler: &'static dyn Scheduler,
    tasks: &'a Tasks,
    folder: &'a StudyFolder,
    /// Time at which to give up.
    until: Instant,
    quiet: bool,
}

/// Reason to stop waiting for an array.
enum WaitError {
    /// The user interrupted; the array is cancelled.
    Stopped(RunError),
    /// The deadline has passed; the array is cancelled.
    Late(String),
    /// The scheduler no longer answers, and the state of the array is unknown.
    Lost(String),
}

impl ArrayMonitor<'_> {
    /// Waits for the end of an array and collects its results, however the array ends.
    fn follow(&self, sweep: &mut SweepInProgress, array: &str) -> Result<(), RunError> {
        let missing = self.tasks.missing(&sweep.study);
        let mut steps = Steps::new(self.quiet, missing.len());
        let ended = self.wait(array, missing.len(), &mut steps);
        steps.finish();
        if !matches!(ended, Err(WaitError::Lost(_))) {
            self.folder.remove(ARRAY)?;
        }
        missing.iter().try_for_each(|part| collect::part(sweep, &self.tasks.folder(*part)))?;
        match ended {
            Err(WaitError::Stopped(error)) => return Err(error),
            Err(WaitError::Late(what) | WaitError::Lost(what)) => return Err(self.failure(what)),
            Ok(()) => {}
        }
        if let Some(text) = missing_points(sweep, self.tasks) {
            tracing::warn!("{text}");
        }
        Ok(())
    }

    /// Waits until an array has ended.
    fn wait(&self, array: &str, total: usize, steps: &mut Steps) -> Result<(), WaitError> {
        let name = self.scheduler.name();
        let (mut heard, mut pause) = (Instant::now(), LOOKS[0]);
        loop {
            match self.scheduler.look(array) {
                Ok(ArrayStatus { waiting: 0, running: 0, .. }) => return Ok(()),
                Ok(look) => {
                    heard = Instant::now();
                    let ended = total.saturating_sub(look.waiting + look.running);
                    steps.reach(ended + 1, &look.told(name, array));
                }
                Err(why) if heard.elapsed() > SILENT => {
                    return Err(WaitError::Lost(format!(
                        "{why}; array {array} may still be running"
                    )));
                }
                Err(why) => tracing::warn!("{name}: {why}; asking again"),
            }
            if let Some(signal) = rest(pause) {
                self.end(array);
                let when =
                    format!("while array {array} of {name} was running; the array is cancelled");
                return Err(WaitError::Stopped(RunError::Interrupted { signal, when }));
            }
            if Instant::now() > self.until {
                self.end(array);
                let what = format!("array {array} has passed --deadline and is cancelled");
                return Err(WaitError::Late(what));
            }
            pause = (pause * 5 / 4).min(LOOKS[1]);
        }
    }

    /// Cancels an array and waits until its tasks have ended and kept their results.
    fn end(&self, array: &str) {
        if let Err(why) = self.scheduler.cancel(array) {
            tracing::warn!(
                "{}: array {array} could not be cancelled: {why}",
                self.scheduler.name()
            );
            return;
        }
        let until = Instant::now() + ENDING;
        let gone = |look: ArrayStatus| look == ArrayStatus::default();
        while Instant::now() < until && !self.scheduler.look(array).is_ok_and(gone) {
            sleep(LOOKS[0]);
        }
    }

    fn failure(&self, what: String) -> RunError {
        self.failure_with(what, &format!("see {}", self.tasks.logs()))
    }

    fn failure_with(&self, what: String, fix: &str) -> RunError {
        RunError::Failed(Failure {
            who: self.scheduler.name().to_owned(),
            when: "in a sweep".to_owned(),
            what,
            fix: format!("{fix}; the same command resumes with the missing points"),
        })
    }
}

/// Waits for the given time, and returns early with the name of a signal.
fn rest(pause: Duration) -> Option<&'static str> {
    let until = Instant::now() + pause;
    while signals::received().is_none() && Instant::now() < until {
        sleep(Duration::from_millis(20));
    }
    signals::received()
}

/// Lists the missing points and their parts.
fn missing_points(sweep: &SweepInProgress, tasks: &Tasks) -> Option<String> {
    let missing = sweep.study.missing();
    let mut text = format!("{} missing:", counted(missing.len() as u64, "point"));
    for number in missing.iter().take(NAMED) {
        let values = sweep.study.told(&sweep.study.point(*number));
        let _ = write!(text, " {values} (part {});", tasks.part_of(*number));
    }
    text.pop();
    let more = missing.len().saturating_sub(NAMED);
    text += &if more > 0 { format!(" and {more} more") } else { String::new() };
    (!missing.is_empty()).then_some(text)
}
