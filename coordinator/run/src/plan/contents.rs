//! What a plan says.

use crate::deadlines::Deadlines;
use crate::programs::Program;
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
use typed_index_collections::TiVec;

/// What will run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Short name of the case.
    pub name: String,
    /// One line for people.
    pub title: Option<String>,
    /// The bodies in contact, where a participant asks for them.
    pub bodies: Option<Bodies>,
    /// Steady or transient.
    pub mode: Mode,
    /// Windows in time.
    pub windows: Windows,
    /// A window without an answer is passed over; otherwise it ends the run.
    pub skips: bool,
    /// Coupling scheme, and why this one.
    pub scheme: SchemeChoice,
    /// How an implicit scheme iterates.
    pub implicit: Implicit,
    /// How inputs vary within a window.
    pub interpolation: Interpolation,
    /// Participants that run, in the order in which data flows.
    pub participants: TiVec<ParticipantIndex, Participant>,
    /// Participants that the case has but that do not run, and why.
    pub idle: Vec<(String, String)>,
    /// Fields that exist at run time.
    pub fields: Vec<Field>,
    /// Values of the case that are given as the run goes.
    pub live: Vec<LiveValue>,
    /// The figures of the summary, with the names of the bodies.
    pub figures: Vec<FigureSpec>,
    /// Diagrams of them.
    pub diagrams: Vec<Diagram>,
    /// Fields that are mapped, as far as their grids are known.
    pub mappings: Vec<PlannedMapping>,
    /// Warnings about the case and its plan.
    pub warnings: Vec<Warning>,
    /// Every effect that some participant offers.
    pub effects: Vec<Effect>,
    /// Windows between outputs; `None` for the last window only.
    pub output_every: Option<u64>,
    /// Windows between checkpoints; `None` for none.
    pub checkpoint_every: Option<u64>,
    /// Limits of the waits.
    pub deadlines: Deadlines,
    /// Most shared memory that the run may take [byte].
    pub shared_memory_limit: Option<u64>,
}

/// The coupling scheme of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SchemeChoice {
    /// The scheme; never `Auto`.
    pub scheme: Scheme,
    /// Why it was chosen.
    pub reason: String,
}

/// One participant of the run.
#[derive(Clone, Debug)]
pub struct Participant {
    /// Role it plays.
    pub role: String,
    /// What is started.
    pub program: Program,
    /// Started by hand, and waited for.
    pub attach: bool,
    /// What it says of itself.
    pub description: Description,
    /// Its configuration; the grids of the inputs are filled in as they become known.
    pub configuration: Configuration,
    /// Keys of the figures that it is asked for whenever a window is accepted.
    pub figures: Vec<String>,
    /// What it expects, if it estimates.
    pub estimate: Option<Layout>,
}

impl Participant {
    /// Processor seconds that it expects of a run over these windows, each solved so many times; one that
    /// expects nothing counts as 0, and windows that nobody can count as one.
    #[must_use]
    pub fn expected_seconds(&self, windows: &Windows, solves: f64) -> f64 {
        self.estimate.as_ref().map_or(0.0, |layout| {
            let each = layout.solve_seconds * windows.count().unwrap_or(1) as f64;
            layout.build_seconds + solves * (each + layout.seconds_per_second * windows.end())
        })
    }
}

/// One field that exists at run time.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Kind of the field.
    pub kind: FieldKind,
    /// Index of the participant that sends it.
    pub producer: ParticipantIndex,
    /// Indices of the participants that consume it; empty for a field that is only observed.
    pub consumers: Vec<ParticipantIndex>,
    /// Those of the consumers that subscribe to the coordinator's iterate of it, not to the
    /// producer.
    pub fed_back: Vec<ParticipantIndex>,
    /// How it is mapped for those of the consumers whose grid does not match the producer's.
    pub method: Method,
    /// The case wants it written out.
    pub wanted: bool,
}

impl Field {
    /// Nobody consumes it: it is published only for accepted windows that are written out.
    #[must_use]
    pub fn observed_only(&self) -> bool {
        self.consumers.is_empty()
    }
}

/// A field that is mapped for one of its consumers.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedMapping {
    /// Index among the fields of the plan.
    pub field: usize,
    /// The participant that it is mapped for.
    pub consumer: ParticipantIndex,
    /// Elements of the producer's and of the consumer's grid.
    pub elements: [usize; 2],
    /// Coverage of the grids by each other, or the reason why they cannot be mapped.
    pub coverage: Result<Coverage, MapError>,
}

/// A value of the case that is given from outside as the run goes.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveValue {
    /// The field as which it travels, named like its dotted key.
    pub kind: FieldKind,
    /// Its first value, in SI units.
    pub first: f64,
    /// Least and largest value, in SI units.
    pub limits: [f64; 2],
    /// The participant that sends it, among the fields of the run; absent: the coordinator does.
    pub provider: Option<ParticipantIndex>,
    /// Indices of the participants that read it.
    pub readers: Vec<ParticipantIndex>,
}

/// An effect that some participant offers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Effect {
    /// Name in the case file.
    pub name: String,
    /// Named in the case.
    pub active: bool,
    /// The participants in it.
    pub roles: Vec<String>,
    /// The law.
    pub law: String,
}

impl Plan {
    /// What a person reads for the name of a field or grid.
    #[must_use]
    pub fn shown(&self, name: &str) -> String {
        self.bodies.as_ref().map_or_else(|| name.to_owned(), |bodies| bodies.shown(name))
    }

    /// How the next iterate is chosen.
    #[must_use]
    pub fn acceleration(&self) -> Acceleration {
        match self.scheme.scheme.is_implicit() {
            true => self.implicit.acceleration,
            false => Acceleration::None,
        }
    }

    /// The secant columns that the acceleration of an implicit scheme may keep; `None` for one that
    /// keeps none, or if a grid of the coupling data is not known.
    #[must_use]
    pub fn accelerator_history(&self) -> Option<History> {
        let fed_back = self.fields.iter().filter(|field| !field.fed_back.is_empty());
        let bytes = fed_back.map(|field| self.sample_bytes(field)).sum::<Option<u64>>()?;
        let length = bytes / 8;
        let columns = (self.implicit.max_columns as u64).min(length);
        Rule::of(self.acceleration()).map(|_| History { columns, length })
    }

    /// The grids of a participant's layout that a field of the run is on, or is wanted on, and whose
    /// geometry travels.
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

    /// Bytes of one sample of a field, as far as its grid is known.
    #[must_use]
    pub fn sample_bytes(&self, field: &Field) -> Option<u64> {
        let layout = self.participants[field.producer].estimate.as_ref()?;
        let grid = layout.grid_of(&field.kind.name)?;
        Some(sample_bytes(grid.points(), field.kind.components))
    }
}

/// What an accelerator remembers: two vectors for each secant column, of all coupling data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct History {
    /// Largest number of secant columns.
    pub columns: u64,
    /// Values of a vector.
    pub length: u64,
}

impl History {
    /// Memory of the columns [byte].
    #[must_use]
    pub fn bytes(&self) -> u64 {
        2 * 8 * self.columns * self.length
    }
}

/// Bytes of one sample.
#[must_use]
pub fn sample_bytes(points: usize, components: u32) -> u64 {
    points as u64 * u64::from(components) * 8
}

/// Bytes of the geometry of a grid.
#[must_use]
pub fn geometry_bytes(grid: &Grid) -> u64 {
    sample_bytes(grid.geometry_points(), GEOMETRY.components)
}

/// Shared memory that one field's topic takes [byte]: its slots, each with headers, and what the
/// service and its ports need.
#[must_use]
pub fn topic_bytes(sample: u64) -> u64 {
    const PER_SLOT: u64 = 512;
    const PER_TOPIC: u64 = 64 * 1024;
    FIELD_SLOTS * (sample + PER_SLOT) + PER_TOPIC
}

/// The case and its plan, as most commands need them together.
#[derive(Debug)]
pub struct Planned {
    /// The case as validated.
    pub case: Case,
    /// The plan.
    pub plan: Plan,
}
