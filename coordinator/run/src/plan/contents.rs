//! Content of a plan.

use crate::deadlines::Deadlines;
use crate::program::Program;
use crate::warnings::Warning;
use case::Case;
use contract::bodies::Bodies;
use contract::configuration::{Configuration, Layout, Mode};
use contract::description::Description;
use contract::diagram::Diagram;
use contract::field::{FieldKind, GEOMETRY};
use contract::figure::FigureSpec;
use contract::grid::Grid;
use contract::message::Interpolation;
use coupling::ParticipantIndex;
use coupling::accelerate::Rule;
use coupling::map::{Coverage, MapError, Method};
use coupling::settings::{Acceleration, Implicit, Scheme};
use coupling::windows::Windows;
use proto::transport::FIELD_SLOTS;
use std::sync::Arc;
use typed_index_collections::TiVec;

/// Everything that a run needs to know before it starts.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Short name of the case.
    pub name: String,
    /// Title of the case, in one line.
    pub title: Option<String>,
    /// The bodies in contact, if a participant needs them.
    pub bodies: Option<Bodies>,
    /// Steady or transient.
    pub mode: Mode,
    /// Windows in time.
    pub windows: Windows,
    /// Whether a window without an answer is skipped; otherwise it ends the run.
    pub skips: bool,
    /// Coupling scheme, and the reason for the choice.
    pub scheme: SchemeChoice,
    /// Settings of an implicit scheme.
    pub implicit: Implicit,
    /// Variation of the inputs within a window.
    pub interpolation: Interpolation,
    /// Participants that run, in the order in which data flows.
    pub participants: TiVec<ParticipantIndex, Participant>,
    /// Participants of the case that do not run, with the reason.
    pub idle: Vec<(String, String)>,
    /// Fields that exist at run time.
    pub fields: Vec<Field>,
    /// Values of the case that are given during the run.
    pub live: Vec<LiveValue>,
    /// Figures of the summary, with the names of the bodies.
    pub figures: Vec<FigureSpec>,
    /// Diagrams of the figures.
    pub diagrams: Vec<Diagram>,
    /// Fields that are mapped, where both grids are known.
    pub mappings: Vec<PlannedMapping>,
    /// Warnings about the case and its plan.
    pub warnings: Vec<Warning>,
    /// Every effect that some participant offers.
    pub effects: Vec<Effect>,
    /// Windows between outputs; `None` writes only the last window.
    pub output_every: Option<u64>,
    /// Windows between checkpoints; `None` writes no checkpoint.
    pub checkpoint_every: Option<u64>,
    /// Limits of the waits.
    pub deadlines: Deadlines,
    /// Largest shared memory that the run may take [byte].
    pub shared_memory_limit: Option<u64>,
}

/// The coupling scheme of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SchemeChoice {
    /// The scheme; never `Auto`.
    pub scheme: Scheme,
    /// Reason for the choice.
    pub reason: String,
}

/// A participant of the run.
#[derive(Clone, Debug)]
pub struct Participant {
    /// Role it plays.
    pub role: String,
    /// Program that is started.
    pub program: Program,
    /// The participant is started by hand; the run waits for it.
    pub attach: bool,
    /// Description given by the program.
    pub description: Arc<Description>,
    /// Configuration sent to the participant; the grids of the inputs are filled in as they become
    /// known.
    pub configuration: Configuration,
    /// Keys of the figures that the participant is asked for after each accepted window.
    pub figures: Vec<String>,
    /// Estimate of the run, if the participant gives one.
    pub estimate: Option<Layout>,
}

impl Participant {
    /// Returns the processor seconds that the participant expects for a run over these windows,
    /// each solved `solves` times. The result is 0 without an estimate. An unknown number of
    /// windows counts as one.
    #[must_use]
    pub fn expected_seconds(&self, windows: &Windows, solves: f64) -> f64 {
        self.estimate.as_ref().map_or(0.0, |layout| {
            let each = layout.solve_seconds * windows.count().unwrap_or(1) as f64;
            layout.build_seconds + solves * (each + layout.seconds_per_second * windows.end())
        })
    }
}

/// A field that exists at run time.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Kind of the field.
    pub kind: FieldKind,
    /// Index of the participant that sends the field.
    pub producer: ParticipantIndex,
    /// Indices of the consumers; empty for a field that is only observed.
    pub consumers: Vec<ParticipantIndex>,
    /// Consumers that subscribe to the coordinator's iterate of the field, not to the producer.
    pub fed_back: Vec<ParticipantIndex>,
    /// Mapping method for consumers whose grid does not match the producer's.
    /// `None` for the one suited to the grids.
    pub method: Option<Method>,
    /// Whether the case wants the field written.
    pub wanted: bool,
}

impl Field {
    /// Returns whether the field has no consumer. Such a field is published only for accepted
    /// windows that are written.
    #[must_use]
    pub fn observed_only(&self) -> bool {
        self.consumers.is_empty()
    }
}

/// A field that is mapped for one of its consumers.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedMapping {
    /// Index of the field in the plan.
    pub field: usize,
    /// Participant for which the field is mapped.
    pub consumer: ParticipantIndex,
    /// Number of elements of the producer's grid and of the consumer's.
    pub elements: [usize; 2],
    /// Mapping method between them.
    pub method: Method,
    /// Coverage of each grid by the other, or the reason why they cannot be mapped.
    pub coverage: Result<Coverage, MapError>,
}

/// A value of the case that is given during the run.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveValue {
    /// Field that carries the value, named like its dotted key.
    pub kind: FieldKind,
    /// First value, in SI units.
    pub first: f64,
    /// Lower and upper limit, in SI units.
    pub limits: [f64; 2],
    /// Participant that sends the value as a field of the run; `None`: the coordinator sends it.
    pub provider: Option<ParticipantIndex>,
    /// Indices of the participants that read the value.
    pub readers: Vec<ParticipantIndex>,
}

/// An effect that some participant offers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Effect {
    /// Name in the case file.
    pub name: String,
    /// Whether the case names the effect.
    pub active: bool,
    /// Roles of the participants in the effect.
    pub roles: Vec<String>,
    /// Law of the effect.
    pub law: String,
}

impl Plan {
    /// Returns the name of a field or grid for display.
    #[must_use]
    pub fn shown(&self, name: &str) -> String {
        self.bodies.as_ref().map_or_else(|| name.to_owned(), |bodies| bodies.shown(name))
    }

    /// Returns the acceleration method; [`Acceleration::None`] for an explicit scheme.
    #[must_use]
    pub fn acceleration(&self) -> Acceleration {
        match self.scheme.scheme.is_implicit() {
            true => self.implicit.acceleration,
            false => Acceleration::None,
        }
    }

    /// Returns whether a field is not iterated, but has tolerances of its own in an implicit
    /// scheme.
    #[must_use]
    pub fn is_only_measured(&self, field: &Field) -> bool {
        self.scheme.scheme.is_implicit()
            && field.fed_back.is_empty()
            && self.implicit.fields.contains_key(&field.kind.name)
    }

    /// Returns the size of the secant columns that the acceleration of an implicit scheme may
    /// store. Returns `None` if the method stores none, or if a grid of the coupling data is
    /// unknown.
    #[must_use]
    pub fn accelerator_history(&self) -> Option<History> {
        let fed_back = self.fields.iter().filter(|field| !field.fed_back.is_empty());
        let bytes = fed_back.map(|field| self.sample_bytes(field)).sum::<Option<u64>>()?;
        let length = bytes / 8;
        let columns = (self.implicit.max_columns as u64).min(length);
        Rule::of(self.acceleration()).map(|_| History { columns, length })
    }

    /// Returns the grids of a participant's layout whose geometry is sent and that a field of the
    /// run uses, either as it is sent or as it is wanted.
    pub fn travelling<'a>(
        &'a self,
        one: ParticipantIndex,
        layout: &'a Layout,
    ) -> impl Iterator<Item = &'a Grid> {
        let is_used = move |grid: &Grid| {
            self.fields.iter().any(|field| {
                let name = &field.kind.name;
                let sent = || layout.grid_of(name) == Some(grid);
                let wanted = || layout.input_grid(name) == Some(grid);
                field.producer == one && sent() || field.consumers.contains(&one) && wanted()
            })
        };
        layout.grids.iter().filter(move |grid| layout.moves(grid) && is_used(grid))
    }

    /// Returns the size of a sample of a field [byte], if its grid is known.
    #[must_use]
    pub fn sample_bytes(&self, field: &Field) -> Option<u64> {
        let layout = self.participants[field.producer].estimate.as_ref()?;
        let grid = layout.grid_of(&field.kind.name)?;
        Some(sample_bytes(grid.points(), field.kind.components))
    }
}

/// Memory of an accelerator: two vectors of all coupling data for each secant column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct History {
    /// Largest number of secant columns.
    pub columns: u64,
    /// Number of values in a vector.
    pub length: u64,
}

impl History {
    /// Returns the memory of the columns [byte].
    #[must_use]
    pub fn bytes(&self) -> u64 {
        2 * 8 * self.columns * self.length
    }
}

/// Returns the size of a sample [byte].
#[must_use]
pub fn sample_bytes(points: usize, components: u32) -> u64 {
    points as u64 * u64::from(components) * 8
}

/// Returns the size of the geometry of a grid [byte].
#[must_use]
pub fn geometry_bytes(grid: &Grid) -> u64 {
    sample_bytes(grid.geometry_points(), GEOMETRY.components)
}

/// Returns the shared memory of the topic of one field [byte]: slots with their headers, the
/// service and its ports.
#[must_use]
pub fn topic_bytes(sample: u64) -> u64 {
    const PER_SLOT: u64 = 512;
    const PER_TOPIC: u64 = 64 * 1024;
    FIELD_SLOTS * (sample + PER_SLOT) + PER_TOPIC
}

/// A case and its plan.
#[derive(Debug)]
pub struct Planned {
    /// The validated case.
    pub case: Case,
    /// The plan.
    pub plan: Plan,
}
