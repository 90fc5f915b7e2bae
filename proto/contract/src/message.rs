//! Fixed layouts of everything that crosses shared memory.
//!
//! All types are `#[repr(C)]`, self-contained (no pointers), with explicit padding, which their
//! derives of `zerocopy` demand, so that C lays them out alike; the tests pin every size and offset.
//! Text sits in zero-padded ASCII labels. Variable-length content (configuration, errors, summaries)
//! travels as JSON bytes behind a [`Command`] or [`Reply`]; field values travel as `[f64]` behind a
//! [`FieldHeader`]; a [`ProgressReport`] stands alone.

use crate::step::{Step, StepReport};
use crate::text::one_line;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// The most participants of a run.
pub const MOST_PARTICIPANTS: usize = 12;

/// The most inputs one participant can have.
pub const MAX_INPUTS: usize = 16;

/// Zero-padded ASCII text of at most `N - 1` bytes.
#[repr(transparent)]
#[derive(Clone, Copy, PartialEq, Eq, FromBytes, Immutable, IntoBytes, KnownLayout)]
pub struct Label<const N: usize>(pub [u8; N]);

impl<const N: usize> Label<N> {
    /// Cuts at `N - 1` bytes; names are checked for length where they enter (field table, plan).
    #[must_use]
    pub fn new(text: &str) -> Self {
        let mut bytes = [0; N];
        let length = text.len().min(N - 1);
        bytes[..length].copy_from_slice(&text.as_bytes()[..length]);
        Self(bytes)
    }

    /// The text up to the first zero; bytes that are not UTF-8 read as empty.
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

/// What a command asks for.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandKind {
    /// Say what you are; the reply's body is a [`crate::description::Description`].
    Describe = 1,
    /// Body: [`crate::configuration::Configuration`]; the reply's body is a
    /// [`crate::configuration::Layout`].
    Configure = 2,
    /// Body: [`Topics`]; open the field ports, reply. Nothing is published before every participant
    /// has replied, so that every sample finds all its subscribers.
    Connect = 3,
    /// Build the model, publish the geometry of the volumes in [`Topics::geometry`] and the first
    /// outputs, reply.
    Initialise = 4,
    /// Solve one iteration of one window, publish the outputs, reply.
    Solve = 5,
    /// The last solve becomes the accepted state. With [`OBSERVE`] the observed fields are
    /// published, on the grids of that solve; after that the geometry of every grid of
    /// [`Topics::geometry`] that has moved. With [`FIGURES`] the reply's body are the figures of
    /// [`Topics::figures`], as little-endian doubles; one that there is not is NaN. There is a reply
    /// with a flag and from a participant with such grids, otherwise none.
    Accept = 6,
    /// Body: [`StateFile`]; write the accepted state to the file `path`, reply.
    Save = 7,
    /// Body: [`StateFile`]; read the state from the file `path`; publish the `geometry` of the
    /// command's step, the `outputs` with its labels, and then the geometry of every grid that has
    /// moved when it was accepted; reply. The state is that at the end of this step.
    Restore = 8,
    /// Reply with the summary ([`Finished`]) and leave; with [`STAY`] close all ports but those of
    /// commands instead, and wait for the `Configure` of another run, which is as that of the first.
    Finish = 9,
}

impl CommandKind {
    /// Every kind, in the order of their numbers.
    pub const ALL: [Self; 9] = [
        Self::Describe,
        Self::Configure,
        Self::Connect,
        Self::Initialise,
        Self::Solve,
        Self::Accept,
        Self::Save,
        Self::Restore,
        Self::Finish,
    ];

    /// The kind with this number.
    #[must_use]
    pub fn from_number(number: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| *kind as u32 == number)
    }
}

/// Flag of [`Command`] with kind `Accept`: publish the observed fields.
pub const OBSERVE: u32 = 1;

/// Flag of [`Command`] with kind `Accept`: reply with the figures of the accepted state.
pub const FIGURES: u32 = 2;

/// Flag of [`Command`] with kind `Finish`: stay for another run. Only sent to participants that are
/// [`crate::description::Description::reusable`].
pub const STAY: u32 = 1;

/// From the coordinator to one participant.
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
    /// A [`CommandKind`].
    pub kind: u32,
    /// Counts the commands to this participant from 1.
    pub sequence: u64,
    /// Number of the window, from 0.
    pub window: u64,
    /// Iteration within the window, from 1.
    pub iteration: u32,
    /// [`OBSERVE`], [`FIGURES`], [`STAY`].
    pub flags: u32,
    /// Start of the window [s].
    pub start: f64,
    /// End of the window [s].
    pub end: f64,
    /// For each input, in the order of the configuration, the sequence number of the sample this
    /// solve has to use.
    pub expected: [u64; MAX_INPUTS],
}

impl Command {
    /// A command without a window.
    #[must_use]
    pub fn new(kind: CommandKind) -> Self {
        Self { protocol: crate::PROTOCOL_VERSION, kind: kind as u32, ..Self::default() }
    }

    /// A command about a step.
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

    /// The step that the command is about.
    #[must_use]
    pub fn step(&self) -> Step {
        Step { window: self.window, iteration: self.iteration, start: self.start, end: self.end }
    }
}

/// How a command ended.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Done.
    Done = 0,
    /// Failed; the body is a [`Failure`].
    Failed = 1,
    /// The case is refused; the body is a [`crate::configuration::Refusal`].
    Refused = 2,
}

impl Status {
    /// The status with this number.
    #[must_use]
    pub fn from_number(number: u32) -> Option<Self> {
        [Self::Done, Self::Failed, Self::Refused].into_iter().find(|s| *s as u32 == number)
    }
}

/// From one participant to the coordinator.
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
    /// A [`Status`].
    pub status: u32,
    /// Sequence number of the command that is answered.
    pub sequence: u64,
    /// Work of the solve in the model's own measure.
    pub work: u64,
    /// Substeps of the solve.
    pub substeps: u32,
    /// Inner iterations of the solve.
    pub inner_iterations: u32,
    /// Mean power received through conservative inputs [W]; NaN when the model receives none.
    pub heat_received: f64,
    /// Seconds spent in the model.
    pub model_seconds: f64,
    /// Longest window that the model would take from this one's start [s]; 0 for no wish.
    pub wanted_window: f64,
}

impl Reply {
    /// An answer to the command with this sequence number.
    #[must_use]
    pub fn new(status: Status, sequence: u64) -> Self {
        Self {
            protocol: crate::PROTOCOL_VERSION,
            status: status as u32,
            sequence,
            heat_received: f64::NAN,
            ..Self::default()
        }
    }

    /// What is wrong with the quantities of a solve, if anything.
    #[must_use]
    pub fn fault(&self) -> Option<String> {
        let times = [("model_seconds", self.model_seconds), ("wanted_window", self.wanted_window)];
        for (name, seconds) in times {
            if !(seconds.is_finite() && seconds >= 0.0) {
                return Some(format!("{name} is {seconds} s"));
            }
        }
        let infinite = self.heat_received.is_infinite();
        infinite.then(|| "heat_received is infinite (NaN says that there is none)".to_owned())
    }

    /// With the report of a solve.
    #[must_use]
    pub fn with_report(mut self, report: &StepReport) -> Self {
        self.work = report.work;
        self.substeps = report.substeps;
        self.inner_iterations = report.inner_iterations;
        self.heat_received = report.heat_received.unwrap_or(f64::NAN);
        self.wanted_window = report.wanted_window.unwrap_or(0.0);
        self
    }
}

/// How far a participant is with the command that it works on, for its heartbeat.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, FromBytes, Immutable, IntoBytes, KnownLayout)]
pub struct ProgressReport {
    /// Sequence number of the command.
    pub sequence: u64,
    /// What is done, in the participant's own measure.
    pub done: u64,
    /// What there is to do, in the same measure; 0 if nobody knows.
    pub of: u64,
    /// What is being done, in a word ("factorising").
    pub what: Label<32>,
}

/// "37 of 60 factorising"; whatever the participant wrote, it is one line.
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

/// Stands before the values of every field: a field never travels unlabelled.
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
    /// End of it [s].
    pub end: f64,
    /// Counts the samples of this topic from 1.
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

/// Body of `Connect`: the topics to open.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Topics {
    /// One for each input, in the order of the configuration.
    pub inputs: Vec<Topic>,
    /// One for each output and observed field.
    pub outputs: Vec<Topic>,
    /// Longest time to wait for the other side's ports [s].
    pub deadline: f64,
    /// How inputs vary within a window.
    #[serde(default)]
    pub interpolation: Interpolation,
    /// The grids of this participant whose geometry it has to publish whenever they move, and those
    /// of its volumes that a field of the run is on.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub geometry: Vec<GeometryTopic>,
    /// Keys of this participant's summary whose values it replies with to `Accept` with [`FIGURES`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub figures: Vec<String>,
}

/// How the inputs with consistent mapping vary within a window. What is mapped conservatively is a
/// mean over the window, and does not vary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Interpolation {
    /// They have the values of the window's end throughout.
    #[default]
    Constant,
    /// They go in a straight line from the accepted values at its start to those at its end.
    Linear,
}

/// A service that carries one field.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Topic {
    /// Name of the field.
    pub field: String,
    /// Name of the service.
    pub service: String,
    /// The grid of the values.
    pub grid: crate::grid::Grid,
    /// Number of subscribers that every sample has to reach.
    pub subscribers: usize,
    /// The service that carries the geometry of the grid, if it may move. Samples of the field name
    /// its revision; one that rises has been on this service before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub geometry: Option<String>,
}

/// A service that carries the geometry of one grid: a [`crate::field::GEOMETRY`] behind a
/// [`FieldHeader`] with the name of the grid and its new revision, whenever it has moved.
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
    /// What went wrong.
    pub error: String,
}

/// Body of `Save` and `Restore`.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct StateFile {
    /// Where the state is written or read.
    pub path: std::path::PathBuf,
    /// What to publish after `Restore`, every output that is published in each iteration; empty
    /// for `Save`.
    #[serde(default)]
    pub outputs: Vec<OutputFile>,
    /// For `Restore`, the surfaces of [`Topics::geometry`] as they were in the command's step, on which
    /// the outputs are.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub geometry: Vec<crate::grid::Grid>,
}

/// The values of an output in a file.
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
    /// Seconds spent in the model over the run, building it included.
    pub model_seconds: f64,
    /// Largest resident memory of the process [byte]; 0 where it cannot be known.
    pub peak_rss_bytes: u64,
    /// Processor seconds of the process, in itself and in the kernel; 0 where they cannot be known.
    #[serde(default)]
    pub cpu_seconds: f64,
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
        assert_eq!((size_of::<Reply>(), align_of::<Reply>()), (56, 8));
        let offsets = [
            offset_of!(Reply, protocol),
            offset_of!(Reply, status),
            offset_of!(Reply, sequence),
            offset_of!(Reply, work),
            offset_of!(Reply, substeps),
            offset_of!(Reply, inner_iterations),
            offset_of!(Reply, heat_received),
            offset_of!(Reply, model_seconds),
            offset_of!(Reply, wanted_window),
        ];
        assert_eq!(offsets, [0, 4, 8, 16, 24, 28, 32, 40, 48]);
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

    /// A participant that knows of no moving grids is informed of none.
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
        assert_eq!(numbers, [1, 2, 3, 4, 5, 6, 7, 8, 9]);
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
