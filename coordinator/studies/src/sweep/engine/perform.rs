//! The points of a sweep, run by a scheduler and collected; what does not come back is submitted again.

use super::super::collect;
use super::super::rows::Growing;
use super::hyperqueue::HyperQueue;
use super::options::{Asked, Name};
use super::scheduler::{Look, Scheduler};
use super::slurm::Slurm;
use super::tasks::{PARTS, Tasks};
use crate::study::folder::StudyFolder;
use console::output::print;
use console::steps::Steps;
use run::error::{Failure, RunError, file_failure};
use run::format::counted;
use run::signals;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::path::PathBuf;
use std::thread::sleep;
use std::time::{Duration, Instant};
use std::{fs, io};

/// The array that is under way.
#[derive(Debug, Serialize, Deserialize)]
struct Array {
    engine: String,
    id: String,
    /// Parts of the sweep, of which the array has some.
    parts: usize,
}

/// Name of its file.
const ARRAY: &str = "array.json";
/// From one look at an array to the next: soon at first, then at leisure.
const LOOKS: [Duration; 2] = [Duration::from_secs(1), Duration::from_secs(15)];
/// A scheduler that does not answer for so long has gone.
const SILENT: Duration = Duration::from_secs(600);
/// A task that is cancelled ends in this time.
const ENDING: Duration = Duration::from_secs(60);
/// Points that are named when they are missing.
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

/// Removes what an earlier sweep has left.
///
/// # Errors
/// The file system.
pub(in super::super) fn clear(folder: &StudyFolder) -> Result<(), RunError> {
    folder.remove(ARRAY)?;
    let parts = folder.open()?.join(PARTS);
    match fs::remove_dir_all(&parts) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(file_failure(&parts, &error)),
        _ => Ok(()),
    }
}

/// The folders of parts that tasks have begun, of any number of parts.
///
/// # Errors
/// The file system.
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

/// The sweep that goes on has no array of another engine under way.
///
/// # Errors
/// It has, and its points would be run twice.
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

/// How many parts the stopped sweep in this folder has been cut into.
pub(in super::super) fn parts_under_way(folder: &StudyFolder) -> Option<usize> {
    under_way(folder).map(|array| array.parts)
}

fn under_way(folder: &StudyFolder) -> Option<Array> {
    let text = fs::read(folder.path().join(ARRAY)).ok()?;
    serde_json::from_slice(&text).ok()
}

/// Prints the commands of the parts that are missing.
///
/// # Errors
/// The file system, or standard output.
pub(in super::super) fn list(sweep: &Growing, tasks: &Tasks) -> Result<(), RunError> {
    tasks.write()?;
    collect::hand_out(&sweep.study, tasks.parts, |part| tasks.folder(part))?;
    let missing = tasks.missing(&sweep.study);
    let lines: Vec<String> = missing.iter().map(|part| tasks.command(*part) + "\n").collect();
    print(&lines.concat())
}

/// Has every point that a sweep lacks run by a scheduler, and collects them.
///
/// # Errors
/// The scheduler, points that are missing still, the user has stopped it, the file system.
pub(in super::super) fn fill(
    sweep: &mut Growing,
    tasks: &Tasks,
    asked: &Asked,
    folder: &StudyFolder,
    quiet: bool,
) -> Result<(), RunError> {
    let Some(scheduler) = asked.engine.scheduler() else { return Ok(()) };
    let options = asked.engine_options.as_deref().map_or(Some(Vec::new()), shlex::split);
    let options = options.ok_or_else(|| {
        RunError::Usage("--engine-options has a quote that is not closed".to_owned())
    })?;
    let hours = Duration::from_secs_f64(asked.deadline.clamp(0.0, 1e6) * 3600.0);
    let way = Way { scheduler, tasks, folder, until: Instant::now() + hours, quiet };
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
        let id = id.map_err(|what| way.failure(what))?;
        let array = Array { engine: scheduler.name().to_owned(), id, parts: tasks.parts };
        folder.write(ARRAY, contract::text::json(&array).as_bytes())?;
        way.follow(sweep, &array.id)?;
    }
    missing_points(sweep, tasks).map_or(Ok(()), |text| Err(way.failure(text)))
}

/// How arrays are followed.
struct Way<'a> {
    scheduler: &'static dyn Scheduler,
    tasks: &'a Tasks,
    folder: &'a StudyFolder,
    /// When one gives up.
    until: Instant,
    quiet: bool,
}

/// Why an array is not waited for any longer.
enum Halt {
    /// The user has stopped it; it is cancelled.
    Stopped(RunError),
    /// It has taken too long, and is cancelled.
    Late(String),
    /// Nobody knows what has become of it.
    Lost(String),
}

impl Way<'_> {
    /// Waits for the end of an array, and collects what it has found, whatever the end is.
    fn follow(&self, sweep: &mut Growing, array: &str) -> Result<(), RunError> {
        let missing = self.tasks.missing(&sweep.study);
        let mut steps = Steps::new(self.quiet, missing.len());
        let ended = self.wait(array, missing.len(), &mut steps);
        steps.finish();
        if !matches!(ended, Err(Halt::Lost(_))) {
            self.folder.remove(ARRAY)?;
        }
        missing.iter().try_for_each(|part| collect::part(sweep, &self.tasks.folder(*part)))?;
        match ended {
            Err(Halt::Stopped(error)) => return Err(error),
            Err(Halt::Late(what) | Halt::Lost(what)) => return Err(self.failure(what)),
            Ok(()) => {}
        }
        if let Some(text) = missing_points(sweep, self.tasks) {
            tracing::warn!("{text}");
        }
        Ok(())
    }

    /// Waits until an array has ended.
    fn wait(&self, array: &str, total: usize, steps: &mut Steps) -> Result<(), Halt> {
        let name = self.scheduler.name();
        let (mut heard, mut pause) = (Instant::now(), LOOKS[0]);
        loop {
            match self.scheduler.look(array) {
                Ok(Look { waiting: 0, running: 0, .. }) => return Ok(()),
                Ok(look) => {
                    heard = Instant::now();
                    let ended = total.saturating_sub(look.waiting + look.running);
                    steps.reach(ended + 1, &look.told(name, array));
                }
                Err(why) if heard.elapsed() > SILENT => {
                    return Err(Halt::Lost(format!("{why}; array {array} may still be under way")));
                }
                Err(why) => tracing::warn!("{name}: {why}; asked again"),
            }
            if let Some(signal) = rest(pause) {
                self.end(array);
                let when = format!("while array {array} of {name} went on, which is cancelled");
                return Err(Halt::Stopped(RunError::Interrupted { signal, when }));
            }
            if Instant::now() > self.until {
                self.end(array);
                let what = format!("array {array} has passed --deadline and is cancelled");
                return Err(Halt::Late(what));
            }
            pause = (pause * 5 / 4).min(LOOKS[1]);
        }
    }

    /// Cancels an array, and waits until its tasks have ended with what they have found.
    fn end(&self, array: &str) {
        if let Err(why) = self.scheduler.cancel(array) {
            tracing::warn!("{}: array {array} is not cancelled: {why}", self.scheduler.name());
            return;
        }
        let until = Instant::now() + ENDING;
        let gone = |look: Look| look == Look::default();
        while Instant::now() < until && !self.scheduler.look(array).is_ok_and(gone) {
            sleep(LOOKS[0]);
        }
    }

    fn failure(&self, what: String) -> RunError {
        let logs = self.tasks.logs();
        RunError::Failed(Failure {
            who: self.scheduler.name().to_owned(),
            when: "in a sweep".to_owned(),
            what,
            fix: format!("see {logs}; the same command goes on with what is missing"),
        })
    }
}

/// Waits for so long; the signal that ends it.
fn rest(pause: Duration) -> Option<&'static str> {
    let until = Instant::now() + pause;
    while signals::received().is_none() && Instant::now() < until {
        sleep(Duration::from_millis(20));
    }
    signals::received()
}

/// The points that are missing, with their parts.
fn missing_points(sweep: &Growing, tasks: &Tasks) -> Option<String> {
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
