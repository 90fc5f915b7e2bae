//! The coordinator's settings: a structure for each section of a case, a field for each key.
//!
//! Settings are deserialised from checked values in SI units with defaults filled in.
//! [`super::schema`] holds names, units, ranges and help texts of the keys; it takes defaults and
//! words from here and from [`coupling::settings`].

use contract::bodies::Bodies;
use contract::configuration::{Mode, Windows};
use contract::message::Interpolation;
use contract::params::Params;
use contract::words;
use coupling::map::Mappings;
use coupling::settings::{Implicit, Scheme};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;

/// All settings of the coordinator.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub(super) struct Settings {
    pub(super) case: Heading,
    pub(super) time: Timing,
    pub(super) coupling: Coupling,
    pub(super) mapping: Mappings,
    pub(super) output: Output,
    #[serde(default)]
    pub(super) limits: Limits,
}

impl Settings {
    /// Reads the settings from checked values. Fields get their names of the contract.
    pub(super) fn read(values: &Params) -> Self {
        let settings = Self::deserialize(&values.0).expect("checked values are settings");
        match Bodies::read(values) {
            Ok(bodies) => settings.renamed(|name| bodies.named(name)),
            Err(_) => settings,
        }
    }

    fn renamed(mut self, name: impl Fn(&str) -> String) -> Self {
        self.coupling.implicit.fields = renamed(self.coupling.implicit.fields, &name);
        self.mapping.fields = renamed(self.mapping.fields, &name);
        if let OutputFields::Named(fields) = &mut self.output.fields {
            fields.iter_mut().for_each(|field| *field = name(field));
        }
        self
    }
}

fn renamed<T>(fields: BTreeMap<String, T>, name: impl Fn(&str) -> String) -> BTreeMap<String, T> {
    fields.into_iter().map(|(field, own)| (name(&field), own)).collect()
}

#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub(super) struct Heading {
    pub(super) name: String,
    pub(super) title: Option<String>,
}

words! {
    /// Kind of case in time.
    #[derive(Default)]
    pub(super) enum TimeMode {
        /// One window without duration.
        #[default]
        Steady = "steady",
        /// A steady window for each row of a table.
        Sequence = "sequence",
        /// Windows in time, from 0.
        Transient = "transient",
    }
}

impl TimeMode {
    /// Returns the mode that a model must support.
    pub(super) fn mode(self) -> Mode {
        match self {
            Self::Steady | Self::Sequence => Mode::Steady,
            Self::Transient => Mode::Transient,
        }
    }
}

words! {
    /// Values outside the times of a table.
    #[derive(Default)]
    pub(super) enum Beyond {
        /// The case is refused.
        #[default]
        Refuse = "refuse",
        /// Keep the values of the first and the last row.
        Hold = "hold",
    }
}

words! {
    /// Treatment of a sequence row without a result.
    #[derive(Default)]
    pub(super) enum OnFailure {
        /// The run ends.
        #[default]
        Stop = "stop",
        /// The row is skipped.
        Skip = "skip",
    }
}

words! {
    /// Lengths of the windows.
    #[derive(Default)]
    pub(super) enum Lengths {
        /// All windows are equal.
        #[default]
        Fixed = "fixed",
        /// Windows are as long as the error allows.
        Adaptive = "adaptive",
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default)]
pub(super) struct Time {
    pub(super) mode: TimeMode,
    pub(super) beyond: Beyond,
    pub(super) on_failure: OnFailure,
    pub(super) window: Option<f64>,
    pub(super) end: Option<f64>,
    pub(super) control: Lengths,
    pub(super) tolerance: f64,
    pub(super) window_min: Option<f64>,
    pub(super) window_max: Option<f64>,
}

impl Default for Time {
    /// Settings of a case without a `time` table.
    fn default() -> Self {
        Self {
            mode: TimeMode::default(),
            beyond: Beyond::default(),
            on_failure: OnFailure::default(),
            window: None,
            end: None,
            control: Lengths::default(),
            tolerance: 1e-3,
            window_min: None,
            window_max: None,
        }
    }
}

/// Kind of case in time, with its settings.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(from = "Time")]
pub enum Timing {
    /// One window without duration.
    Steady,
    /// A steady window for each row of a table.
    Sequence {
        /// Whether a row without a result is skipped; otherwise the row ends the run.
        skip: bool,
    },
    /// Windows in time, from 0.
    Transient {
        /// Coupling window \[s\].
        window: f64,
        /// End of the run \[s\], at least one window.
        end: f64,
        /// Lengths of the windows.
        control: Control,
    },
}

/// Control of the lengths of windows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Control {
    /// All windows have the same length.
    Fixed,
    /// Windows are as long as the error allows; the first is the shortest.
    Adaptive {
        /// Target of the relative error of the exchanged values \[-\].
        tolerance: f64,
        /// Shortest window \[s\].
        shortest: f64,
        /// Longest window \[s\].
        longest: f64,
    },
}

/// Default of the shortest adaptive window, over `time.window`: ten halvings.
const SHORTEST: f64 = 1.0 / 1024.0;

impl From<Time> for Timing {
    fn from(time: Time) -> Self {
        match (time.mode, time.window, time.end) {
            (TimeMode::Transient, Some(window), Some(end)) => {
                let control = match time.control {
                    Lengths::Fixed => Control::Fixed,
                    Lengths::Adaptive => Control::Adaptive {
                        tolerance: time.tolerance,
                        shortest: time.window_min.unwrap_or(SHORTEST * window),
                        longest: time.window_max.unwrap_or(end),
                    },
                };
                Self::Transient { window, end, control }
            }
            (TimeMode::Sequence, ..) => Self::Sequence { skip: time.on_failure == OnFailure::Skip },
            _ => Self::Steady,
        }
    }
}

impl Timing {
    /// Returns the mode, as participants know it.
    #[must_use]
    pub fn mode(&self) -> Mode {
        match self {
            Self::Steady | Self::Sequence { .. } => Mode::Steady,
            Self::Transient { .. } => Mode::Transient,
        }
    }

    /// Returns the windows of a transient case.
    #[must_use]
    pub fn windows(&self) -> Option<Windows> {
        let Self::Transient { window: usual, end, control } = *self else { return None };
        let shortest = match control {
            Control::Fixed => usual,
            Control::Adaptive { shortest, .. } => shortest.min(usual),
        };
        Some(Windows { shortest, usual, end: Some(end) })
    }
}

/// Settings of the coupling.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default)]
pub struct Coupling {
    /// Order and iteration.
    pub scheme: Scheme,
    /// Iteration of an implicit scheme.
    #[serde(flatten)]
    pub implicit: Implicit,
    /// Interpolation of inputs within a window.
    pub interpolation: Interpolation,
    /// Longest wait for one solve \[s\].
    pub solve_deadline: f64,
    /// Longest wait for a participant to start, and to answer a question before a run \[s\].
    pub start_deadline: f64,
    /// Longest wait for a model to be built \[s\].
    pub build_deadline: f64,
    /// Longest silence of a participant \[s\].
    pub heartbeat_deadline: f64,
}

impl Default for Coupling {
    /// Settings of a case without a `coupling` table.
    fn default() -> Self {
        Self {
            scheme: Scheme::default(),
            implicit: Implicit::default(),
            interpolation: Interpolation::default(),
            solve_deadline: 3600.0,
            start_deadline: 30.0,
            build_deadline: 3600.0,
            heartbeat_deadline: 30.0,
        }
    }
}

/// Memory and threads that a run may use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(default)]
pub struct Limits {
    /// Largest shared memory \[byte\]; absent: the case sets no limit.
    #[serde(deserialize_with = "bytes")]
    pub shared_memory: Option<u64>,
    /// Threads that may compute at the same time; absent: the number of cores.
    pub threads: Option<usize>,
}

/// Reads a quantity in bytes, which may be fractional.
fn bytes<'de, D: Deserializer<'de>>(from: D) -> Result<Option<u64>, D::Error> {
    // The cast saturates, and the value is at least 1.
    Option::<f64>::deserialize(from).map(|bytes| bytes.map(|bytes| bytes as u64))
}

/// Fields and checkpoints that a run writes.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct Output {
    /// Fields that are written.
    pub fields: OutputFields,
    /// Windows between outputs; absent: the last window only.
    pub every: Option<u64>,
    /// Windows between checkpoints; absent: no checkpoints.
    pub checkpoint_every: Option<u64>,
}

words! {
    /// Words accepted instead of a list of field names.
    #[derive(Default)]
    pub(super) enum OutputWord {
        /// All fields.
        #[default]
        All = "all",
        /// No field.
        None = "none",
    }
}

/// The key `output.fields`.
#[derive(Deserialize)]
#[serde(untagged)]
enum WordOrNames {
    Word(OutputWord),
    Names(Vec<String>),
}

/// Fields that a run writes.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(from = "WordOrNames")]
pub enum OutputFields {
    /// All fields.
    All,
    /// No field.
    None,
    /// Fields of these names.
    Named(Vec<String>),
}

impl From<WordOrNames> for OutputFields {
    fn from(written: WordOrNames) -> Self {
        match written {
            WordOrNames::Word(OutputWord::All) => Self::All,
            WordOrNames::Word(OutputWord::None) => Self::None,
            WordOrNames::Names(names) => Self::Named(names),
        }
    }
}

/// A participant as described by the case.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct ParticipantCase {
    /// Name of its section.
    #[serde(skip)]
    pub role: String,
    /// The chosen model.
    pub model: String,
    /// Program and arguments that start the participant; absent: the default program of the role.
    pub command: Option<Vec<String>>,
    /// Whether the user starts the participant by hand.
    pub attach: bool,
}

impl ParticipantCase {
    /// Reads the section of a role from checked values.
    pub(super) fn read(values: &Params, role: &str) -> Self {
        let section = values.get(role).expect("a section with a model");
        let read = Self::deserialize(section).expect("checked values are settings");
        Self { role: role.to_owned(), ..read }
    }
}
