//! A model driven through the contract like in the participant loop, and the paper's case.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so does what it calls")]
#![allow(dead_code, reason = "each test binary uses its own part")]

use numerics::quadrature::integrate;
use proto::configuration::{Configuration, Input, Layout, Mode};
use proto::field::{self, FieldSpec};
use proto::grid::{Grid, Structured};
use proto::model::{InputField, Inputs, Model, Outputs, Solver, Step, StepError, StepReport};
use proto::params::Params;
use proto::progress::Progress;
use serde_json::{Value, json};
use thermal_solver::ThermalSolver;
use thermal_solver::effects::volume_temperature::VOLUMES;

/// Rise integrals of the upper and the lower body.
pub(crate) const INTEGRALS: [&FieldSpec; 2] =
    [&field::UPPER_RISE_INTEGRAL, &field::LOWER_RISE_INTEGRAL];

/// Tables 1 and 2 of the paper.
pub(crate) const SEMI_AXIS: f64 = 7.98e-3;
pub(crate) const HERTZ_PRESSURE: f64 = 1352e6;
pub(crate) const FRICTION: f64 = 0.6;
pub(crate) const SPEED: f64 = 38.889;
pub(crate) const SLIDING: f64 = 0.012 * 38.889;
/// Compliance sum E* of equation 19 [1/Pa].
pub(crate) const COMPLIANCE: f64 = 8.6667e-12;
pub(crate) const DIFFUSIVITY: f64 = 50.0 / (7850.0 * 419.5);

pub(crate) fn effusivity() -> f64 {
    heat::closed_form::scales::effusivity(50.0, 7850.0, 419.5)
}

pub(crate) fn steel() -> Value {
    let steel = json!({"density": 7850.0, "specific_heat": 419.5, "conductivity": 50.0});
    json!({
        "bodies": {"wheel": {"position": "upper", "material": "steel"}, "rail": {"position": "lower", "material": "steel"}},
        "materials": {"steel": steel},
        "motion": {"speed": SPEED},
        "effects": {"friction_heat": {"partition": "equal"}},
    })
}

/// A row of elements of the length `semi_axis / per_semi_axis`, centred on multiples of this
/// length, from `from` to `to` semi-axes.
pub(crate) fn row(per_semi_axis: usize, from: f64, to: f64) -> Structured {
    let h = SEMI_AXIS / per_semi_axis as f64;
    let n = ((to - from) * per_semi_axis as f64).round() as usize + 1;
    Structured::contact_plane(from * SEMI_AXIS, 0.0, h, h, n, 1)
}

pub(crate) fn configuration(
    model: &str,
    mode: Mode,
    grid: Structured,
    case: Value,
) -> Configuration {
    let input = |spec: &FieldSpec, grid: Grid| Input {
        field: spec.kind(),
        producer: "mech".to_owned(),
        grid: Some(grid),
        moves: false,
        peak: None,
        extent: None,
    };
    let names = |specs: &[&FieldSpec]| specs.iter().map(|s| s.name.to_owned()).collect();
    let mut observed: Vec<String> =
        names(&[&field::LOWER_SECTION_TEMPERATURE, &field::UPPER_SECTION_TEMPERATURE]);
    if !case["effects"]["volume_temperature"].is_null() {
        observed.extend(VOLUMES.map(|volume| volume.name.to_owned()));
    }
    let mut outputs = names(&[&field::LOWER_TEMPERATURE, &field::UPPER_TEMPERATURE]);
    if !case["effects"]["thermal_expansion"].is_null() {
        outputs.extend(names(&INTEGRALS));
    }
    let mut inputs = vec![
        input(&field::FRICTION_POWER, Grid::structured("contact", grid)),
        input(&field::SURFACE_SPEED, one_point()),
    ];
    let continuity = case["effects"]["friction_heat"]["partition"] == "continuity";
    if continuity || !case["effects"]["contact_conductance"].is_null() {
        inputs.push(input(&field::PRESSURE, Grid::structured("contact", grid)));
    }
    Configuration {
        role: "thermal".to_owned(),
        model: model.to_owned(),
        mode,
        windows: serde_json::from_value(case["time"].clone()).ok(),
        case: Params(case),
        histories: None,
        inputs,
        outputs,
        observed,
        threads: 1,
    }
}

pub(crate) fn one_point() -> Grid {
    Grid::structured("surface", Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 1, 1))
}

/// Inputs of a solve.
pub(crate) struct Given {
    pub(crate) flux: Option<Vec<f64>>,
    pub(crate) pressure: Option<Vec<f64>>,
    pub(crate) speeds: Vec<f64>,
    pub(crate) grids: [Grid; 2],
}

impl Inputs for Given {
    fn get(&self, field: &FieldSpec) -> Option<InputField<'_>> {
        if *field == field::FRICTION_POWER {
            let values = self.flux.as_deref()?;
            return Some(InputField { values, grid: &self.grids[0] });
        }
        if *field == field::PRESSURE {
            let values = self.pressure.as_deref()?;
            return Some(InputField { values, grid: &self.grids[0] });
        }
        let known = *field == field::SURFACE_SPEED;
        known.then_some(InputField { values: &self.speeds, grid: &self.grids[1] })
    }
}

/// Requested outputs, by name, filled with NaN until they are written.
#[derive(Default)]
pub(crate) struct Wanted(pub(crate) Vec<(&'static str, Vec<f64>)>);

impl Wanted {
    pub(crate) fn of(&self, spec: &FieldSpec) -> &[f64] {
        &self.0.iter().find(|(name, _)| *name == spec.name).unwrap().1
    }
}

impl Outputs for Wanted {
    fn get(&mut self, field: &FieldSpec) -> Option<&mut [f64]> {
        self.0.iter_mut().find(|(name, _)| *name == field.name).map(|(_, v)| v.as_mut_slice())
    }
}

/// A model with its grid and outputs.
pub(crate) struct Run {
    pub(crate) model: Box<dyn Model>,
    pub(crate) layout: Layout,
    pub(crate) given: Given,
    pub(crate) surfaces: Wanted,
    pub(crate) time: f64,
}

impl Run {
    pub(crate) fn new(model: &str, mode: Mode, grid: Structured, case: Value) -> Self {
        Self::on(1, model, mode, grid, case)
    }

    pub(crate) fn on(
        threads: usize,
        model: &str,
        mode: Mode,
        grid: Structured,
        case: Value,
    ) -> Self {
        let configuration = Configuration { threads, ..configuration(model, mode, grid, case) };
        let setup = ThermalSolver.configure(&configuration).unwrap();
        let layout = setup.layout().clone();
        let poison = vec![f64::NAN; grid.points()];
        let mut surfaces = vec![
            (field::LOWER_TEMPERATURE.name, poison.clone()),
            (field::UPPER_TEMPERATURE.name, poison.clone()),
        ];
        let asked = INTEGRALS.into_iter().filter(|spec| layout.grid_of(spec.name).is_some());
        surfaces.extend(asked.map(|spec| (spec.name, poison.clone())));
        Self {
            model: setup.build(&Progress::default()).unwrap(),
            layout,
            given: Given {
                flux: None,
                pressure: None,
                speeds: vec![SPEED; 2],
                grids: [Grid::structured("contact", grid), one_point()],
            },
            surfaces: Wanted(surfaces),
            time: 0.0,
        }
    }

    pub(crate) fn steady(model: &str, grid: Structured) -> Self {
        Self::new(model, Mode::Steady, grid, steel())
    }

    pub(crate) fn transient(grid: Structured) -> Self {
        Self::new("columns", Mode::Transient, grid, steel())
    }

    pub(crate) fn try_solve(
        &mut self,
        flux: &[f64],
        duration: f64,
    ) -> Result<StepReport, StepError> {
        self.given.flux = Some(flux.to_vec());
        let (start, end) = (self.time, self.time + duration);
        let step = Step { window: 0, iteration: 1, start, end };
        // The models read only the duration; keep it free of rounding.
        let step = if step.duration() == duration {
            step
        } else {
            Step { start: 0.0, end: duration, ..step }
        };
        self.model.solve(&step, &self.given, &mut self.surfaces)
    }

    pub(crate) fn solve(&mut self, flux: &[f64], duration: f64) -> StepReport {
        self.try_solve(flux, duration).unwrap()
    }

    /// Solves and accepts a window.
    pub(crate) fn advance(&mut self, flux: &[f64], duration: f64) -> StepReport {
        let report = self.solve(flux, duration);
        self.model.accept();
        self.time += duration;
        report
    }

    pub(crate) fn rail(&self) -> &[f64] {
        self.surfaces.of(&field::LOWER_TEMPERATURE)
    }

    pub(crate) fn wheel(&self) -> &[f64] {
        self.surfaces.of(&field::UPPER_TEMPERATURE)
    }

    /// Returns the observed sections (rail, wheel) of the accepted state.
    pub(crate) fn sections(&mut self) -> Wanted {
        let specs = [&field::LOWER_SECTION_TEMPERATURE, &field::UPPER_SECTION_TEMPERATURE];
        let place =
            |spec: &FieldSpec| vec![f64::NAN; self.layout.grid_of(spec.name).unwrap().points()];
        let mut wanted = Wanted(specs.iter().map(|spec| (spec.name, place(spec))).collect());
        self.model.observe(&mut wanted);
        wanted
    }

    /// Returns a number of the summary, under `temperature`.
    pub(crate) fn summary(&self, body: &str, key: &str) -> Option<f64> {
        self.model.summary()["temperature"][body][key].as_f64()
    }

    pub(crate) fn grid(&self) -> Structured {
        *self.given.grids[0].as_structured().unwrap()
    }
}

/// Returns element means of √(1 − ξ²) on a row, from its primitive.
pub(crate) fn ellipse_means(grid: &Structured) -> Vec<f64> {
    let primitive = |x: f64| {
        let xi = (x / SEMI_AXIS).clamp(-1.0, 1.0);
        0.5 * SEMI_AXIS * (xi * (1.0 - xi * xi).sqrt() + xi.asin())
    };
    means(grid, primitive)
}

/// Returns element means from a primitive.
pub(crate) fn means(grid: &Structured, primitive: impl Fn(f64) -> f64) -> Vec<f64> {
    let h = grid.dx();
    let mean = |i: usize| (primitive(grid.x(i) + 0.5 * h) - primitive(grid.x(i) - 0.5 * h)) / h;
    (0..grid.ni).map(mean).collect()
}

/// Returns element means of friction power [W/m²] along the centre line of Carter's strip solution
/// with the slip law `carter-pressure`, for a traction coefficient.
pub(crate) fn carter_means(grid: &Structured, traction_coefficient: f64) -> Vec<f64> {
    let k = (1.0 - traction_coefficient / FRICTION).sqrt();
    let slip_per_xi = 2.0 * FRICTION * HERTZ_PRESSURE * COMPLIANCE;
    let (centre, begins) = (k - 1.0, 2.0 * k - 1.0);
    let power = |xi: f64| {
        let traction = FRICTION * HERTZ_PRESSURE * (1.0 - xi * xi).max(0.0).sqrt();
        let slip = ((xi - centre).powi(2) - k * k).max(0.0).sqrt();
        traction * SPEED * slip_per_xi * slip
    };
    let half = 0.5 * grid.dx() / SEMI_AXIS;
    let mean = |i: usize| {
        let xi = -grid.x(i) / SEMI_AXIS;
        let (low, high) = ((xi - half).max(begins), (xi + half).min(1.0));
        if low >= high {
            return 0.0;
        }
        // The substitution removes the square roots at both ends.
        let sum = integrate(0.0, 1.0, |t| {
            power(low + (high - low) * t * t * (3.0 - 2.0 * t)) * 6.0 * t * (1.0 - t)
        });
        sum * (high - low) / (2.0 * half)
    };
    (0..grid.ni).map(mean).collect()
}

pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a: f64, b| a.max(b.abs()))
}

/// Returns the largest difference, relative to the largest value of the second.
pub(crate) fn difference(a: &[f64], b: &[f64]) -> f64 {
    let apart = a.iter().zip(b).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
    apart / largest(b)
}
