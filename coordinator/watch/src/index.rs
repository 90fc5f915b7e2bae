//! Index of a recording: the steps of the run, and the place of every sample, so that each of them
//! is read in milliseconds. The recording may still grow.
//!
//! The first pass reads the chunks in order and notes, for each sample, its chunk and time and its
//! smallest and largest value. A sample is read again by going to its chunk.

use conformance::recording_file::{self, FileRecording, failed};
use contract::bodies::Bodies;
use contract::configuration::Configuration;
use contract::field::{FieldKind, GEOMETRY};
use contract::grid::Grid;
use contract::input_file;
use contract::message::{CommandKind, FieldHeader};
use proto::recording::{Chunk, Chunks, Event, Head, Item, Iteration, Participant, RecordingError};
use run::error::{RunError, file_failure, input_failure};
use std::collections::HashMap;
use std::fs::{self, File, Metadata};
use std::ops::Range;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Approximate limit of the memory of an index \[byte\]. A compressed recording of less than a
/// megabyte can hold any number of samples and steps.
const MOST_BYTES: usize = 256 << 20;

/// A completed iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    /// Number of the window, from 0.
    pub(crate) window: u64,
    /// Iteration within the window, from 1.
    pub(crate) iteration: u32,
    /// Start and end of the window \[s\].
    pub(crate) interval: [f64; 2],
    /// Largest relative residual.
    pub(crate) residual: Option<f64>,
    /// Time of its end in the recording \[ns\].
    pub(crate) nanoseconds: u64,
}

/// Place of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    /// Time in the recording \[ns\].
    pub(crate) nanoseconds: u64,
    chunk: u32,
    /// Iteration of the sample.
    pub(crate) iteration: u32,
    /// Window of the sample.
    pub(crate) window: u64,
    /// Number of earlier samples with this window and iteration.
    attempt: u32,
    /// Smallest and largest value.
    pub(crate) range: [f64; 2],
    /// Number that differs if any bit of the values differs, with a probability of 1 − 2⁻⁶⁴.
    hash: u64,
}

/// All samples of a service.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    /// Name of the service.
    pub(crate) service: String,
    /// Kind of the field; for a geometry that of the geometry.
    pub(crate) kind: FieldKind,
    /// Grid of the first sample.
    grid: Option<Grid>,
    /// Service that sends the geometry of the grid.
    geometry: Option<String>,
    /// Places, in order of time.
    pub(crate) places: Vec<Place>,
    /// Number of samples of the newest window so far, by iteration.
    attempts: HashMap<u32, u32>,
    /// Positions in `places` by window, iteration and attempt, for as many as were looked up.
    positions: HashMap<(u64, u32, u32), usize>,
    looked_up: usize,
}

/// A sample with its grid.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sample {
    pub(crate) header: FieldHeader,
    pub(crate) grid: Option<Grid>,
    pub(crate) values: Vec<f64>,
}

/// Index of a recording.
pub(crate) struct Index {
    path: PathBuf,
    file: FileIdentity,
    recording: FileRecording,
    finder: Chunks<File>,
    chunks: Vec<Chunk>,
    bodies: Option<Bodies>,
    /// Grids of the services, from the first connection, with the service of their geometry.
    topics: Vec<(String, Grid, Option<String>)>,
    series: Vec<Series>,
    /// Number of the series of each service.
    numbers: HashMap<String, usize>,
    steps: Vec<Step>,
    /// Memory of samples and steps \[byte\].
    held: usize,
    most: usize,
    /// The iterations as rows of a table, as a run writes them, after its head.
    rows: Vec<String>,
    error: Option<String>,
    ended: bool,
}

/// Identity of a file, by which another one in its place is recognised.
#[derive(Clone, Copy, Debug)]
struct FileIdentity {
    device: u64,
    number: u64,
    changed: Option<SystemTime>,
}

impl FileIdentity {
    fn of(found: &Metadata) -> Self {
        Self { device: found.dev(), number: found.ino(), changed: found.modified().ok() }
    }
}

impl Index {
    /// Opens a recording, and reads its head only.
    ///
    /// # Errors
    /// The file does not exist, or is not a recording.
    pub(crate) fn open(path: &Path) -> Result<Self, RunError> {
        Self::open_within(path, MOST_BYTES)
    }

    /// Opens a recording like [`Index::open`], with another limit of memory \[byte\].
    pub(crate) fn open_within(path: &Path, most: usize) -> Result<Self, RunError> {
        let recording = recording_file::open(path)?;
        let file = input_file::open(path).map_err(|error| input_failure(path, &error))?;
        let found = file.metadata().map_err(|error| file_failure(path, &error))?;
        Ok(Self {
            path: path.to_owned(),
            file: FileIdentity::of(&found),
            recording,
            finder: Chunks::new(file),
            chunks: Vec::new(),
            bodies: None,
            topics: Vec::new(),
            series: Vec::new(),
            numbers: HashMap::new(),
            steps: Vec::new(),
            held: 0,
            most,
            rows: Vec::new(),
            error: None,
            ended: false,
        })
    }

    /// Returns whether the file at this path is the one that is read: neither another file, nor one
    /// that was written again in place. The open file keeps its number from being used again.
    pub(crate) fn is_of(&self, path: &Path) -> bool {
        let Ok(found) = fs::metadata(path) else { return false };
        let now = FileIdentity::of(&found);
        let same = [now.device, now.number] == [self.file.device, self.file.number];
        let grown_only = found.len() >= self.bytes();
        same && grown_only && (!self.is_complete() || now.changed == self.file.changed)
    }

    /// Reads the next chunk; returns false if no further chunk is complete.
    ///
    /// # Errors
    /// The recording is damaged.
    pub(crate) fn advance(&mut self) -> Result<bool, RunError> {
        if self.is_full() {
            return Ok(false);
        }
        let path = self.path.clone();
        let grew = !self.is_complete();
        let found = self.finder.find_next().map_err(|error| file_failure(&path, &error))?;
        if grew && self.is_complete() {
            self.file.changed = fs::metadata(&path).and_then(|found| found.modified()).ok();
        }
        let Some(chunk) = found else { return Ok(false) };
        self.chunks.push(chunk);
        let outcome = self.read_chunk(chunk);
        outcome.map(|()| true).map_err(|error| failed(&path, &error))
    }

    fn read_chunk(&mut self, chunk: Chunk) -> Result<(), RecordingError> {
        let Self { recording, bodies, topics, series, numbers, steps, .. } = self;
        let number = self.chunks.len() as u32 - 1;
        let head = recording.head().clone();
        recording.seek(chunk)?;
        while let Some(entry) = recording.read()? {
            let nanoseconds = entry.nanoseconds;
            match entry.item {
                Item::Sample { service, header, values } => {
                    let at = numbers.get(service).copied().unwrap_or_else(|| {
                        series.push(Series::new(service, &header, &head, topics));
                        numbers.insert(service.to_owned(), series.len() - 1);
                        series.len() - 1
                    });
                    let FieldHeader { window, iteration, .. } = header;
                    let attempt = series[at].attempt(window, iteration);
                    let (range, hash, chunk) = (range(values), hash(values), number);
                    let place =
                        Place { nanoseconds, chunk, window, iteration, attempt, range, hash };
                    series[at].places.push(place);
                    self.held += size_of::<Place>();
                }
                Item::Event(Event::Command { command, body, .. }) => {
                    match CommandKind::from_number(command.kind) {
                        Some(CommandKind::Configure) if bodies.is_none() => {
                            let given = serde_json::from_slice::<Configuration>(&body).ok();
                            *bodies = given.and_then(|given| Bodies::read(&given.case).ok());
                        }
                        Some(CommandKind::Connect) => {
                            let read = proto::recording::read_topics(&body)?;
                            let all = read.inputs.into_iter().chain(read.outputs);
                            topics.extend(all.map(|one| (one.service, one.grid, one.geometry)));
                        }
                        _ => {}
                    }
                }
                Item::Event(Event::Iteration(iteration)) => {
                    if steps.is_empty() {
                        self.rows.push(table_head(&iteration, &head.participants));
                    }
                    let row = table_row(&iteration);
                    self.held += size_of::<Step>() + size_of::<String>() + row.len();
                    self.rows.push(row);
                    steps.push(Step {
                        window: iteration.window,
                        iteration: iteration.iteration,
                        interval: [iteration.start, iteration.end],
                        residual: iteration.residual,
                        nanoseconds,
                    });
                }
                Item::Event(Event::Ended { error }) => {
                    self.error = error;
                    self.ended = true;
                }
                Item::Event(Event::Reply { .. } | Event::Repeated { .. }) | Item::State { .. } => {}
            }
            if nanoseconds >= chunk.last || self.held >= self.most {
                break;
            }
        }
        Ok(())
    }

    /// Returns the sample of a series that was valid at this time; `None` before the first one.
    ///
    /// # Errors
    /// The recording is damaged.
    pub(crate) fn sample(
        &mut self,
        series: usize,
        nanoseconds: u64,
    ) -> Result<Option<(Place, Sample)>, RunError> {
        let Some(place) = self.series[series].at(nanoseconds) else { return Ok(None) };
        let (header, values) = self.read(place)?;
        let Series { grid, geometry, .. } = &self.series[series];
        let (mut grid, geometry) = (grid.clone(), geometry.clone());
        if let Some(base) = grid.as_ref().filter(|base| base.revision < header.grid_revision) {
            let moved = geometry.and_then(|service| self.find(&service));
            let moved = moved.and_then(|at| self.series[at].at(place.nanoseconds));
            let base = base.clone();
            grid = match moved {
                Some(moved) => {
                    let (header, values) = self.read(moved)?;
                    let grid = base.with_geometry(&values, header.grid_revision);
                    let damaged = |what| failed(&self.path, &RecordingError::Content(what));
                    Some(grid.map_err(damaged)?)
                }
                None => None,
            };
        }
        let components = self.series[series].kind.components;
        let fits = |grid: &Grid| {
            let points = if grid.is_announced() { 0 } else { grid.points() as u64 };
            (points, components) == (header.points, header.components)
        };
        let grid = grid.filter(fits);
        Ok(Some((place, Sample { header, grid, values })))
    }

    fn read(&mut self, place: Place) -> Result<(FieldHeader, Vec<f64>), RunError> {
        let read = read_at(&mut self.recording, self.chunks[place.chunk as usize], place);
        read.map_err(|error| failed(&self.path, &error))
    }

    /// Returns the sample of a series that another recording has at this place.
    ///
    /// # Errors
    /// The recording is damaged.
    pub(crate) fn sample_like(
        &mut self,
        series: usize,
        other: &Place,
    ) -> Result<Option<Sample>, RunError> {
        match self.series[series].like(other) {
            Some(place) => Ok(self.sample(series, place.nanoseconds)?.map(|(_, sample)| sample)),
            None => Ok(None),
        }
    }

    /// Returns the number of the series of a service.
    pub(crate) fn find(&self, service: &str) -> Option<usize> {
        self.numbers.get(service).copied()
    }

    /// Returns all series, geometries included.
    pub(crate) fn series(&self) -> &[Series] {
        &self.series
    }

    /// Returns the completed iterations.
    pub(crate) fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// Returns the bodies of the case.
    pub(crate) fn bodies(&self) -> Option<&Bodies> {
        self.bodies.as_ref()
    }

    /// Returns some of the steps as a table, as a run writes it.
    pub(crate) fn table(&self, steps: Range<usize>) -> String {
        let Some((head, rows)) = self.rows.split_first() else { return String::new() };
        head.to_owned() + &rows[steps].concat()
    }

    /// Returns an attached text.
    pub(crate) fn text(&self, name: &str) -> String {
        let text = self.recording.attachment(name).unwrap_or_default();
        String::from_utf8_lossy(text).into_owned()
    }

    /// Returns the name of the case.
    pub(crate) fn case(&self) -> &str {
        &self.recording.head().case
    }

    /// Returns the coupling scheme.
    pub(crate) fn scheme(&self) -> &str {
        &self.recording.head().scheme
    }

    /// Returns whether the run ended, with its error.
    pub(crate) fn end(&self) -> Option<Option<&str>> {
        self.ended.then_some(self.error.as_deref())
    }

    /// Returns whether the recording grows no more.
    pub(crate) fn is_complete(&self) -> bool {
        self.finder.is_finished()
    }

    /// Returns whether the index holds as much as it may; the rest of the recording is not read.
    pub(crate) fn is_full(&self) -> bool {
        self.held >= self.most
    }

    /// Returns the length of the part that was read \[byte\].
    pub(crate) fn bytes(&self) -> u64 {
        self.chunks.last().map_or(0, |chunk| chunk.end)
    }
}

impl Series {
    /// Returns a series without samples; the header is that of its first sample.
    fn new(
        service: &str,
        header: &FieldHeader,
        head: &Head,
        topics: &[(String, Grid, Option<String>)],
    ) -> Self {
        let topic = topics.iter().find(|(name, ..)| name == service);
        Self {
            service: service.to_owned(),
            kind: head.field_kind(header),
            grid: topic.map(|(_, grid, _)| grid.clone()),
            geometry: topic.and_then(|(.., geometry)| geometry.clone()),
            places: Vec::new(),
            attempts: HashMap::new(),
            positions: HashMap::new(),
            looked_up: 0,
        }
    }

    /// Returns the newest sample at a time \[ns\].
    pub(crate) fn at(&self, nanoseconds: u64) -> Option<Place> {
        let after = self.places.partition_point(|place| place.nanoseconds <= nanoseconds);
        after.checked_sub(1).map(|at| self.places[at])
    }

    /// Returns the sample of the same window, iteration and attempt as one of another recording.
    pub(crate) fn like(&mut self, other: &Place) -> Option<Place> {
        let key = |place: &Place| (place.window, place.iteration, place.attempt);
        for (at, place) in self.places.iter().enumerate().skip(self.looked_up) {
            self.positions.entry(key(place)).or_insert(at);
        }
        self.looked_up = self.places.len();
        self.positions.get(&key(other)).map(|at| self.places[*at])
    }

    /// Returns the number of samples so far with this window and iteration, and counts another one.
    /// The windows of a run never go back.
    fn attempt(&mut self, window: u64, iteration: u32) -> u32 {
        if self.places.last().is_none_or(|last| last.window != window) {
            self.attempts.clear();
        }
        let count = self.attempts.entry(iteration).or_default();
        *count += 1;
        *count - 1
    }

    /// Returns whether the samples are geometries.
    pub(crate) fn is_geometry(&self) -> bool {
        self.kind.name == GEOMETRY.name
    }
}

fn read_at(
    recording: &mut FileRecording,
    chunk: Chunk,
    place: Place,
) -> Result<(FieldHeader, Vec<f64>), RecordingError> {
    recording.seek(chunk)?;
    while let Some(entry) = recording.read()? {
        if entry.nanoseconds == place.nanoseconds
            && let Item::Sample { header, values, .. } = entry.item
        {
            return Ok((header, values.to_vec()));
        }
        if entry.nanoseconds >= place.nanoseconds {
            break;
        }
    }
    Err(RecordingError::Content("a sample has gone since it was first read".to_owned()))
}

/// Returns a number for all bits of the values.
fn hash(values: &[f64]) -> u64 {
    // Multiplication by an odd number and rotation keep every bit of the last state.
    let mix = |state: u64, value: &f64| {
        (state ^ value.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
    };
    values.iter().fold(values.len() as u64, mix)
}

/// Search for the first difference of a recording from another one. Both may still grow.
#[derive(Debug, Default)]
pub(crate) struct DifferenceSearch {
    /// Number of leading samples of each series that are equal.
    equal: Vec<usize>,
}

impl DifferenceSearch {
    /// Returns the first sample that the other recording does not have, or has with other values:
    /// its series and its time \[ns\]. Samples that were found equal are not compared again.
    pub(crate) fn first(&mut self, now: &Index, then: &mut Index) -> Option<(usize, u64)> {
        self.equal.resize(now.series.len(), 0);
        let mut first: Option<(usize, u64)> = None;
        for (number, (series, equal)) in now.series.iter().zip(&mut self.equal).enumerate() {
            let other = then.find(&series.service);
            let mut is_same = |place: &Place| {
                let same = other.and_then(|at| then.series[at].like(place));
                same.is_some_and(|same| same.hash == place.hash)
            };
            *equal += series.places[*equal..].iter().take_while(|place| is_same(place)).count();
            if let Some(place) = series.places.get(*equal)
                && first.is_none_or(|(_, earliest)| place.nanoseconds < earliest)
            {
                first = Some((number, place.nanoseconds));
            }
        }
        first
    }
}

/// Returns the smallest and largest finite value; not a number if there is none.
fn range(values: &[f64]) -> [f64; 2] {
    let finite = values.iter().filter(|value| value.is_finite());
    finite.fold([f64::NAN; 2], |[low, high], value| [low.min(*value), high.max(*value)])
}

/// Returns the names of the columns.
fn table_head(first: &Iteration, participants: &[Participant]) -> String {
    let mut head = "window,iteration,start_s,end_s,residual".to_owned();
    first.residuals.iter().for_each(|(name, _)| head += &format!(",residual_{name}"));
    head += ",coupling_s,heat_sent_w,heat_received_w";
    participants.iter().for_each(|one| head += &format!(",{0}_s,{0}_work", one.role));
    head + "\n"
}

/// Returns the row of an iteration.
fn table_row(iteration: &Iteration) -> String {
    let cell = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:e}"));
    let Iteration { window, iteration: number, start, end, .. } = iteration;
    let mut row = format!("{window},{number},{start:e},{end:e},{}", cell(iteration.residual));
    iteration.residuals.iter().for_each(|(_, value)| row += &format!(",{value:e}"));
    let [sent, received] = [iteration.sent, iteration.received].map(cell);
    row += &format!(",{:e},{sent},{received}", iteration.coupling_seconds);
    iteration.model_seconds.iter().for_each(|seconds| row += &format!(",{seconds:e},"));
    row + "\n"
}
