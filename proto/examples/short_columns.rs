//! A complete thermal solver in Rust: heat conduction normal to the surface, in strips.
//!
//! T(x) = 1/(β√(πV)) ∫ q/2 dx'/√(x' − x) upstream, with q constant over elements and half of the
//! heat flowing into each body; β is a body's effusivity, V the speed of its surface through the
//! contact (Carslaw & Jaeger, Conduction of Heat in Solids, 2.9).

use proto::accuracy::Accuracy;
use proto::bodies::{self, Bodies, LOWER, UPPER};
use proto::configuration::{Configuration, FieldOnGrid, Layout, Refusal};
use proto::description::{Description, EffectSpec, KeySpec, ModelSpec};
use proto::field::{
    FRICTION_POWER, FieldSpec, LOWER_TEMPERATURE, SURFACE_SPEED, UPPER_TEMPERATURE,
};
use proto::figure::{FigureSpec, Style};
use proto::grid::{Grid, Shape};
use proto::model::{
    Inputs, Model, Outputs, Setup, Solver, StateError, Step, StepError, StepReport,
    first_non_finite,
};
use std::f64::consts::PI;
use std::io::{self, Read, Write};
use std::process::ExitCode;

const STEEL: [(&str, &str); 3] =
    [("density", "kg/m3"), ("specific_heat", "J/(kg K)"), ("conductivity", "W/(m K)")];

fn main() -> ExitCode {
    proto::participant::main(&ShortColumns)
}

struct ShortColumns;

impl Solver for ShortColumns {
    fn description(&self) -> Description {
        let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        let half = "one half each";
        let mut keys = vec![
            bodies::position_key(),
            KeySpec::name_in("bodies.*.material", "materials", "material of the body").required(),
        ];
        keys.extend(STEEL.map(|(name, unit)| {
            KeySpec::quantity(&format!("materials.*.{name}"), unit, name).required().above(0.0)
        }));
        Description {
            protocol: proto::PROTOCOL_VERSION,
            name: "short-columns".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            role: "thermal".to_owned(),
            standalone: false,
            estimates: true,
            advises: false,
            reusable: true,
            build: None,
            models: vec![ModelSpec {
                name: "short".to_owned(),
                summary: "Abel's integral".to_owned(),
                source: "Carslaw & Jaeger, Conduction of Heat in Solids, 2.9".to_owned(),
                steady: true,
                transient: false,
                rewinds: true,
                varies_step: true,
                consumes: names(&["friction_power", "surface_speed"]),
                provides: names(&["lower_temperature", "upper_temperature"]),
                keys: Vec::new(),
                accuracy: Accuracy::default(),
            }],
            effects: vec![EffectSpec {
                name: "friction_heat".to_owned(),
                law: "q/2 into each body".to_owned(),
                source: "symmetry".to_owned(),
                models: names(&["short"]),
                consumes: names(&["friction_power", "surface_speed"]),
                provides: names(&["lower_temperature", "upper_temperature"]),
                keys: vec![
                    KeySpec::choice("effects.friction_heat.partition", &["equal"], half)
                        .default_value("equal"),
                ],
                figures: Vec::new(),
            }],
            keys,
            fields: Vec::new(),
            figures: vec![
                FigureSpec::new("temperature.*.max_rise_k", "K", "temperature rise")
                    .on("*", "")
                    .style(Style::Signed)
                    .headline()
                    .rank(1),
            ],
            diagrams: Vec::new(),
            renamed: Vec::new(),
        }
    }

    fn configure(&self, configuration: &Configuration) -> Result<Setup, Refusal> {
        let case = &configuration.case;
        let bodies = Bodies::read(case)?;
        let scale = |body| {
            let material = case.text(&bodies.key(body, "material"))?;
            let product = STEEL.iter().try_fold(PI, |product, (name, _)| {
                Ok::<_, Refusal>(product * case.number(&format!("materials.{material}.{name}"))?)
            })?;
            Ok::<_, Refusal>(1.0 / product.sqrt())
        };
        let scale = [scale(UPPER)?, scale(LOWER)?];
        // The grid is unknown while planning.
        let Some(grid) = configuration.input_grid(FRICTION_POWER.name) else {
            return Ok(Setup::new(Layout::default(), |_| unreachable!("built with a grid")));
        };
        let Shape::Structured(plane) = &grid.shape else {
            let fix = "name a model whose grid is structured";
            return Err(Refusal::new("mech.model", "its grid has no rows along x", fix));
        };
        let on_it = |field: &str| FieldOnGrid { field: field.to_owned(), grid: grid.name.clone() };
        let layout = Layout {
            grids: vec![grid.clone()],
            fields: configuration
                .outputs
                .iter()
                .chain(&configuration.observed)
                .map(|f| on_it(f))
                .collect(),
            solve_seconds: 1e-9 * (plane.ni * plane.points()) as f64,
            memory_bytes: 8 * (plane.ni + plane.points()) as u64,
            ..Layout::default()
        };
        let plane = *plane;
        Ok(Setup::new(layout, move |_| {
            let root = |elements: f64| (elements * plane.dx()).max(0.0).sqrt();
            let rise = |upstream: usize| {
                let upstream = upstream as f64;
                root(upstream + 0.5) - root(upstream - 0.5)
            };
            Ok(Box::new(Running {
                bodies,
                shape: (0..plane.ni).map(rise).collect(),
                scale,
                columns: plane.ni,
                grid: Grid::structured("contact", plane),
                trial: vec![0.0; plane.points() + 2],
                accepted: vec![0.0; plane.points() + 2],
            }))
        }))
    }
}

/// A running model, with trial and accepted state.
struct Running {
    bodies: Bodies,
    /// ∫ dx'/(2√(x' − x)) over the element itself, the next one upstream, and so on [√m].
    shape: Vec<f64>,
    /// 1/(β√π) of the upper and the lower body [K m²/(W √s)].
    scale: [f64; 2],
    columns: usize,
    grid: Grid,
    /// Factors 1/(β√(πV)) of the upper and the lower body [K m^1.5/W], and the sums over the
    /// elements upstream [W/m^1.5] that they multiply.
    trial: Vec<f64>,
    accepted: Vec<f64>,
}

/// Returns the rises of a body [K], for the fields and for the summary.
fn rises(state: &[f64], body: usize) -> impl Iterator<Item = f64> {
    let (factors, sums) = state.split_at(2);
    sums.iter().map(move |sum| factors[body] * sum)
}

fn write_out(state: &[f64], outputs: &mut dyn Outputs) {
    for (field, body) in [(&UPPER_TEMPERATURE, UPPER), (&LOWER_TEMPERATURE, LOWER)] {
        if let Some(values) = outputs.get(field) {
            values.iter_mut().zip(rises(state, body)).for_each(|(value, rise)| *value = rise);
        }
    }
}

fn finite<'a>(inputs: &'a dyn Inputs, spec: &FieldSpec) -> Result<&'a [f64], StepError> {
    let field = spec.name.to_owned();
    let Some(input) = inputs.get(spec) else { return Err(StepError::MissingInput { field }) };
    match first_non_finite(input.values) {
        None => Ok(input.values),
        Some(index) => Err(StepError::NonFiniteInput { field, index, value: input.values[index] }),
    }
}

impl Model for Running {
    fn solve(
        &mut self,
        _step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let (flux, speeds) = (finite(inputs, &FRICTION_POWER)?, finite(inputs, &SURFACE_SPEED)?);
        if speeds.iter().any(|speed| *speed <= 0.0) {
            let reason = "material has to move through the contact: `surface_speed` > 0";
            return Err(StepError::NoSolution(reason.to_owned()));
        }
        let (factors, sums) = self.trial.split_at_mut(2);
        for ((factor, scale), speed) in factors.iter_mut().zip(self.scale).zip(speeds) {
            *factor = scale / speed.sqrt();
        }
        let rows = flux.chunks_exact(self.columns).zip(sums.chunks_exact_mut(self.columns));
        for (flux, sums) in rows {
            for (i, sum) in sums.iter_mut().enumerate() {
                *sum = flux[i..].iter().zip(&self.shape).map(|(q, shape)| q * shape).sum();
            }
        }
        write_out(&self.trial, outputs);
        let received_power = Some(self.grid.integrate(flux));
        Ok(StepReport { substeps: 1, received_power, ..StepReport::default() })
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        write_out(&self.accepted, outputs);
    }

    fn accept(&mut self) {
        self.accepted.copy_from_slice(&self.trial);
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        write_out(&self.accepted, outputs);
    }

    fn summary(&self) -> serde_json::Value {
        let peak = |body| rises(&self.accepted, body).fold(0.0, f64::max);
        let rise = |body| serde_json::json!({"max_rise_k": peak(body)});
        let [upper, lower] = &self.bodies.0;
        serde_json::json!({"temperature": {upper: rise(UPPER), lower: rise(LOWER)}})
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        proto::state::write_numbers(into, &self.accepted)
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        Ok(proto::state::read_numbers(from, &mut self.accepted)?)
    }
}
