//! Fixed layouts of all data in shared memory.
//!
//! All types are `#[repr(C)]`, free of pointers, and explicitly padded, as their `zerocopy` derives
//! require. C lays them out identically; tests pin every size and offset. Text sits in zero-padded
//! ASCII labels. Variable-length content (configuration, errors, summaries) follows a [`Command`]
//! or [`Reply`] as JSON bytes. Field values follow a [`FieldHeader`] as `[f64]`; a
//! [`ProgressReport`] stands alone.

use crate::field::FieldKind;
use crate::grid::Grid;
use crate::step::{Step, StepReport};
use crate::text::one_line;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// Maximum number of participants in a run.
pub const MOST_PARTICIPANTS: usize = 12;

/// Maximum number of inputs of a participant.
pub const MAX_INPUTS: usize = 16;

/// Zero-padded ASCII text of at most `N - 1` bytes.
#[repr(transparent)]
#[derive(Clone, Copy, PartialEq, Eq, FromBytes, Immutable, IntoBytes, KnownLayout)]
pub struct Label<const N: usize>(pub [u8; N]);

impl<const N: usize> Label<N> {
    /// Truncates the text to `N - 1` bytes; lengths of names are checked where names enter (field
    /// table, plan).
    #[must_use]
    pub fn new(text: &str) -> Self {
        let mut bytes = [0; N];
        let length = text.len().min(N - 1);
        bytes[..length].copy_from_slice(&text.as_bytes()[..length]);
        Self(bytes)
    }

    /// Returns the text up to the first zero byte; empty if it is not UTF-8.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let end = self.0.iter().position(|&b| b == 0).unwrap_or(N);
        std::str::from_utf8(&self.0[..end]).unwrap_or("")
    }
}

impl<const N: usize> Default for Label<N> {
    fn default() -> Self {
        Self([0; N])
    }
}

impl<const N: usize> std::fmt::Debug for Label<N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?}", self.as_str())
    }
}

/// Kind of a command.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandKind {
    /// Requests the description; the reply's body is a [`crate::description::Description`].
    Describe = 1,
    /// Configures the participant. Body: [`crate::configuration::Configuration`]; the reply's body
    /// is a [`crate::configuration::Layout`].
    Configure = 2,
    /// Opens the field ports. Body: [`Topics`]. Participants publish only after every participant
    /// has replied, so that every sample reaches all its subscribers.
    Connect = 3,
    /// Builds the model, publishes the geometry of the volumes in [`Topics::geometry`] and the
    /// first outputs.
    Initialise = 4,
    /// Solves one iteration of one window and publishes the outputs.
    Solve = 5,
    /// Makes the last solve the accepted state. With [`OBSERVE`], the participant publishes the
    /// observed fields on the grids of that solve. Then it publishes the geometry of every grid of
    /// [`Topics::geometry`] that has moved. With [`FIGURES`], the reply's body holds the figures of
    /// [`Topics::figures`], see [`write_figures`].
    Accept = 6,
    /// Writes the accepted state to the file `path`. Body: [`StateFile`].
    Save = 7,
    /// Reads the state from the file `path`. Body: [`StateFile`]. The participant publishes the
    /// `geometry` of the command's step and the `outputs` with its labels. Then it publishes the
    /// geometry of every grid that moved when the step was accepted. The restored state is the one
    /// at the end of this step.
    Restore = 8,
    /// Ends the run; the reply's body is the summary ([`Finished`]). Without a flag the participant
    /// exits. With [`STAY`] it closes all ports except those of commands, and waits for the
    /// `Configure` of another run, which starts like the first.
    Finish = 9,
    /// Requests advice on effects, before a run. Body: [`crate::advice::Scene`]; the reply's body
    /// is an [`crate::advice::Opinion`]. Only sent to participants that advise
    /// ([`crate::description::Description::advises`]).
    Advise = 10,
}

impl CommandKind {
    /// All kinds, in the order of their numbers.
    pub const ALL: [Self; 10] = [
        Self::Describe,
        Self::Configure,
        Self::Connect,
        Self::Initialise,
        Self::Solve,
        Self::Accept,
        Self::Save,
        Self::Restore,
        Self::Finish,
        Self::Advise,
    ];

    /// Returns the kind with this number.
    #[must_use]
    pub fn from_number(number: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| *kind as u32 == number)
    }
}

/// Flag of a [`Command`] of kind `Accept`: publish the observed fields.
pub const OBSERVE: u32 = 1;

/// Flag of a [`Command`] of kind `Accept`: reply with the figures of the accepted state.
pub const FIGURES: u32 = 2;

/// Flag of a [`Command`] of kind `Finish`: stay for another run. Only sent to participants that
/// are [`crate::description::Description::reusable`].
pub const STAY: u32 = 1;

/// Command from the coordinator to one participant.
#[repr(C)]
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    serde::Serialize,
    serde::Deserialize,
    FromBytes,
    Immutable,
    IntoBytes,
    KnownLayout,
)]
pub struct Command {
    /// [`crate::PROTOCOL_VERSION`] of the sender.
    pub protocol: u32,
    /// Number of a [`CommandKind`].
    pub kind: u32,
    /// Number of the command to this participant, from 1.
    pub sequence: u64,
    /// Number of the window, from 0.
    pub window: u64,
    /// Iteration within the window, from 1.
    pub iteration: u32,
    /// Any of [`OBSERVE`], [`FIGURES`] and [`STAY`].
    pub flags: u32,
    /// Start of the window [s].
    pub start: f64,
    /// End of the window [s].
    pub end: f64,
    /// Sequence number of the sample that this solve must use, for each input in the order of the
    /// configuration.
    pub expected: [u64; MAX_INPUTS],
}

impl Command {
    /// Returns a command without a window.
    #[must_use]
    pub fn new(kind: CommandKind) -> Self {
        Self { protocol: crate::PROTOCOL_VERSION, kind: kind as u32, ..Self::default() }
    }

    /// Returns a command about a step.
    #[must_use]
    pub fn about(kind: CommandKind, step: &Step) -> Self {
        Self {
            window: step.window,
            iteration: step.iteration,
            start: step.start,
            end: step.end,
            ..Self::new(kind)
        }
    }

    /// Returns the step that the command is about.
    #[must_use]
    pub fn step(&self) -> Step {
        Step { window: self.window, iteration: self.iteration, start: self.start, end: self.end }
    }
}

/// Outcome of a command.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The command succeeded.
    Done = 0,
    /// The command failed; the body is a [`Failure`].
    Failed = 1,
    /// The participant refuses the case; the body is a [`crate::configuration::Refusal`].
    Refused = 2,
}

impl Status {
    /// Returns the status with this number.
    #[must_use]
    pub fn from_number(number: u32) -> Option<Self> {
        [Self::Done, Self::Failed, Self::Refused].into_iter().find(|s| *s as u32 == number)
    }
}

/// Reply of a participant to the coordinator.
#[repr(C)]
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    serde::Serialize,
    serde::Deserialize,
    FromBytes,
    Immutable,
    IntoBytes,
    KnownLayout,
)]
pub struct Reply {
    /// [`crate::PROTOCOL_VERSION`] of the sender.
    pub protocol: u32,
    /// Number of a [`Status`].
    pub status: u32,
    /// Sequence number of the command that this replies to.
    pub sequence: u64,
    /// Work of the solve, in the model's own unit.
    pub work: u64,
    /// Number of substeps of the solve.
    pub substeps: u32,
    /// Number of inner iterations of the solve.
    pub inner_iterations: u32,
    /// Mean power received through conservative inputs [W]; valid with [`RECEIVED_POWER`].
    pub received_power: f64,
    /// Seconds spent in the model.
    pub model_seconds: f64,
    /// Longest window that the model accepts from the start of this one [s]; valid with
    /// [`WANTED_WINDOW`].
    pub wanted_window: f64,
    /// Any of [`RECEIVED_POWER`] and [`WANTED_WINDOW`]: the quantities that the reply has.
    pub present: u32,
    /// Always 0.
    pub reserved: u32,
}

/// Flag of [`Reply::present`]: the model reports the power that it receives.
pub const RECEIVED_POWER: u32 = 1;

/// Flag of [`Reply::present`]: the model limits the window.
pub const WANTED_WINDOW: u32 = 2;

impl Reply {
    /// Returns a reply to the command with this sequence number.
    #[must_use]
    pub fn new(status: Status, sequence: u64) -> Self {
        Self {
            protocol: crate::PROTOCOL_VERSION,
            status: status as u32,
            sequence,
            ..Self::default()
        }
    }

    /// Returns the mean power received through conservative inputs [W], if the model reports it.
    #[must_use]
    pub fn received_power(&self) -> Option<f64> {
        (self.present & RECEIVED_POWER != 0).then_some(self.received_power)
    }

    /// Returns the longest window that the model accepts from the start of this one [s], if it
    /// limits the window.
    #[must_use]
    pub fn wanted_window(&self) -> Option<f64> {
        (self.present & WANTED_WINDOW != 0).then_some(self.wanted_window)
    }

    /// Describes the first invalid quantity of a solve, if any.
    #[must_use]
    pub fn fault(&self) -> Option<String> {
        let times =
            [("model_seconds", Some(self.model_seconds)), ("wanted_window", self.wanted_window())];
        for (name, seconds) in times {
            if let Some(seconds) = seconds.filter(|s| !(s.is_finite() && *s >= 0.0)) {
                return Some(format!("{name} is {seconds} s"));
            }
        }
        let power = self.received_power().filter(|power| !power.is_finite())?;
        Some(format!("received_power is {power} W"))
    }

    /// Adds the report of a solve.
    #[must_use]
    pub fn with_report(mut self, report: &StepReport) -> Self {
        self.work = report.work;
        self.substeps = report.substeps;
        self.inner_iterations = report.inner_iterations;
        self.received_power = report.received_power.unwrap_or_default();
        self.wanted_window = report.wanted_window.unwrap_or_default();
        self.present = report.received_power.map_or(0, |_| RECEIVED_POWER)
            | report.wanted_window.map_or(0, |_| WANTED_WINDOW);
        self
    }
}

/// Size of a figure in the body of a reply to `Accept` [byte].
const FIGURE_BYTES: usize = 1 + size_of::<f64>();

/// Returns the body of a reply to `Accept` with [`FIGURES`]: for each figure a byte, 1 if the
/// figure exists and 0 otherwise, and its value as a little-endian double.
#[must_use]
pub fn write_figures(figures: impl IntoIterator<Item = Option<f64>>) -> Vec<u8> {
    let mut body = Vec::new();
    for figure in figures {
        body.push(u8::from(figure.is_some()));
        body.extend(figure.unwrap_or_default().to_le_bytes());
    }
    body
}

/// Reads the body of a reply to `Accept` with [`FIGURES`] into `figures`.
///
/// # Errors
/// The body does not hold so many figures; describes the difference.
pub fn read_figures(body: &[u8], figures: &mut [Option<f64>]) -> Result<(), String> {
    let (found, count) = (body.len(), figures.len());
    if found != FIGURE_BYTES * count {
        return Err(format!("it replies with {found} bytes to a request for {count} figures"));
    }
    for (figure, bytes) in figures.iter_mut().zip(body.as_chunks::<FIGURE_BYTES>().0) {
        let [exists, value @ ..] = *bytes;
        *figure = match exists {
            0 => None,
            1 => Some(f64::from_le_bytes(value)),
            _ => return Err(format!("it marks a figure with {exists} instead of 0 or 1")),
        };
    }
    Ok(())
}

/// Progress of a participant in its current command, sent with the heartbeat.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, FromBytes, Immutable, IntoBytes, KnownLayout)]
pub struct ProgressReport {
    /// Sequence number of the command.
    pub sequence: u64,
    /// Completed work, in the participant's own unit.
    pub done: u64,
    /// Total work, in the same unit; 0 if unknown.
    pub of: u64,
    /// Current activity, in one word ("factorising").
    pub what: Label<32>,
}

/// Writes one line, such as "37 of 60 factorising", whatever text the participant sent.
impl std::fmt::Display for ProgressReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.done)?;
        if self.of > 0 {
            write!(f, " of {}", self.of)?;
        }
        match one_line(self.what.as_str()) {
            what if what.is_empty() => Ok(()),
            what => write!(f, " {what}"),
        }
    }
}

/// Header in front of the values of every field.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, FromBytes, Immutable, IntoBytes, KnownLayout)]
pub struct FieldHeader {
    /// [`crate::PROTOCOL_VERSION`] of the sender.
    pub protocol: u32,
    /// Number of components; the values are component-major.
    pub components: u32,
    /// Number of points; there are `components * points` values.
    pub points: u64,
    /// Revision of the grid.
    pub grid_revision: u64,
    /// Number of the window, from 0.
    pub window: u64,
    /// Iteration within the window, from 1; 0 before the first solve.
    pub iteration: u32,
    /// Always 0.
    pub reserved: u32,
    /// Start of the interval that the values hold for [s].
    pub start: f64,
    /// End of the interval that the values hold for [s].
    pub end: f64,
    /// Number of the sample of this topic, from 1.
    pub sequence: u64,
    /// Name of the field.
    pub name: Label<32>,
    /// SI unit.
    pub unit: Label<16>,
    /// Role of the producer.
    pub producer: Label<32>,
    /// Name of the grid.
    pub grid: Label<32>,
}

impl FieldHeader {
    /// Returns the header of a field that the participant of the role `producer` sends on a grid,
    /// before the first sample.
    #[must_use]
    pub fn new(kind: &FieldKind, producer: &str, grid: &Grid) -> Self {
        Self {
            protocol: crate::PROTOCOL_VERSION,
            components: kind.components,
            points: grid.points() as u64,
            grid_revision: grid.revision,
            name: Label::new(&kind.name),
            unit: Label::new(&kind.unit),
            producer: Label::new(producer),
            grid: Label::new(&grid.name),
            ..Self::default()
        }
    }

    /// Returns the step that the sample belongs to.
    #[must_use]
    pub fn step(&self) -> Step {
        Step { window: self.window, iteration: self.iteration, start: self.start, end: self.end }
    }

    /// Labels the next sample as one of this step.
    pub fn set_step(&mut self, step: &Step) {
        (self.window, self.iteration) = (step.window, step.iteration);
        (self.start, self.end) = (step.start, step.end);
    }

    /// Describes the first difference between this header of a sample with so many values and the
    /// expected one; `None` if there is none. The text continues a sentence that names the field.
    #[must_use]
    pub fn difference(&self, expected: &Self, values: usize) -> Option<String> {
        if self.protocol != expected.protocol {
            return Some(format!("has protocol version {}", self.protocol));
        }
        if self.grid_revision != expected.grid_revision {
            let (found, known) = (self.grid_revision, expected.grid_revision);
            return Some(format!(
                "is on revision {found} of grid `{}`, whose geometry is known in revision {known}",
                expected.grid.as_str()
            ));
        }
        let shape = |header: &Self| (header.components, header.points);
        let wanted = expected.points.saturating_mul(u64::from(expected.components));
        if values as u64 != wanted || shape(self) != shape(expected) {
            let (components, points) = shape(self);
            return Some(format!(
                "has {values} values ({components} components, {points} points), expected {wanted}"
            ));
        }
        if self.texts() != expected.texts() {
            let [name, unit, producer, grid] = self.texts();
            return Some(format!("is labelled {name:?} in {unit:?} from {producer:?} on {grid:?}"));
        }
        if self.sequence != expected.sequence {
            let (found, next) = (self.sequence, expected.sequence);
            return Some(format!("has sequence number {found}, not {next}"));
        }
        let Step { window, iteration, start, end } = self.step();
        (self.step() != expected.step()).then(|| {
            format!("is labelled window {window}, iteration {iteration}, from {start} s to {end} s")
        })
    }

    /// Returns the texts of the labels, up to their terminating zeros.
    fn texts(&self) -> [&str; 4] {
        [self.name.as_str(), self.unit.as_str(), self.producer.as_str(), self.grid.as_str()]
    }
}

/// Body of `Connect`: the topics to open.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Topics {
    /// One topic for each input, in the order of the configuration.
    pub inputs: Vec<Topic>,
    /// One topic for each output and observed field.
    pub outputs: Vec<Topic>,
    /// Longest time to wait for the ports of the peers [s].
    pub deadline: f64,
    /// Variation of inputs within a window.
    #[serde(default)]
    pub interpolation: Interpolation,
    /// Grids whose geometry this participant must publish: surfaces whenever they move, and volumes
    /// that carry a field of the run.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub geometry: Vec<GeometryTopic>,
    /// Keys of the summary whose values this participant sends in reply to `Accept` with
    /// [`FIGURES`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub figures: Vec<String>,
}

crate::words! {
    /// Variation of consistently mapped inputs within a window. Conservatively mapped inputs are
    /// means over the window and do not vary.
    #[derive(Default)]
    pub enum Interpolation {
        /// Inputs have the values of the window's end throughout.
        #[default]
        Constant = "constant",
        /// Inputs vary linearly from the accepted values at the start to those at the end.
        Linear = "linear",
    }
}

/// A service that carries one field.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Topic {
    /// Name of the field.
    pub field: String,
    /// Name of the service.
    pub service: String,
    /// The grid of the values.
    pub grid: Grid,
    /// Number of subscribers that every sample has to reach.
    pub subscribers: usize,
    /// Service that carries the geometry of the grid, if the grid may move. Samples of the field
    /// name its revision; the geometry of a new revision is published before the first such sample.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub geometry: Option<String>,
}

/// A service that carries the geometry of one grid. When the grid has moved, it sends a
/// [`crate::field::GEOMETRY`] behind a [`FieldHeader`] with the name of the grid and its new
/// revision.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct GeometryTopic {
    /// Name of the grid.
    pub grid: String,
    /// Name of the service.
    pub service: String,
    /// Number of subscribers that every sample has to reach.
    pub subscribers: usize,
}

/// Body of a failed reply.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Failure {
    /// Description of the failure.
    pub error: String,
}

/// Body of `Save` and `Restore`.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct StateFile {
    /// File of the state, to write or to read.
    pub path: std::path::PathBuf,
    /// Outputs to publish after `Restore`: all that are published in each iteration. Empty for
    /// `Save`.
    #[serde(default)]
    pub outputs: Vec<OutputFile>,
    /// Surfaces of [`Topics::geometry`] in the command's step, which carry the outputs; for
    /// `Restore`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub geometry: Vec<Grid>,
}

/// Values of an output, in a file.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct OutputFile {
    /// Name of the field.
    pub field: String,
    /// File of `components * points` little-endian doubles, component-major.
    pub path: std::path::PathBuf,
}

/// Body of the reply to `Finish`.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Finished {
    /// Sections for `summary.json`.
    pub summary: serde_json::Value,
    /// Seconds spent in the model over the run, including its construction.
    pub model_seconds: f64,
    /// Peak resident memory of the process [byte], if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak_rss_bytes: Option<u64>,
    /// User and system processor time of the process [s], if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cpu_seconds: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::{align_of, offset_of, size_of};

    #[test]
    fn golden_layout_of_command() {
        assert_eq!((size_of::<Command>(), align_of::<Command>()), (176, 8));
        let offsets = [
            offset_of!(Command, protocol),
            offset_of!(Command, kind),
            offset_of!(Command, sequence),
            offset_of!(Command, window),
            offset_of!(Command, iteration),
            offset_of!(Command, flags),
            offset_of!(Command, start),
            offset_of!(Command, end),
            offset_of!(Command, expected),
        ];
        assert_eq!(offsets, [0, 4, 8, 16, 24, 28, 32, 40, 48]);
    }

    #[test]
    fn golden_layout_of_reply() {
        assert_eq!((size_of::<Reply>(), align_of::<Reply>()), (64, 8));
        let offsets = [
            offset_of!(Reply, protocol),
            offset_of!(Reply, status),
            offset_of!(Reply, sequence),
            offset_of!(Reply, work),
            offset_of!(Reply, substeps),
            offset_of!(Reply, inner_iterations),
            offset_of!(Reply, received_power),
            offset_of!(Reply, model_seconds),
            offset_of!(Reply, wanted_window),
            offset_of!(Reply, present),
            offset_of!(Reply, reserved),
        ];
        assert_eq!(offsets, [0, 4, 8, 16, 24, 28, 32, 40, 48, 56, 60]);
    }

    #[test]
    fn figures_and_quantities_that_do_not_exist_are_marked() {
        let figures = [Some(1.5), None, Some(0.0)];
        let body = write_figures(figures);
        assert_eq!((body.len(), &body[9..18]), (27, &[0; 9][..]));
        let mut read = [None; 3];
        assert_eq!((read_figures(&body, &mut read), read), (Ok(()), figures));
        assert!(read_figures(&body[1..], &mut read).unwrap_err().contains("26 bytes"));
        let mut marked = body;
        marked[0] = 2;
        assert!(read_figures(&marked, &mut read).unwrap_err().contains("with 2"));

        let report = |received_power, wanted_window| {
            let report = StepReport { received_power, wanted_window, ..StepReport::default() };
            let reply = Reply::new(Status::Done, 1).with_report(&report);
            assert_eq!(reply.fault(), None);
            (reply.received_power(), reply.wanted_window())
        };
        for (power, window) in [(None, None), (Some(0.0), None), (None, Some(2.0))] {
            assert_eq!(report(power, window), (power, window));
        }
    }

    #[test]
    fn golden_layout_of_progress_report() {
        assert_eq!((size_of::<ProgressReport>(), align_of::<ProgressReport>()), (56, 8));
        let offsets = [
            offset_of!(ProgressReport, sequence),
            offset_of!(ProgressReport, done),
            offset_of!(ProgressReport, of),
            offset_of!(ProgressReport, what),
        ];
        assert_eq!(offsets, [0, 8, 16, 24]);
    }

    #[test]
    fn progress_reads_as_a_sentence_of_one_line() {
        let report = |done, of, what: &str| {
            let what = Label::new(what);
            ProgressReport { sequence: 1, done, of, what }.to_string()
        };
        assert_eq!(report(37, 60, "factorising"), "37 of 60 factorising");
        assert_eq!(report(37, 0, "assembling"), "37 assembling");
        assert_eq!(report(3, 4, ""), "3 of 4");
        assert_eq!(report(1, 2, "\u{1b}[2J"), "1 of 2 \\u{1b}[2J");
    }

    #[test]
    fn golden_layout_of_field_header() {
        assert_eq!((size_of::<FieldHeader>(), align_of::<FieldHeader>()), (176, 8));
        let offsets = [
            offset_of!(FieldHeader, protocol),
            offset_of!(FieldHeader, components),
            offset_of!(FieldHeader, points),
            offset_of!(FieldHeader, grid_revision),
            offset_of!(FieldHeader, window),
            offset_of!(FieldHeader, iteration),
            offset_of!(FieldHeader, reserved),
            offset_of!(FieldHeader, start),
            offset_of!(FieldHeader, end),
            offset_of!(FieldHeader, sequence),
            offset_of!(FieldHeader, name),
            offset_of!(FieldHeader, unit),
            offset_of!(FieldHeader, producer),
            offset_of!(FieldHeader, grid),
        ];
        assert_eq!(offsets, [0, 4, 8, 16, 24, 32, 36, 40, 48, 56, 64, 96, 112, 144]);
    }

    /// Messages without moving grids are unchanged from before moving grids existed.
    #[test]
    fn without_moving_grids_the_bodies_are_as_before() {
        use crate::grid::{Grid, Structured};
        let grid = Grid::structured("g", Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 2, 1));
        let name = String::from;
        let topic = Topic {
            field: name("x"),
            service: name("field/a/x"),
            grid,
            subscribers: 2,
            geometry: None,
        };
        let topics = Topics { outputs: vec![topic], deadline: 1.0, ..Topics::default() };
        let file = StateFile { path: "a.state".into(), outputs: Vec::new(), geometry: Vec::new() };
        let texts =
            [serde_json::to_string(&topics).unwrap(), serde_json::to_string(&file).unwrap()];
        assert!(texts.iter().all(|text| !text.contains("geometry")), "{texts:?}");
        assert_eq!(serde_json::from_str::<Topics>(&texts[0]).unwrap(), topics);
        assert_eq!(serde_json::from_str::<StateFile>(&texts[1]).unwrap(), file);
    }

    #[test]
    fn numbers_of_kinds_are_fixed() {
        let numbers: Vec<u32> = CommandKind::ALL.iter().map(|k| *k as u32).collect();
        assert_eq!(numbers, [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]);
        for kind in CommandKind::ALL {
            assert_eq!(CommandKind::from_number(kind as u32), Some(kind));
        }
        assert_eq!(CommandKind::from_number(0), None);
        assert_eq!(Status::from_number(3), None);
    }

    #[test]
    fn labels_cut_and_read_back() {
        assert_eq!(Label::<8>::new("pressure").as_str(), "pressur");
        assert_eq!(Label::<8>::new("").as_str(), "");
        assert_eq!(Label::<4>([0xff; 4]).as_str(), "");
        assert_eq!(Label::<4>([b'a'; 4]).as_str(), "aaaa");
    }
}
