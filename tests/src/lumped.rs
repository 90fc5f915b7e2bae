//! Two participants that heat one lumped capacity: `source` sends a flux that falls as the `body`
//! it heats gets warmer,
//!
//! C ϑ′ = F(t) A (1 − gϑ) − kϑ, ϑ(0) = 0,
//!
//! with F = `flux_before` up to `step_at` and `flux_after` from then on. Both pieces have the closed
//! form ϑ = ϑ_∞ + (ϑ_0 − ϑ_∞) exp(−(FAg + k) t/C), ϑ_∞ = FA/(FAg + k).
//!
//! The source sends the mean of its flux over the window, from `substeps` midpoints at which it
//! takes the temperature as it varies within the window. The body takes `substeps` steps of the
//! trapezoidal rule. Both keep their own books of heat. With `body.points` the body has a grid of
//! so many elements on the same surface, on which it wants the flux.

use proto::accuracy::Accuracy;
use proto::configuration::{Configuration, FieldOnGrid, Layout, Refusal};
use proto::description::{Description, KeySpec, ModelSpec};
use proto::field::{Body, FieldSpec, Mapping};
use proto::grid::{Grid, Structured};
use proto::model::{
    Inputs, Model, Outputs, Setup, Solver, StateBlob, StateError, Step, StepError, StepReport,
};
use proto::params::Params;

/// What `source` sends \[W/m²\].
pub const SOURCE_FLUX: FieldSpec = FieldSpec {
    name: "source_flux",
    unit: "W/m2",
    components: 1,
    mapping: Mapping::Conservative,
    body: Body::Interface,
    meaning: "mean over the window of the flux into the body",
};
/// What `body` sends \[K\].
pub const BODY_TEMPERATURE: FieldSpec = FieldSpec {
    name: "body_temperature",
    unit: "K",
    components: 1,
    mapping: Mapping::Consistent,
    body: Body::Interface,
    meaning: "temperature rise at the end of the window",
};

/// Elements of the surface.
const POINTS: usize = 4;
/// Side of an element \[m\]: the surface has 1 m².
const SIDE: f64 = 0.5;

/// The surface cut into so many elements along x.
fn surface(points: usize) -> Grid {
    let length = POINTS as f64 * SIDE / points as f64;
    let first = 0.5 * (length - SIDE);
    Grid::structured("surface", Structured::contact_plane(first, 0.0, length, SIDE, points, 1))
}

/// The constants of the problem.
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
    /// ϑ(t) \[K\].
    #[must_use]
    pub fn temperature(&self, t: f64) -> f64 {
        let piece = |flux: f64, from: f64, t: f64| {
            let (rate, end) = ((flux * self.gain + self.loss) / self.capacity, self.limit(flux));
            end + (from - end) * (-rate * t).exp()
        };
        let before = piece(self.flux_before, 0.0, t.min(self.step_at));
        if t <= self.step_at { before } else { piece(self.flux_after, before, t - self.step_at) }
    }

    /// ϑ_∞ under a flux \[K\].
    fn limit(&self, flux: f64) -> f64 {
        flux / (flux * self.gain + self.loss)
    }

    /// Mean of F over an interval \[W/m²\].
    fn flux(&self, start: f64, end: f64) -> f64 {
        let before = ((self.step_at - start) / (end - start)).clamp(0.0, 1.0);
        before * self.flux_before + (1.0 - before) * self.flux_after
    }

    /// Largest temperature that the problem can come near \[K\].
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

/// One of the two.
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

    fn sends(self) -> FieldSpec {
        match self {
            Self::Source => SOURCE_FLUX,
            Self::Body => BODY_TEMPERATURE,
        }
    }

    fn receives(self) -> FieldSpec {
        match self {
            Self::Source => BODY_TEMPERATURE,
            Self::Body => SOURCE_FLUX,
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
            models: vec![ModelSpec {
                name: "lumped".to_owned(),
                summary: "one heat capacity and what heats it".to_owned(),
                source: "an ordinary differential equation with a closed form".to_owned(),
                steady: false,
                transient: true,
                consumes: vec![self.receives().name.to_owned()],
                provides: vec![self.sends().name.to_owned()],
                keys: Vec::new(),
                accuracy: Accuracy::default(),
            }],
            effects: Vec::new(),
            keys,
            fields: vec![SOURCE_FLUX.kind(), BODY_TEMPERATURE.kind()],
        }
    }

    fn configure(&self, configuration: &Configuration) -> Result<Box<dyn Setup>, Refusal> {
        let case = &configuration.case;
        let own = *self == Self::Body && case.has("body.points");
        let points = if own { case.integer("body.points")? as usize } else { POINTS };
        let on_grid =
            |field: FieldSpec| FieldOnGrid { field: field.name.to_owned(), grid: "surface".into() };
        let announce = case.get("source.announce").and_then(serde_json::Value::as_bool);
        Ok(Box::new(LumpedSetup {
            part: *self,
            problem: Problem::read(case)?,
            substeps: case.integer(&format!("{}.substeps", self.role()))? as u32,
            announce: announce.unwrap_or(false),
            layout: Layout {
                grids: vec![surface(points)],
                fields: vec![on_grid(self.sends())],
                inputs: own.then(|| on_grid(self.receives())).into_iter().collect(),
                ..Layout::default()
            },
        }))
    }
}

#[derive(Clone, Debug)]
struct LumpedSetup {
    part: Lumped,
    problem: Problem,
    substeps: u32,
    announce: bool,
    layout: Layout,
}

impl Setup for LumpedSetup {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn build(self: Box<Self>) -> Result<Box<dyn Model>, Refusal> {
        Ok(Box::new(LumpedModel {
            setup: *self,
            accepted: Books::default(),
            trial: Books::default(),
        }))
    }
}

/// Where the model is, and what has gone through it.
#[derive(Clone, Copy, Debug, Default)]
struct Books {
    /// ϑ \[K\]; the body's.
    temperature: f64,
    /// Heat sent or received \[J\].
    heat: f64,
    /// Of that, in the last window \[J\].
    in_window: f64,
    /// Heat lost to the surroundings \[J\]; the body's.
    lost: f64,
    /// Largest error of ϑ at the end of an accepted window, over the largest ϑ_∞; the body's.
    error: f64,
}

struct LumpedModel {
    setup: LumpedSetup,
    accepted: Books,
    trial: Books,
}

impl LumpedModel {
    /// The mean flux over the window \[W/m²\], with the temperature going from one value to another.
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

    /// Steps of the trapezoidal rule under a constant power \[W\].
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
        let (receives, sends) = (self.setup.part.receives(), self.setup.part.sends());
        let missing = |field: &FieldSpec| StepError::MissingInput { field: field.name.to_owned() };
        let received = inputs.get(&receives).ok_or_else(|| missing(&receives))?;
        let sent = outputs.get(&sends).ok_or_else(|| missing(&sends))?;
        let mut report = StepReport { substeps: self.setup.substeps, ..StepReport::default() };
        match self.setup.part {
            Lumped::Source => {
                let to = received.values[0];
                let from = inputs.start(&receives).map_or(to, |start| start[0]);
                let flux = self.mean_flux(step, from, to);
                // Uneven, so that its integral is more than one value times the area.
                for (index, value) in sent.iter_mut().enumerate() {
                    *value = flux * (0.7 + 0.2 * index as f64);
                }
                let heat = flux * (POINTS as f64 * SIDE * SIDE) * step.duration();
                self.trial = Books { heat: self.accepted.heat + heat, ..self.accepted };
                let ahead = self.setup.problem.step_at - step.start;
                let within = ahead > 1e-9 * step.end && ahead < step.duration() * (1.0 - 1e-9);
                report.wanted_window = (self.setup.announce && within).then_some(ahead);
            }
            Lumped::Body => {
                let area = POINTS as f64 * SIDE * SIDE / received.values.len() as f64;
                let power = received.values.iter().map(|q| q * area).sum::<f64>();
                self.trial = self.heat_up(step, power);
                sent.fill(self.trial.temperature);
                report.heat_received = Some(self.trial.in_window / step.duration());
            }
        }
        Ok(report)
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        if let Some(values) = outputs.get(&self.setup.part.sends()) {
            values.fill(0.0);
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

    fn save(&self, into: &mut StateBlob) {
        let Books { temperature, heat, lost, error, .. } = self.accepted;
        into.0 = [temperature, heat, lost, error].iter().flat_map(|v| v.to_le_bytes()).collect();
    }

    fn restore(&mut self, from: &StateBlob) -> Result<(), StateError> {
        let ([a, b, c, d], []) = from.0.as_chunks() else {
            return Err(StateError(format!("{} bytes, not 32", from.0.len())));
        };
        let [temperature, heat, lost, error] = [a, b, c, d].map(|v| f64::from_le_bytes(*v));
        self.accepted = Books { temperature, heat, lost, error, in_window: 0.0 };
        Ok(())
    }
}
