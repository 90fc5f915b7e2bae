//! The subject of a page: a result folder, its recording, or a recording alone.

use crate::index::{DifferenceSearch, Index, Step};
use crate::recording::WatchedRecording;
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
    /// Title of the page.
    title: String,
    /// Number of completed steps in the recording.
    steps: usize,
    /// Names of the fields in the recording, each with the number of its series.
    pub(crate) fields: Vec<(usize, String)>,
    /// Whether the run goes on.
    pub(crate) live: bool,
    /// Part of the recording that was read \[-\].
    read: f64,
    /// Whether there is another recording to compare with.
    pub(crate) other: bool,
    /// Series and step of the first difference to the other recording, once it is known.
    pub(crate) difference: Option<(usize, usize)>,
    /// Number that changes when another recording is read: everything drawn before is outdated.
    pub(crate) run: u64,
    /// Number that changes when the report does.
    report: u64,
    /// Remark about the recording.
    pub(crate) remark: Option<String>,
}

/// Everything by which a change of the tables is noticed: the newest change of a file or, without a
/// result folder, the length that was read; whether the run goes on; the recording that is read.
type Version = (Option<SystemTime>, u64, bool, u64);

/// A run or a recording.
pub(crate) struct Watched {
    /// Result folder.
    folder: Option<PathBuf>,
    recording: WatchedRecording,
    other: Option<WatchedRecording>,
    search: DifferenceSearch,
    /// Series and time \[ns\] of the first difference.
    difference: Option<(usize, u64)>,
    /// Whether both recordings are read as far as they are written.
    idle: bool,
    page: Page,
    report: u64,
    /// When the tables were looked at, and their version then.
    read: Option<(Instant, Version)>,
    /// Reason why the tables cannot be read.
    trouble: Option<String>,
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
        let recording = WatchedRecording::open(path)?;
        let other = against.map(WatchedRecording::open).transpose()?;
        let compared = [Some((path, &recording)), against.zip(other.as_ref())];
        for (path, recording) in compared.into_iter().flatten().filter(|_| other.is_some()) {
            if recording.index().is_none() {
                let why = recording.remark().map_or_else(String::new, |why| format!(": {why}"));
                return Err(RunError::Usage(format!(
                    "{} holds no recording to compare{why}; `coordinator run CASE --record` \
                     writes one",
                    path.display()
                )));
            }
        }
        let page = Page {
            name: String::new(),
            title: String::new(),
            status: String::new(),
            mood: RunStatus::Open,
            reason: String::new(),
            sections: Vec::new(),
        };
        let mut watched = Self {
            folder: path.is_dir().then(|| path.to_owned()),
            recording,
            other,
            search: DifferenceSearch::default(),
            difference: None,
            idle: false,
            page,
            report: 0,
            read: None,
            trouble: None,
        };
        watched.reread()?;
        Ok(watched)
    }

    /// Reads further, for a short time. Returns whether there is more to read now.
    pub(crate) fn advance(&mut self) -> bool {
        let until = Instant::now() + SLICE;
        let mut more = true;
        while more && Instant::now() < until {
            more = false;
            for recording in std::iter::once(&mut self.recording).chain(&mut self.other) {
                more |= recording.advance();
            }
        }
        self.idle = !more;
        if self.idle {
            self.search();
        }
        if self.read.as_ref().is_none_or(|(when, _)| when.elapsed() >= REREAD) {
            self.refresh();
        }
        more
    }

    /// Reads everything that is written by now, tables included.
    pub(crate) fn read_all(&mut self) {
        loop {
            while self.advance() {}
            self.refresh();
            if self.idle {
                break;
            }
        }
    }

    /// Tells the run that somebody looks, so that it writes its newest fields.
    pub(crate) fn look(&self) {
        if let Some(folder) = self.folder.as_ref().filter(|_| self.is_live()) {
            watching::look(folder);
        }
    }

    /// Returns whether the run goes on.
    fn is_live(&self) -> bool {
        match &self.folder {
            Some(folder) => !folder.join("summary.json").is_file() && watching::is_running(folder),
            None => self.recording.is_growing(),
        }
    }

    /// Notices another recording and changed tables. A failure is a remark on the page.
    fn refresh(&mut self) {
        let before = self.run();
        self.recording.follow();
        if let Some(other) = &mut self.other {
            other.follow();
        }
        if self.run() != before {
            (self.search, self.difference, self.idle) = (DifferenceSearch::default(), None, false);
        }
        self.trouble = self.reread().err().map(|error| error.to_string());
    }

    /// Reads the tables of the folder again if they have changed, or makes them from the recording.
    fn reread(&mut self) -> Result<(), RunError> {
        let live = self.is_live();
        let (changed, bytes) = match &self.folder {
            Some(folder) => (newest_change(folder), 0),
            None => (None, self.recording.index().map_or(0, Index::bytes)),
        };
        let version = (changed, bytes, live, self.run());
        let last = self.read.replace((Instant::now(), version));
        if last.is_some_and(|(_, before)| before == version) && self.trouble.is_none() {
            return Ok(());
        }
        self.page = match (&self.folder, self.recording.index()) {
            (Some(folder), _) => pages::page(&Results::read(folder)?),
            (None, Some(index)) => of_recording(index),
            (None, None) => return Ok(()),
        };
        if live {
            self.page.status = "running".to_owned();
            self.page.reason = "the page shows what has been written so far".to_owned();
        }
        self.report += 1;
        Ok(())
    }

    /// Returns a number that changes when another recording is read.
    fn run(&self) -> u64 {
        let all = std::iter::once(&self.recording).chain(&self.other);
        all.map(WatchedRecording::changes).sum()
    }

    /// Returns the state.
    pub(crate) fn state(&self) -> State {
        let fields = |index: &Index| -> Vec<(usize, String)> {
            let series = index.series().iter().enumerate().filter(|(_, one)| !one.is_geometry());
            series.map(|(number, one)| (number, name(one, index.bodies()))).collect()
        };
        let (index, live) = (self.recording.index(), self.is_live());
        // The head of a recording that has just begun is not written yet.
        let own = self.recording.remark().filter(|_| index.is_some() || !live);
        let other = self.other.as_ref().and_then(WatchedRecording::remark);
        State {
            title: self.page.window_title(),
            steps: index.map_or(0, |index| index.steps().len()),
            fields: index.map(fields).unwrap_or_default(),
            live,
            read: if self.idle { 1.0 } else { self.recording.part_read() },
            other: self.other.is_some(),
            difference: self.difference_at(),
            run: self.run(),
            report: self.report,
            remark: own.or_else(|| self.trouble.clone()).or(other),
        }
    }

    /// Searches the first difference to the other recording.
    fn search(&mut self) {
        let then = self.other.as_mut().and_then(WatchedRecording::index_mut);
        let (Some(now), Some(then)) = (self.recording.index(), then) else { return };
        self.difference = self.search.first(now, then);
    }

    /// Returns series and step of the first difference to the other recording.
    fn difference_at(&self) -> Option<(usize, usize)> {
        let (series, nanoseconds) = self.difference.filter(|_| self.idle)?;
        let step = self.steps().partition_point(|step| step.nanoseconds < nanoseconds);
        Some((series, step))
    }

    /// Draws a view.
    ///
    /// # Errors
    /// The recording is damaged.
    pub(crate) fn view(&mut self, request: Request) -> Result<View, RunError> {
        let run = self.run();
        let other = self.other.as_mut().and_then(WatchedRecording::index_mut);
        match self.recording.index_mut() {
            Some(index) => Ok(View { run, ..view::view(index, other, request)? }),
            None => Ok(View { run, ..View::default() }),
        }
    }

    /// Returns the completed steps.
    pub(crate) fn steps(&self) -> &[Step] {
        self.recording.index().map_or(&[], Index::steps)
    }

    /// Returns the page with the report.
    pub(crate) fn page(&self) -> &Page {
        &self.page
    }
}

/// Returns the page about a recording without a result folder.
fn of_recording(index: &Index) -> Page {
    let results = Results {
        scheme: index.scheme().to_owned(),
        iterations: Columns::parse(&index.table(0..index.steps().len())),
        case: index.text("case.toml"),
        ..Results::default()
    };
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

/// Returns when a file was last changed that the report shows.
fn newest_change(folder: &Path) -> Option<SystemTime> {
    let files = ["summary.json", "iterations.csv", "history.csv", "log.jsonl", "fields/last.bin"];
    let changed = |name: &&str| fs::metadata(folder.join(name)).ok()?.modified().ok();
    files.iter().filter_map(changed).max()
}
