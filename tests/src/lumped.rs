//! Two participants that heat a lumped capacity: `source` sends a flux that decreases as the
//! temperature of `body` rises,
//!
//! C ϑ′ = F(t) A (1 − gϑ) − kϑ, ϑ(0) = 0,
//!
//! with F = `flux_before` up to `step_at` and `flux_after` afterwards. Both pieces have the closed
//! form ϑ = ϑ_∞ + (ϑ_0 − ϑ_∞) exp(−(FAg + k) t/C), ϑ_∞ = FA/(FAg + k).
//!
//! The source sends the mean of its flux over the window, from `substeps` midpoints; there it uses
//! the temperature as it varies within the window. The body takes `substeps` steps of the
//! trapezoidal rule. Both record their own heat. `body.points` gives the body its own grid with
//! this number of elements on the same surface; it receives the flux on that grid. The model
//! `split` is the same problem with the flux sent as two fields.

use proto::accuracy::Accuracy;
use proto::configuration::{Configuration, FieldOnGrid, Layout, Refusal};
use proto::description::{Description, KeySpec, ModelSpec};
use proto::field::{Body, FieldSpec, Mapping};
use proto::grid::{Grid, Structured};
use proto::model::{
    Inputs, Model, Outputs, Setup, Solver, StateError, Step, StepError, StepReport,
};
use proto::params::Params;
use proto::state::{read_numbers, write_numbers};
use std::io::{self, Read, Write};

/// Flux sent by `source` \[W/m²\].
pub const SOURCE_FLUX: FieldSpec = FieldSpec {
    name: "source_flux",
    unit: "W/m2",
    components: 1,
    mapping: Mapping::Conservative,
    body: Body::Interface,
    meaning: "mean over the window of the flux into the body",
};
/// Second part of the flux in the model `split` \[W/m²\].
pub const SECOND_FLUX: FieldSpec =
    FieldSpec { name: "second_flux", meaning: "the rest of the flux into the body", ..SOURCE_FLUX };
/// Temperature sent by `body` \[K\].
pub const BODY_TEMPERATURE: FieldSpec = FieldSpec {
    name: "body_temperature",
    unit: "K",
    components: 1,
    mapping: Mapping::Consistent,
    body: Body::Interface,
    meaning: "temperature rise at the end of the window",
};

/// Returns the fields that carry the flux, with the share of each.
fn fluxes(model: &str) -> &'static [(FieldSpec, f64)] {
    match model {
        "split" => &[(SOURCE_FLUX, 0.75), (SECOND_FLUX, 0.25)],
        _ => &[(SOURCE_FLUX, 1.0)],
    }
}

/// Number of elements of the surface.
const POINTS: usize = 4;
/// Flux before the first window \[W/m²\]; used only if both participants solve in parallel.
const FIRST_FLUX: f64 = 0.5;
/// Side of an element \[m\]; the surface has 1 m².
const SIDE: f64 = 0.5;

/// Surface divided into `points` elements along x.
fn surface(points: usize) -> Grid {
    let length = POINTS as f64 * SIDE / points as f64;
    let first = 0.5 * (length - SIDE);
    Grid::structured("surface", Structured::contact_plane(first, 0.0, length, SIDE, points, 1))
}

/// Constants of the problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Problem {
    /// C \[J/K\].
    pub capacity: f64,
    /// k \[W/K\].
    pub loss: f64,
    /// g \[1/K\].
    pub gain: f64,
    /// F up to the step \[W/m²\].
    pub flux_before: f64,
    /// F after the step \[W/m²\].
    pub flux_after: f64,
    /// Time of the step \[s\].
    pub step_at: f64,
}

impl Problem {
    /// Exact ϑ(t) \[K\].
    #[must_use]
    pub fn temperature(&self, t: f64) -> f64 {
        let piece = |flux: f64, from: f64, t: f64| {
            let (rate, end) = ((flux * self.gain + self.loss) / self.capacity, self.limit(flux));
            end + (from - end) * (-rate * t).exp()
        };
        let before = piece(self.flux_before, 0.0, t.min(self.step_at));
        if t <= self.step_at { before } else { piece(self.flux_after, before, t - self.step_at) }
    }

    /// Limit ϑ_∞ under a flux \[K\].
    fn limit(&self, flux: f64) -> f64 {
        flux / (flux * self.gain + self.loss)
    }

    /// Mean of F over an interval \[W/m²\].
    fn flux(&self, start: f64, end: f64) -> f64 {
        let before = ((self.step_at - start) / (end - start)).clamp(0.0, 1.0);
        before * self.flux_before + (1.0 - before) * self.flux_after
    }

    /// Larger of the two limits ϑ_∞ \[K\], used to scale errors.
    fn scale(&self) -> f64 {
        self.limit(self.flux_before).max(self.limit(self.flux_after))
    }

    fn keys() -> Vec<KeySpec> {
        let number = |name: &str, default: f64, help: &str| {
            KeySpec::number(&format!("lumped.{name}"), help).at_least(0.0).default_value(default)
        };
        vec![
            number("capacity", 1.0, "heat capacity of the body [J/K]").above(0.0),
            number("loss", 1.0, "heat lost for each kelvin [W/K]").above(0.0),
            number("gain", 0.5, "part of the flux lost for each kelvin [1/K]"),
            number("flux_before", 1.0, "flux before the step [W/m2]"),
            number("flux_after", 3.0, "flux after the step [W/m2]"),
            number("step_at", 1.0, "time of the step [s]"),
        ]
    }

    fn read(case: &Params) -> Result<Self, Refusal> {
        let number = |name: &str| case.number(&format!("lumped.{name}"));
        Ok(Self {
            capacity: number("capacity")?,
            loss: number("loss")?,
            gain: number("gain")?,
            flux_before: number("flux_before")?,
            flux_after: number("flux_after")?,
            step_at: number("step_at")?,
        })
    }
}

/// Participant of the lumped pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lumped {
    /// Sends the flux.
    Source,
    /// Answers with the temperature.
    Body,
}

impl Lumped {
    fn role(self) -> &'static str {
        match self {
            Self::Source => "source",
            Self::Body => "body",
        }
    }

    fn sends(self, model: &str) -> Vec<FieldSpec> {
        match self {
            Self::Source => fluxes(model).iter().map(|(field, _)| *field).collect(),
            Self::Body => vec![BODY_TEMPERATURE],
        }
    }

    fn receives(self, model: &str) -> Vec<FieldSpec> {
        match self {
            Self::Source => vec![BODY_TEMPERATURE],
            Self::Body => Self::Source.sends(model),
        }
    }

    fn model(self, name: &str, summary: &str) -> ModelSpec {
        let names = |fields: Vec<FieldSpec>| fields.iter().map(|f| f.name.to_owned()).collect();
        ModelSpec {
            name: name.to_owned(),
            summary: summary.to_owned(),
            source: "an ordinary differential equation with a closed form".to_owned(),
            steady: false,
            transient: true,
            rewinds: true,
            varies_step: true,
            consumes: names(self.receives(name)),
            provides: names(self.sends(name)),
            keys: Vec::new(),
            accuracy: Accuracy::default(),
        }
    }
}

impl Solver for Lumped {
    fn description(&self) -> Description {
        let key = |name: &str| format!("{}.{name}", self.role());
        let mut keys = Problem::keys();
        keys.push(
            KeySpec::integer(&key("substeps"), "steps within a window")
                .at_least(1.0)
                .default_value(1),
        );
        if *self == Self::Body {
            let help = "elements of its own grid; absent: the source's";
            keys.push(KeySpec::integer(&key("points"), help).at_least(1.0));
            let help = "part of the heat that it receives and does not report";
            keys.push(KeySpec::number(&key("hides"), help).default_value(0.0));
            let help = "it reports the heat that it receives";
            keys.push(KeySpec::flag(&key("reports"), help).default_value(true));
        }
        if *self == Self::Source {
            let help = "it wants a window to end at its step";
            keys.push(KeySpec::flag(&key("announce"), help).default_value(false));
        }
        Description {
            protocol: proto::PROTOCOL_VERSION,
            name: format!("toy-{}", self.role()),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            role: self.role().to_owned(),
            standalone: true,
            estimates: true,
            advises: false,
            reusable: true,
            build: None,
            models: vec![
                self.model("lumped", "one heat capacity and what heats it"),
                self.model("split", "the same, with the flux in two fields"),
            ],
            effects: Vec::new(),
            keys,
            fields: [SOURCE_FLUX, SECOND_FLUX, BODY_TEMPERATURE].map(|f| f.kind()).into(),
            figures: Vec::new(),
            diagrams: Vec::new(),
            renamed: Vec::new(),
        }
    }

    fn configure(&self, configuration: &Configuration) -> Result<Setup, Refusal> {
        let case = &configuration.case;
        let own = *self == Self::Body && case.has("body.points");
        let points = if own { case.integer("body.points")? as usize } else { POINTS };
        let on_grid = |fields: Vec<FieldSpec>| -> Vec<FieldOnGrid> {
            let one = |f: FieldSpec| FieldOnGrid { field: f.name.into(), grid: "surface".into() };
            fields.into_iter().map(one).collect()
        };
        let flag = |key: &str| case.get(key).and_then(serde_json::Value::as_bool);
        let model = &configuration.model;
        let hides = if *self == Self::Body { case.number("body.hides")? } else { 0.0 };
        let setup = LumpedSetup {
            part: *self,
            problem: Problem::read(case)?,
            substeps: case.integer(&format!("{}.substeps", self.role()))? as u32,
            announce: flag("source.announce").unwrap_or(false),
            fluxes: fluxes(model),
            reported: flag("body.reports").unwrap_or(true).then_some(1.0 - hides),
        };
        let layout = Layout {
            grids: vec![surface(points)],
            fields: on_grid(self.sends(model)),
            inputs: if own { on_grid(self.receives(model)) } else { Vec::new() },
            ..Layout::default()
        };
        Ok(Setup::new(layout, |_| {
            let (accepted, trial) = (Books::default(), Books::default());
            Ok(Box::new(LumpedModel { setup, accepted, trial }))
        }))
    }
}

#[derive(Clone, Debug)]
struct LumpedSetup {
    part: Lumped,
    problem: Problem,
    substeps: u32,
    announce: bool,
    fluxes: &'static [(FieldSpec, f64)],
    /// Share of the received heat that is reported; `None` for no report.
    reported: Option<f64>,
}

/// State of the model, with its record of heat.
#[derive(Clone, Copy, Debug, Default)]
struct Books {
    /// ϑ \[K\], for the body.
    temperature: f64,
    /// Heat sent or received in total \[J\].
    heat: f64,
    /// Heat sent or received in the last window \[J\].
    in_window: f64,
    /// Heat lost to the surroundings \[J\], for the body.
    lost: f64,
    /// Largest error of ϑ at the end of an accepted window, relative to the largest ϑ_∞, for the
    /// body.
    error: f64,
}

struct LumpedModel {
    setup: LumpedSetup,
    accepted: Books,
    trial: Books,
}

impl LumpedModel {
    /// Mean flux over the window \[W/m²\], while the temperature varies linearly between two
    /// values.
    fn mean_flux(&self, step: &Step, from: f64, to: f64) -> f64 {
        let LumpedSetup { problem, substeps, .. } = &self.setup;
        let length = step.duration() / f64::from(*substeps);
        let of = |index: u32| {
            let start = step.start + f64::from(index) * length;
            let middle = (f64::from(index) + 0.5) / f64::from(*substeps);
            let temperature = from + middle * (to - from);
            problem.flux(start, start + length) * (1.0 - problem.gain * temperature)
        };
        (0..*substeps).map(of).sum::<f64>() / f64::from(*substeps)
    }

    /// Advances the body by the trapezoidal rule under a constant power \[W\].
    fn heat_up(&self, step: &Step, power: f64) -> Books {
        let LumpedSetup { problem: Problem { capacity, loss, .. }, substeps, .. } = self.setup;
        let length = step.duration() / f64::from(substeps);
        let mut books = Books { in_window: 0.0, ..self.accepted };
        for _ in 0..substeps {
            let last = books.temperature;
            books.in_window += power * length;
            let (stored, half) = (capacity / length, 0.5 * loss);
            books.temperature = (last * (stored - half) + power) / (stored + half);
            books.lost += half * (last + books.temperature) * length;
        }
        books.heat += books.in_window;
        let exact = self.setup.problem.temperature(step.end);
        let error = (books.temperature - exact).abs() / self.setup.problem.scale();
        Books { error: books.error.max(error), ..books }
    }
}

impl Model for LumpedModel {
    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let missing = |field: &FieldSpec| StepError::MissingInput { field: field.name.to_owned() };
        let mut report = StepReport { substeps: self.setup.substeps, ..StepReport::default() };
        match self.setup.part {
            Lumped::Source => {
                let temperature = inputs.get(&BODY_TEMPERATURE);
                let to = temperature.ok_or_else(|| missing(&BODY_TEMPERATURE))?.values[0];
                let from = inputs.start(&BODY_TEMPERATURE).map_or(to, |start| start[0]);
                let flux = self.mean_flux(step, from, to);
                for (field, part) in self.setup.fluxes {
                    // Non-uniform, so that the integral differs from any single value times the
                    // area.
                    let sent = outputs.get(field).ok_or_else(|| missing(field))?;
                    for (index, value) in sent.iter_mut().enumerate() {
                        *value = part * flux * (0.7 + 0.2 * index as f64);
                    }
                }
                let heat = flux * (POINTS as f64 * SIDE * SIDE) * step.duration();
                self.trial = Books { heat: self.accepted.heat + heat, ..self.accepted };
                let ahead = self.setup.problem.step_at - step.start;
                let within = ahead > 1e-9 * step.end && ahead < step.duration() * (1.0 - 1e-9);
                report.wanted_window = (self.setup.announce && within).then_some(ahead);
            }
            Lumped::Body => {
                let mut power = 0.0;
                for (field, _) in self.setup.fluxes {
                    let values = inputs.get(field).ok_or_else(|| missing(field))?.values;
                    let area = POINTS as f64 * SIDE * SIDE / values.len() as f64;
                    power += values.iter().map(|q| q * area).sum::<f64>();
                }
                self.trial = self.heat_up(step, power);
                let place = outputs.get(&BODY_TEMPERATURE);
                place.ok_or_else(|| missing(&BODY_TEMPERATURE))?.fill(self.trial.temperature);
                let mean = self.trial.in_window / step.duration();
                report.received_power = self.setup.reported.map(|part| part * mean);
            }
        }
        Ok(report)
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        for field in [SOURCE_FLUX, SECOND_FLUX, BODY_TEMPERATURE] {
            if let Some(values) = outputs.get(&field) {
                values.fill(if field == BODY_TEMPERATURE { 0.0 } else { FIRST_FLUX });
            }
        }
    }

    fn accept(&mut self) {
        self.accepted = self.trial;
    }

    fn observe(&mut self, _outputs: &mut dyn Outputs) {}

    fn summary(&self) -> serde_json::Value {
        let Books { temperature, heat, lost, error, .. } = self.accepted;
        match self.setup.part {
            Lumped::Source => serde_json::json!({ "source": { "sent_j": heat } }),
            Lumped::Body => serde_json::json!({ "body": {
                "temperature_k": temperature,
                "received_j": heat,
                "lost_j": lost,
                "stored_j": self.setup.problem.capacity * temperature,
                "largest_error": error,
            } }),
        }
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        let Books { temperature, heat, lost, error, .. } = self.accepted;
        write_numbers(into, &[temperature, heat, lost, error])
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        let mut numbers = [0.0; 4];
        read_numbers(from, &mut numbers)?;
        let [temperature, heat, lost, error] = numbers;
        self.accepted = Books { temperature, heat, lost, error, in_window: 0.0 };
        Ok(())
    }
}
