//! Cases, and their run through the traits of a participant.

use mech_solver::MechSolver;
use proto::configuration::{Configuration, Layout, Mode, Refusal};
use proto::field::FieldSpec;
use proto::grid::Grid;
use proto::model::{InputField, Inputs, Model, Outputs, Solver, Step, StepReport};
use proto::params::Params;
use proto::progress::Progress;
use serde_json::{Value, json};
use std::collections::BTreeMap;

pub(crate) const RADIUS: f64 = 0.46;
pub(crate) const FRICTION: f64 = 0.6;
pub(crate) const SPEED: f64 = 38.889;
/// Density of a heavy steel [kg/m³]. The steps of explicit elements are proportional to its root.
/// At [`SPEED`], the inertia of the material remains a per cent of its stiffness: the square of the
/// speed over that of surface waves.
pub(crate) const HEAVY: f64 = 4e5;
/// Compliance sum of steel on steel [1/Pa].
pub(crate) const STEEL: f64 = 2.0 * 0.91 / 210e9;

/// Table 1 of Naeimi et al. with both effects.
pub(crate) fn paper() -> Value {
    json!({
        "bodies": {"wheel": {"position": "upper", "radius_x": RADIUS, "material": "steel"},
        "rail": {"position": "lower", "radius_y": 0.3, "material": "steel"}},
        "materials": {"steel": {"youngs_modulus": 210e9, "poisson_ratio": 0.3}},
        "motion": {"speed": SPEED, "traction_coefficient": 0.58, "creep_law": "carter-pressure"},
        "load": {"normal_force": 134e3},
        "friction": {"coefficient": FRICTION},
        "mech": {"resolution": 20},
        "effects": {"friction_heat": {}, "partial_slip": {}},
    })
}

/// Case [`paper`] with the ellipse of Table 2.
pub(crate) fn paper_table_2() -> Value {
    let mut case = paper();
    case["contact"] =
        json!({"semi_axis_a": 7.98e-3, "semi_axis_b": 6.01e-3, "max_pressure": 1352e6});
    case
}

/// Replaces the drive of the wheel.
pub(crate) fn driven(mut case: Value, drive: &str, value: f64) -> Value {
    let motion = case["motion"].as_object_mut().expect("a table");
    motion.retain(|key, _| key == "speed" || key == "creep_law");
    match drive {
        "creepage" => case["motion"]["creepage"] = json!({"xi": value}),
        _ => case["motion"][drive] = json!(value),
    }
    case
}

/// Adapts a case to a model: for a periodic contact without radii and in full sliding, for rods
/// with a length and an area.
pub(crate) fn fitted(mut case: Value, model: &str) -> Value {
    case["mech"]["model"] = json!(model);
    if model == "periodic" {
        case["mech"]["period_x"] = json!(12e-3);
        case["mech"]["period_y"] = json!(12e-3);
        case["mech"]["resolution"] = json!(4);
        case = driven(case, "creepage", -0.002);
        for (body, radius) in [("wheel", "radius_x"), ("rail", "radius_y")] {
            case["bodies"][body].as_object_mut().expect("a table").remove(radius);
        }
    }
    if model == "explicit-fe" {
        case["materials"]["steel"]["density"] = json!(HEAVY);
    }
    if model == "wheel-on-track" {
        case = on_track(case);
    }
    if model == "conformal" {
        case = driven(case, "creepage", -0.002);
        case["bodies"]["rail"]["radius_y"] = json!(10e-3);
        case["bodies"]["wheel"]["radius_y"] = json!(-11e-3);
        case["load"]["normal_force"] = json!(20e3);
        case["mech"]["resolution"] = json!(8);
    }
    if model == "rod" {
        case["bodies"]["rail"]["length"] = json!(0.1);
        case["mech"]["area"] = json!(1e-4);
    }
    case
}

/// Replaces the bodies by wheel and rail of the standards, on elements of one millimetre.
fn on_track(mut case: Value) -> Value {
    let profile = |name: &str| format!("{}/../cases/profiles/{name}", env!("CARGO_MANIFEST_DIR"));
    case["bodies"] = json!({
        "wheel": {"position": "upper", "profile": profile("wheel-s1002.csv"), "material": "steel"},
        "rail": {"position": "lower", "profile": profile("rail-60e1.csv"), "material": "steel"},
    });
    case["track"] = json!({"cant": 0.025});
    case["wheelset"] = json!({"nominal_radius": RADIUS, "yaw": 2e-3});
    case["motion"] = json!({"speed": SPEED});
    case["load"] = json!({"vertical_force": 100e3});
    case["mech"] = json!({"model": "wheel-on-track", "resolution": 10});
    case
}

/// Switches an effect off.
pub(crate) fn without(mut case: Value, effect: &str) -> Value {
    case["effects"].as_object_mut().expect("a table").remove(effect);
    case
}

/// All fields that the active effects and the model provide.
pub(crate) fn fields_of(case: &Value) -> Vec<String> {
    let mut fields = vec!["pressure", "traction", "slip_velocity"];
    if case["effects"].get("friction_heat").is_some() {
        fields.extend(["friction_power", "surface_speed"]);
    }
    fields.into_iter().map(str::to_owned).collect()
}

/// Steady configuration of the model named by `mech.model`, by default `hertz-carter`, which
/// requests all fields.
pub(crate) fn configuration(case: &Value) -> Configuration {
    Configuration {
        role: "mech".to_owned(),
        model: case["mech"]["model"].as_str().unwrap_or("hertz-carter").to_owned(),
        mode: Mode::Steady,
        windows: None,
        case: Params(case.clone()),
        histories: None,
        inputs: Vec::new(),
        outputs: fields_of(case),
        observed: Vec::new(),
        threads: 1,
    }
}

pub(crate) struct NoInputs;

impl Inputs for NoInputs {
    fn get(&self, _: &FieldSpec) -> Option<InputField<'_>> {
        None
    }
}

/// Outputs by name; NaN until they are written.
#[derive(Default)]
pub(crate) struct Store(pub(crate) BTreeMap<String, Vec<f64>>);

impl Store {
    pub(crate) fn for_layout(layout: &Layout, fields: &[String]) -> Self {
        let place = |name: &String| {
            let points = layout.grid_of(name).expect("a grid for the field").points();
            let components =
                proto::field::find(name).expect("a field of the table").components as usize;
            (name.clone(), vec![f64::NAN; points * components])
        };
        Self(fields.iter().map(place).collect())
    }
}

impl Outputs for Store {
    fn get(&mut self, field: &FieldSpec) -> Option<&mut [f64]> {
        self.0.get_mut(field.name).map(Vec::as_mut_slice)
    }
}

/// A case run for one steady window.
pub(crate) struct Run {
    pub(crate) layout: Layout,
    pub(crate) model: Box<dyn Model>,
    pub(crate) fields: BTreeMap<String, Vec<f64>>,
    pub(crate) report: StepReport,
    pub(crate) contact: Value,
}

pub(crate) fn run(case: &Value) -> Run {
    let configuration = configuration(case);
    let setup = MechSolver.configure(&configuration).unwrap_or_else(|error| panic!("{error}"));
    let layout = setup.layout().clone();
    let mut model = setup.build(&Progress::default()).expect("a checked case builds");
    let mut store = Store::for_layout(&layout, &configuration.outputs);
    let report = model.solve(&Step::STEADY, &NoInputs, &mut store).expect("a solution");
    model.accept();
    let contact = model.summary()["contact"].clone();
    Run { layout, model, fields: store.0, report, contact }
}

pub(crate) fn refusal(configuration: &Configuration) -> Refusal {
    MechSolver.configure(configuration).err().expect("the case must be refused")
}

impl Run {
    /// A number of the summary.
    #[track_caller]
    pub(crate) fn number(&self, key: &str) -> f64 {
        self.contact[key].as_f64().unwrap_or_else(|| panic!("{key} is not in the summary"))
    }

    pub(crate) fn grid(&self) -> &Grid {
        self.layout.grid_of("pressure").expect("always there")
    }

    /// The longitudinal component of a field.
    pub(crate) fn longitudinal(&self, field: &str) -> &[f64] {
        &self.fields[field][..self.grid().points()]
    }

    /// Surface integral of the lateral component of a field.
    pub(crate) fn lateral_integral(&self, field: &str) -> f64 {
        self.grid().integrate(&self.fields[field][self.grid().points()..])
    }

    /// Surface integral of the longitudinal component of a field.
    pub(crate) fn integral(&self, field: &str) -> f64 {
        self.grid().integrate(self.longitudinal(field))
    }
}

#[track_caller]
pub(crate) fn assert_close(value: f64, expected: f64, tolerance: f64) {
    let scale = if expected == 0.0 { 1.0 } else { expected.abs() };
    let error = (value - expected).abs() / scale;
    assert!(error <= tolerance, "{value} is not {expected}: error {error:e} over {tolerance:e}");
}
