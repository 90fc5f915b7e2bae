//! The subject of a page: a result folder, its recording, or a recording alone.

use crate::index::{Index, Step, first_difference};
use crate::view::{self, Request, View, name};
use pages::page::{Page, RunStatus};
use pages::source::{Columns, Results};
use run::error::RunError;
use run::watching;
use serde::Serialize;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// Longest piece of work before another request is answered.
const SLICE: Duration = Duration::from_millis(50);
/// Time between two readings of the tables of a run that goes on.
const REREAD: Duration = Duration::from_millis(400);

/// State of the run or recording, as the script of the page receives it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct State {
    /// Number of completed steps in the recording.
    steps: usize,
    /// Names of the fields in the recording, each with the number of its series.
    pub(crate) fields: Vec<(usize, String)>,
    /// Whether the run goes on.
    live: bool,
    /// Part of the recording that was read \[-\].
    read: f64,
    /// Whether there is another recording to compare with.
    pub(crate) other: bool,
    /// Series and step of the first difference to the other recording, once it is known.
    difference: Option<(usize, usize)>,
    /// Number that changes when the report does.
    report: u64,
    /// Remark about the recording.
    remark: Option<String>,
}

/// A run or a recording.
pub(crate) struct Watched {
    /// Result folder.
    folder: Option<PathBuf>,
    index: Option<Index>,
    path: Option<PathBuf>,
    other: Option<Index>,
    /// Whether both indices are complete for now.
    idle: bool,
    page: Page,
    report: u64,
    /// When the tables were read, the newest change they had then, and whether the run went on.
    read: Option<(Instant, (Option<SystemTime>, bool))>,
    remark: Option<String>,
}

impl Watched {
    /// Opens a result folder or a recording, and perhaps another recording to compare with.
    ///
    /// # Errors
    /// There is neither, or it cannot be read.
    pub(crate) fn open(path: &Path, against: Option<&Path>) -> Result<Self, RunError> {
        if !path.exists() {
            return Err(RunError::Usage(format!(
                "there is neither a result directory nor a recording {}; `coordinator run CASE \
                 --record` writes both",
                path.display()
            )));
        }
        let (folder, recording) = match path.is_dir() {
            true => (Some(path.to_owned()), newest_recording(path)),
            false => (None, Some(path.to_owned())),
        };
        let other = against.map(|other| match other.is_dir() {
            true => newest_recording(other).unwrap_or_else(|| other.join("recording.mcap")),
            false => other.to_owned(),
        });
        if let (None, Some(_)) = (&recording, &other) {
            return Err(RunError::Usage(format!(
                "{} holds no recording to compare; `coordinator run CASE --record` writes one",
                path.display()
            )));
        }
        let index = recording.as_deref().map(Index::open).transpose()?;
        let other = other.as_deref().map(Index::open).transpose()?;
        let page = Page {
            name: String::new(),
            title: String::new(),
            status: String::new(),
            mood: RunStatus::Open,
            reason: String::new(),
            sections: Vec::new(),
        };
        let (path, idle, report, read, remark) = (recording, false, 0, None, None);
        let mut watched = Self { folder, index, path, other, idle, page, report, read, remark };
        watched.reread()?;
        Ok(watched)
    }

    /// Reads further, for a short time. Returns whether there is more to read now.
    ///
    /// # Errors
    /// A file cannot be read.
    pub(crate) fn advance(&mut self) -> Result<bool, RunError> {
        let until = Instant::now() + SLICE;
        let mut more = true;
        while more && Instant::now() < until {
            more = false;
            for index in self.index.iter_mut().chain(&mut self.other) {
                more |= match index.advance() {
                    Ok(more) => more,
                    Err(error) => {
                        self.remark.get_or_insert(error.to_string());
                        false
                    }
                };
            }
        }
        self.idle = !more;
        self.reread()?;
        Ok(more)
    }

    /// Tells the run that somebody looks, so that it writes its newest fields.
    pub(crate) fn look(&self) {
        if let Some(folder) = self.folder.as_ref().filter(|_| self.is_live()) {
            watching::look(folder);
        }
    }

    /// Returns whether the run goes on.
    fn is_live(&self) -> bool {
        match (&self.folder, &self.index) {
            (Some(folder), _) => {
                !folder.join("summary.json").is_file() && watching::is_running(folder)
            }
            (None, Some(index)) => !index.is_complete() && self.is_growing(),
            (None, None) => false,
        }
    }

    /// Returns whether the recording was written to in the last seconds.
    fn is_growing(&self) -> bool {
        let changed =
            self.path.as_deref().and_then(|path| fs::metadata(path).ok()?.modified().ok());
        let age = changed.and_then(|changed| changed.elapsed().ok());
        age.is_some_and(|age| age < Duration::from_secs(10))
    }

    /// Reads the tables of the folder again if they have changed, or makes them from the recording.
    fn reread(&mut self) -> Result<(), RunError> {
        let last = self.read.as_ref();
        if last.is_some_and(|(when, _)| when.elapsed() < REREAD) {
            return Ok(());
        }
        let changed = match &self.folder {
            Some(folder) => newest_change(folder),
            None => self.index.as_ref().map(|index| {
                SystemTime::UNIX_EPOCH + Duration::from_nanos(index.steps().len() as u64)
            }),
        };
        let live = self.is_live();
        if last.is_some_and(|(_, before)| *before == (changed, live)) {
            return Ok(());
        }
        self.reopen();
        self.page = match (&self.folder, &self.index) {
            (Some(folder), _) => pages::page(&Results::read(folder)?),
            (None, Some(index)) => of_recording(index),
            (None, None) => return Ok(()),
        };
        if live {
            self.page.status = "running".to_owned();
            self.page.reason = "the page shows what has been written so far".to_owned();
        }
        self.report += 1;
        self.read = Some((Instant::now(), (changed, live)));
        Ok(())
    }

    /// Opens the recording of the folder if a later run has written one.
    fn reopen(&mut self) {
        let Some(newest) = self.folder.as_deref().and_then(newest_recording) else { return };
        if self.index.as_ref().is_none_or(|index| !index.is_of(&newest)) {
            // A recording that has just begun has no head yet, and is opened at the next look.
            self.index = Index::open(&newest).ok();
            self.path = Some(newest);
        }
    }

    /// Returns the state.
    pub(crate) fn state(&self) -> State {
        let of = |index: &Index| -> Vec<(usize, String)> {
            let series = index.series().iter().enumerate().filter(|(_, one)| !one.is_geometry());
            series.map(|(number, one)| (number, name(one, index.bodies()))).collect()
        };
        let length = self.path.as_deref().and_then(|path| fs::metadata(path).ok());
        let length = length.map_or(0, |file| file.len()).max(1);
        let full = self.index.as_ref().is_some_and(Index::is_full);
        let full = full.then(|| "the recording has more samples than are shown".to_owned());
        State {
            steps: self.index.as_ref().map_or(0, |index| index.steps().len()),
            fields: self.index.as_ref().map(of).unwrap_or_default(),
            live: self.is_live(),
            read: match (&self.index, self.idle) {
                (Some(index), false) => index.bytes() as f64 / length as f64,
                _ => 1.0,
            },
            other: self.other.is_some(),
            difference: self.difference(),
            report: self.report,
            remark: self.remark.clone().or(full),
        }
    }

    /// Returns series and step of the first difference to the other recording.
    fn difference(&self) -> Option<(usize, usize)> {
        let (now, then) = (self.index.as_ref()?, self.other.as_ref()?);
        let (series, nanoseconds) = first_difference(now, then).filter(|_| self.idle)?;
        let step = now.steps().partition_point(|step| step.nanoseconds < nanoseconds);
        Some((series, step))
    }

    /// Draws a view.
    ///
    /// # Errors
    /// The recording is damaged.
    pub(crate) fn view(&mut self, request: Request) -> Result<View, RunError> {
        match &mut self.index {
            Some(index) => view::view(index, self.other.as_mut(), request),
            None => Ok(View { step: 0, caption: String::new(), html: String::new() }),
        }
    }

    /// Returns the completed steps.
    pub(crate) fn steps(&self) -> &[Step] {
        self.index.as_ref().map_or(&[], Index::steps)
    }

    /// Returns the page with the report.
    pub(crate) fn page(&self) -> &Page {
        &self.page
    }
}

/// Returns the page about a recording without a result folder.
fn of_recording(index: &Index) -> Page {
    let mut results = Results {
        iterations: Columns::parse(&index.table(0..index.steps().len())),
        case: index.text("case.toml"),
        ..Results::default()
    };
    results.summary = serde_json::json!({ "coupling": { "scheme": index.scheme() } });
    let mut page = pages::page(&results);
    page.name = index.case().to_owned();
    (page.status, page.mood, page.reason) = match index.end() {
        Some(None) => {
            ("recorded".to_owned(), RunStatus::Good, "the run reached its end".to_owned())
        }
        Some(Some(error)) => ("failed".to_owned(), RunStatus::Bad, error.to_owned()),
        None => {
            let reason = "the recording does not hold the end of the run".to_owned();
            ("no end".to_owned(), RunStatus::Open, reason)
        }
    };
    page
}

/// Returns the recording of a folder that was written last.
fn newest_recording(folder: &Path) -> Option<PathBuf> {
    let entries = fs::read_dir(folder).ok()?.flatten();
    let recordings = entries.filter(|entry| {
        let name = entry.file_name().to_string_lossy().into_owned();
        name.starts_with("recording") && name.ends_with(".mcap")
    });
    let dated = recordings
        .filter_map(|entry| Some((entry.metadata().ok()?.modified().ok()?, entry.path())));
    dated.max().map(|(_, path)| path)
}

/// Returns when a file was last changed that the report shows.
fn newest_change(folder: &Path) -> Option<SystemTime> {
    let files = ["summary.json", "iterations.csv", "history.csv", "log.jsonl", "fields/last.bin"];
    let changed = |name: &&str| fs::metadata(folder.join(name)).ok()?.modified().ok();
    files.iter().filter_map(changed).max()
}
