//! Explicit elements that roll in time, on an axle that may move.

use super::common::{HEAVY, NoInputs, SPEED, Store, configuration, paper, refusal};
use mech_solver::MechSolver;
use proto::configuration::{Configuration, Layout, Mode};
use proto::model::{Model, Solver, Step};
use proto::progress::Progress;
use serde_json::{Value, json};
use std::collections::BTreeMap;

const LOAD: f64 = 134e3;
const MASS: f64 = 900.0;
/// Approach of Hertz's contact [m].
const HERTZ: f64 = 126.55e-6;

fn case(suspension: Value) -> Value {
    let mut case = paper();
    case["motion"] = json!({"speed": SPEED, "creepage": {"xi": -3e-3}});
    case["mech"] = json!({"model": "explicit-fe", "resolution": 2});
    case["materials"]["steel"]["density"] = json!(HEAVY);
    case["effects"]["suspension"] = suspension;
    case
}

fn in_time(case: &Value, threads: usize) -> Configuration {
    Configuration { mode: Mode::Transient, threads, ..configuration(case) }
}

/// A model, its layout, and the next window.
struct Rolled {
    model: Box<dyn Model>,
    layout: Layout,
    outputs: Vec<String>,
    window: u64,
    time: f64,
}

impl Rolled {
    fn of(case: &Value, threads: usize) -> Self {
        let configuration = in_time(case, threads);
        let setup = MechSolver.configure(&configuration).unwrap_or_else(|error| panic!("{error}"));
        let layout = setup.layout().clone();
        let mut model = setup.build(&Progress::default()).expect("a checked case builds");
        model.first_outputs(&mut Store::for_layout(&layout, &configuration.outputs));
        Self { model, layout, outputs: configuration.outputs, window: 0, time: 0.0 }
    }

    /// Fields of a window of this duration [s], solved without accepting it.
    fn attempt(&mut self, duration: f64) -> BTreeMap<String, Vec<f64>> {
        let mut store = Store::for_layout(&self.layout, &self.outputs);
        let step =
            Step { window: self.window, iteration: 1, start: self.time, end: self.time + duration };
        self.model.solve(&step, &NoInputs, &mut store).expect("a solution");
        store.0
    }

    fn window(&mut self, duration: f64) -> BTreeMap<String, Vec<f64>> {
        let fields = self.attempt(duration);
        self.model.accept();
        self.window += 1;
        self.time += duration;
        fields
    }

    fn number(&self, key: &str) -> f64 {
        self.model.summary()["contact"][key].as_f64().unwrap_or_else(|| panic!("{key}"))
    }

    /// Time for the passage of an element [s].
    fn passage(&self) -> f64 {
        let grid = self.layout.grid_of("pressure").expect("a grid");
        grid.as_structured().expect("a structured one").dx() / SPEED
    }

    /// Heat of a window from its mean fields [J].
    fn heat(&self, fields: &BTreeMap<String, Vec<f64>>, duration: f64) -> f64 {
        duration
            * self
                .layout
                .grid_of("friction_power")
                .expect("a grid")
                .integrate(&fields["friction_power"])
    }
}

/// Force over the load at an approach: δ_H (N/N_0)^⅔ of Hertz, less the part that is missing
/// because nearby faces of the blocks are fixed, proportional to the force.
fn spring(approach: f64, still: f64) -> f64 {
    let mut root = (approach.max(0.0) / still).sqrt();
    for _ in 0..4 {
        let yielded = HERTZ * root * root - (HERTZ - still) * root.powi(3);
        let slope = 2.0 * HERTZ * root - 3.0 * (HERTZ - still) * root * root;
        root -= if slope > 0.0 { (yielded - approach.max(0.0)) / slope } else { 0.0 };
    }
    root.powi(3)
}

/// A wheel over a long dip against M z̈ = N − N_0 − K z − C ż on Hertz's spring. Tolerance relative
/// to the load: elements of half a semi-axis are stiffer than Hertz's contact, by 0.09 of the load
/// where it changes most under a soft suspension, and by 0.031 under this one.
#[test]
fn an_axle_over_a_dip_moves_on_hertz_spring() {
    // Stiff enough to be felt beside Hertz' spring.
    let (depth, length, at, stiffness, damping) = (0.04e-3, 0.2, 0.11, 4e8, 2500.0);
    let suspension = json!({"mass": MASS, "stiffness": stiffness, "damping": damping,
        "irregularity": "dip", "depth": depth, "length": length, "at": at});
    let mut rolled = Rolled::of(&case(suspension), 2);
    let still = rolled.number("approach_m");
    let window = 4.0 * rolled.passage();
    let (mut raised, mut rising, mut worst, mut extremes) = (0.0, 0.0, 0.0_f64, [LOAD; 2]);
    let steps = 2000;
    let step = window / f64::from(steps);
    for count in 0..(0.26 / (SPEED * window)) as u32 {
        rolled.window(window);
        let mut mean = 0.0;
        for sub in 0..steps {
            let way = SPEED * step * f64::from(count * steps + sub);
            let from = way - at;
            let hollow = if 2.0 * from.abs() < length {
                0.5 * depth * (1.0 + (2.0 * std::f64::consts::PI * from / length).cos())
            } else {
                0.0
            };
            let approach = still - raised - hollow;
            let force = LOAD * spring(approach, still);
            rising += step * (force - LOAD - stiffness * raised - damping * rising) / MASS;
            raised += step * rising;
            mean += force / f64::from(steps);
        }
        let force = rolled.number("normal_force_n");
        extremes = [extremes[0].min(force), extremes[1].max(force)];
        worst = worst.max((force - mean).abs() / LOAD);
    }
    println!(
        "forces from {:.3e} to {:.3e} N, {worst:.4} of the load off",
        extremes[0], extremes[1]
    );
    assert!(extremes[0] < 0.6 * LOAD && extremes[1] > 1.25 * LOAD, "{extremes:?}");
    assert!(worst < 0.06, "{worst}");
}

/// Results do not depend on the windows: twenty passages of an element in twenty windows or in one
/// give the same heat and the same final force. Tolerance: rounding of the ends of the windows.
#[test]
fn windows_of_one_and_of_twenty_passages_have_the_same_heat() {
    let suspension =
        json!({"mass": MASS, "irregularity": "joint", "depth": 1e-4, "length": 0.05, "at": 0.04});
    let case = case(suspension);
    let [mut one, mut twenty] = [Rolled::of(&case, 2), Rolled::of(&case, 2)];
    let passage = one.passage();
    let whole = twenty.window(20.0 * passage);
    let together = twenty.heat(&whole, 20.0 * passage);
    let (mut heat, mut pressed) = (0.0, 0.0);
    for _ in 0..20 {
        let fields = one.window(passage);
        heat += one.heat(&fields, passage);
        pressed += one.number("normal_force_n") / 20.0;
    }
    let off = (heat / together - 1.0).abs();
    println!("{heat:.9} J, {together:.9} J, {off:.1e} off");
    assert!(off < 1e-10, "{heat} {together}");
    assert!((pressed / twenty.number("normal_force_n") - 1.0).abs() < 1e-10);
}

/// A rejected window leaves no trace; a saved state continues to the last bit, and so does a run on
/// two threads.
#[test]
fn trials_states_and_threads_change_nothing() {
    let suspension =
        json!({"mass": MASS, "irregularity": "flat", "depth": 2e-4, "length": 0.02, "at": 0.02});
    let case = case(suspension);
    let (mut one, mut other) = (Rolled::of(&case, 1), Rolled::of(&case, 2));
    let window = 1.3 * one.passage();
    for _ in 0..4 {
        one.attempt(2.0 * window);
        assert_eq!(one.window(window), other.window(window));
    }
    let mut saved = Vec::new();
    one.model.save(&mut saved).unwrap();
    let mut fresh = Rolled::of(&case, 1);
    fresh.model.restore(&mut saved.as_slice()).unwrap();
    (fresh.window, fresh.time) = (one.window, one.time);
    for _ in 0..2 {
        assert_eq!(one.window(window), fresh.window(window));
    }
    assert!(fresh.model.restore(&mut &saved[..saved.len() - 8]).is_err());
}

/// The torque of steady rolling drives the wheel: the gain in rotation equals the torque not
/// consumed by friction. Tolerance: rounding.
#[test]
fn a_driven_wheel_turns_by_the_torque_that_is_left() {
    let inertia = 80.0;
    let suspension = json!({"mass": MASS, "rotary_inertia": inertia,
        "irregularity": "dip", "depth": 3e-4, "length": 0.04, "at": 0.03});
    let mut rolled = Rolled::of(&case(suspension), 2);
    let (radius, steady) = (0.46, rolled.number("creep_force_x_n"));
    let (mut creepage, mut largest) = (rolled.number("creepage_xi"), 0.0_f64);
    let window = 3.0 * rolled.passage();
    for _ in 0..3 {
        rolled.window(window);
        let left = steady - rolled.number("creep_force_x_n");
        creepage -= left * window * radius * radius / (inertia * SPEED);
        largest = largest.max((rolled.number("creepage_xi") + 3e-3).abs());
        assert!((rolled.number("creepage_xi") - creepage).abs() < 1e-12, "{creepage}");
    }
    assert!(largest > 1e-5, "{largest}");
}

#[test]
fn what_an_axle_needs_is_asked_for() {
    let good = json!({"mass": MASS});
    let steady = refusal(&configuration(&case(good.clone())));
    assert_eq!(steady.key, "effects.suspension");
    assert!(steady.fix.contains("transient"));
    let mut heavy = case(good);
    heavy["mech"]["mass_scaling"] = json!(4.0);
    assert_eq!(refusal(&in_time(&heavy, 1)).key, "mech.mass_scaling");
    let no_length = json!({"mass": MASS, "irregularity": "dip", "depth": 1e-4});
    assert_eq!(refusal(&in_time(&case(no_length), 1)).key, "effects.suspension.length");
    let under = json!({"mass": MASS, "irregularity": "corrugation", "depth": 1e-4, "length": 0.03, "at": 1e-3});
    assert_eq!(refusal(&in_time(&case(under), 1)).key, "effects.suspension.at");
    let no_form = json!({"mass": MASS, "depth": 1e-4});
    assert_eq!(refusal(&in_time(&case(no_form), 1)).key, "effects.suspension.irregularity");
}
