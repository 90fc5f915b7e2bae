//! Varying load and shift of contacts with memory, step by step.

use super::common::{NoInputs, Store, assert_close, configuration, refusal, run};
use elastic::Elasticity;
use elastic::Material;
use elastic::{cattaneo, dissimilar, hertz};
use mech_solver::MechSolver;
use proto::configuration::{Configuration, Layout, Mode};
use proto::history::Histories;
use proto::model::{Model, Solver, Step};
use proto::progress::Progress;
use serde_json::{Value, json};

/// Axisymmetric body pressed on another one, at rest.
fn pressed(materials: [Value; 2], friction: f64, resolution: usize) -> Value {
    let [upper, lower] = materials;
    json!({
        "bodies": {"punch": {"position": "upper", "radius_x": 0.1, "radius_y": 0.1, "material": "upper"},
            "plane": {"position": "lower", "material": "lower"}},
        "materials": {"upper": upper, "lower": lower},
        "motion": {"speed": 0.0, "shift": {"x": 0.0}},
        "load": {"normal_force": 1e3},
        "friction": {"coefficient": friction},
        "mech": {"model": "half-space", "resolution": resolution},
        "effects": {"partial_slip": {}},
    })
}

fn material(youngs_modulus: f64, poisson_ratio: f64) -> Value {
    json!({"youngs_modulus": youngs_modulus, "poisson_ratio": poisson_ratio})
}

/// Adds columns to a case, with rows one second apart, the first at one second.
fn over(case: &Value, columns: &[(&str, Vec<f64>)]) -> Configuration {
    let count = columns[0].1.len();
    let times = (1..=count).map(|k| k as f64).collect();
    let values = columns.iter().map(|(key, column)| ((*key).to_owned(), column.clone())).collect();
    let histories = Histories { rows: false, times, values, live: None };
    let mut configuration = Configuration { mode: Mode::Transient, ..configuration(case) };
    histories.put_row(&mut configuration.case, 0);
    configuration.histories = Some(histories);
    configuration
}

struct Steps {
    model: Box<dyn Model>,
    layout: Layout,
    outputs: Vec<String>,
}

impl Steps {
    fn new(configuration: &Configuration) -> Self {
        let setup = MechSolver.configure(configuration).unwrap_or_else(|error| panic!("{error}"));
        let layout = setup.layout().clone();
        let model = setup.build(&Progress::default()).expect("a checked case builds");
        Self { model, layout, outputs: configuration.outputs.clone() }
    }

    /// Solves a window of one second without accepting it.
    fn attempt(&mut self, window: u64) -> Store {
        let mut store = Store::for_layout(&self.layout, &self.outputs);
        let step = Step { window, iteration: 1, start: window as f64, end: window as f64 + 1.0 };
        self.model.solve(&step, &NoInputs, &mut store).expect("a solution");
        store
    }

    fn window(&mut self, window: u64) -> Value {
        self.attempt(window);
        self.model.accept();
        self.model.summary()["contact"].clone()
    }
}

fn number(contact: &Value, key: &str) -> f64 {
    contact[key].as_f64().unwrap_or_else(|| panic!("{key} is not in the summary"))
}

/// A punch of another material, pressed on step by step. From the first steps on it sticks in a
/// constant share of the contact, that of Spence, for a circle and a line. If the bodies hardly
/// couple its pressure is Hertz's. Tolerances: one element of the stick radius, 1 % of the
/// pressure.
#[test]
fn spence() {
    // β = 0.0196: the effect of the tractions on the pressure, neglected by the closed forms, is
    // about 4e-4.
    let soft = || [material(1e6, 0.49), material(1e15, 0.0)];
    let body = |youngs_modulus, poisson_ratio| Material { youngs_modulus, poisson_ratio };
    let beta = dissimilar::coupling(&Elasticity::of_pair(&body(1e6, 0.49), &body(1e15, 0.0)));
    let friction = 0.0117;
    let (circle, line) = (12, 60);
    let loads = |count: u32, power: i32| -> Vec<f64> {
        (1..=count).map(|k| 1e-3 * (f64::from(k) / f64::from(count)).powi(power)).collect()
    };
    // The contact radius grows by one element in each step.
    let case = pressed(soft(), friction, circle);
    let mut steps = Steps::new(&over(&case, &[("load.normal_force", loads(30, 3))]));
    let exact = dissimilar::stick_share_of_a_circle(beta / friction);
    let compliance = (1.0 - 0.49 * 0.49) / 1e6;
    for window in 0..30 {
        let contact = steps.window(window);
        let share = (1.0 - number(&contact, "slip_area_ratio")).sqrt();
        let radius = 0.5 * number(&contact, "elements_across");
        assert!(radius < 8.0 || (share - exact).abs() * radius < 1.0, "{window}: {share} {exact}");
        let hertz = hertz::circular_contact(0.1, number(&contact, "normal_force_n"), compliance);
        assert!(
            radius < 16.0
                || (number(&contact, "max_pressure_pa") / hertz.max_pressure - 1.0).abs() < 1e-2
        );
    }
    let mut case = pressed(soft(), friction, line);
    case["bodies"]["punch"].as_object_mut().expect("a table").remove("radius_y");
    case["contact"] = json!({"width": 0.1});
    let mut steps = Steps::new(&over(&case, &[("load.normal_force", loads(60, 2))]));
    let exact = dissimilar::stick_share_of_a_line(beta / friction);
    for window in 0..60 {
        let contact = steps.window(window);
        let share = 1.0 - number(&contact, "slip_area_ratio");
        let half = 0.5 * number(&contact, "elements_across");
        assert!(half < 8.0 || (share - exact).abs() * half < 1.0, "{window}: {share} {exact}");
    }
}

/// CONTACT's example of Spence's problem, with one rigid body, ν = 0, f = 0.2986. Final figures on
/// elements of the same size: 225 of 921 elements stick, 23.92 kPa, 98.74 μm.
#[test]
fn spence_as_in_contact() {
    let mut case = pressed([material(1e6, 0.0), material(200e9, 0.0)], 0.2986, 6);
    let radius = 1.0 / (2.0 * 4.116);
    case["bodies"]["punch"] =
        json!({"position": "upper", "radius_x": radius, "radius_y": radius, "material": "upper"});
    let loads = (1..=35).map(|k| (f64::from(k) / 45.0).powi(3)).collect();
    let mut steps = Steps::new(&over(&case, &[("load.normal_force", loads)]));
    let last = (0..35).map(|window| steps.window(window)).last().expect("a window");
    assert_close(1.0 - number(&last, "slip_area_ratio"), 225.0 / 921.0, 0.03);
    assert_close(number(&last, "max_pressure_pa"), 23.92e3, 2e-3);
    assert_close(number(&last, "approach_m"), 98.74e-6, 3e-4);
}

/// Cyclic shift under constant load: first Cattaneo and Mindlin's law, then the same law at twice
/// the size from each turning point, and the cycle closes. Tolerance: slip across the force,
/// neglected by Cattaneo, and the elements.
#[test]
fn cycles_of_shift() {
    let steel = || material(210e9, 0.3);
    let case = pressed([steel(), steel()], 0.3, 25);
    let line = hertz::circular_contact(0.1, 1e3, 2.0 * 0.91 / 210e9);
    let of = |force_ratio: f64| {
        let bound = 0.3 * line.max_pressure;
        cattaneo::Shift { force_ratio, radius: line.semi_axis_a, bound }
            .rigid_shift(210e9 / 2.6, 0.3)
    };
    let most = of(0.9);
    // Out, back to the mirrored point, and out again.
    let way = [0.5, 1.0, 0.6, 0.2, -0.2, -0.6, -1.0, -0.3, 0.3, 1.0].map(|share| -share * most);
    let mut steps = Steps::new(&over(&case, &[("motion.shift.x", way.to_vec())]));
    let forces: Vec<f64> = (0..way.len() as u64)
        .map(|window| number(&steps.window(window), "creep_force_x_n") / 300.0)
        .collect();
    // Force over f N for a shift from rest: the inverse of the closed form.
    let whole = of(1.0);
    let out = |shift: f64| 1.0 - (1.0 - shift / whole).max(0.0).powf(1.5);
    let turned = |from: f64, by: f64| from - 2.0 * out(0.5 * by);
    for (window, expected) in [
        (0, out(0.5 * most)),
        (1, 0.9),
        (2, turned(0.9, 0.4 * most)),
        (4, turned(0.9, 1.2 * most)),
        (6, -0.9),
        (7, -turned(0.9, 0.7 * most)),
        (9, 0.9),
    ] {
        let error = (forces[window] - expected).abs();
        assert!(error < 6e-3, "{window}: {} is not {expected}", forces[window]);
    }
    assert!((forces[9] - forces[1]).abs() < 1e-3 && (forces[6] + forces[1]).abs() < 1e-3);
}

/// A wheel rolls on while its load and creepage change. Long after, it is the steady contact of the
/// final values. Tolerance: the remainder of the start after four contact lengths.
#[test]
fn rolling_under_a_load_that_varies() {
    let mut case = pressed([material(210e9, 0.3), material(210e9, 0.3)], 0.3, 6);
    case["motion"] = json!({"speed": 1.0, "creepage": {"xi": -1e-3}});
    case["effects"]["friction_heat"] = json!({});
    let mut steady = case.clone();
    steady["load"]["normal_force"] = json!(600.0);
    case["mech"]["rolling"] = json!("transient");
    let columns = [
        ("load.normal_force", vec![1e3, 800.0, 600.0, 600.0]),
        ("motion.creepage.xi", vec![0.0, -2e-3, -1e-3, -1e-3]),
    ];
    let mut configuration = over(&case, &columns);
    let a = hertz::circular_contact(0.1, 1e3, 2.0 * 0.91 / 210e9).semi_axis_a;
    if let Some(histories) = &mut configuration.histories {
        histories.times.iter_mut().for_each(|time| *time *= 4.0 * a);
    }
    let mut steps = Steps::new(&configuration);
    let mut force = 0.0;
    for window in 0..10_u32 {
        let mut store = Store::for_layout(&steps.layout, &steps.outputs);
        let [start, end] = [window, window + 1].map(|k| 2.0 * a * f64::from(k));
        let step = Step { window: u64::from(window), iteration: 1, start, end };
        steps.model.solve(&step, &NoInputs, &mut store).expect("a solution");
        steps.model.accept();
        force = number(&steps.model.summary()["contact"], "creep_force_x_n");
    }
    // The element size follows from the smallest contact, that of the last load.
    assert_close(force, run(&steady).number("creep_force_x_n"), 1e-4);
}

/// A window solved again, or from a saved state, is the same to the bit.
#[test]
fn windows_depend_on_what_was_accepted_alone() {
    let case = pressed([material(1e6, 0.3), material(200e9, 0.0)], 0.2, 5);
    let columns = [
        ("load.normal_force", vec![0.1, 0.2, 0.3, 0.2, 0.1]),
        ("motion.shift.y", vec![0.0, 1e-6, 3e-6, -2e-6, 0.0]),
    ];
    let configuration = over(&case, &columns);
    let mut one = Steps::new(&configuration);
    one.window(0);
    one.window(1);
    let mut state = Vec::new();
    one.model.save(&mut state).expect("a state");
    let first = one.attempt(2);
    let again = one.attempt(2);
    assert!(first.0 == again.0);
    let mut other = Steps::new(&configuration);
    other.model.restore(&mut state.as_slice()).expect("its own state");
    let restored = other.attempt(2);
    assert!(first.0 == restored.0);
    one.model.accept();
    other.model.accept();
    assert!(one.attempt(3).0 == other.attempt(3).0);
}

#[test]
fn rows_without_time_are_refused() {
    let case = pressed([material(1e6, 0.3), material(1e6, 0.3)], 0.2, 5);
    let mut configuration = over(&case, &[("load.normal_force", vec![0.1, 0.2])]);
    if let Some(histories) = &mut configuration.histories {
        histories.rows = true;
    }
    let refusal = refusal(&configuration);
    assert_eq!(refusal.key, "time.mode");
    assert!(refusal.fix.contains("transient"), "{}", refusal.fix);
}
