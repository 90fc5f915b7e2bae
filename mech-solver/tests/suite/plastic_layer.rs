//! A layer that flows plastically, and hardens or softens.

use super::common::{
    FRICTION, NoInputs, SPEED, Store, assert_close, configuration, driven, paper, refusal, run,
    without,
};
use mech_solver::MechSolver;
use proto::configuration::{Configuration, Mode};
use proto::history::Histories;
use proto::model::{Model, Solver, Step};
use proto::progress::Progress;
use serde_json::{Value, json};

/// Flexibility of one square millimetre of two steel half-spaces under its own traction, as in
/// CONTACT.
const OWN: f64 = 1e-6 / 84.97e6;

/// One element of 1 mm² under 900 N on a layer, as in CONTACT's example plastic_3bl.
fn element(flexibility: f64, yield_stress: f64, hardening: f64) -> Value {
    json!({
        "bodies": {"block": {"position": "upper", "radius_x": 1e-3, "radius_y": 1e-3, "material": "steel"},
            "plane": {"position": "lower", "material": "steel"}},
        "materials": {"steel": {"youngs_modulus": 209.92e9, "poisson_ratio": 0.28}},
        "motion": {"speed": 0.0, "shift": {"x": 0.0}},
        "load": {"normal_force": 900.0},
        "friction": {"coefficient": 0.7},
        "contact": {"semi_axis_a": 1e-3, "semi_axis_b": 1e-3, "max_pressure": 429.718346e6},
        "mech": {"model": "half-space", "resolution": 1},
        "effects": {"partial_slip": {}, "third_body_layer": {"flexibility": flexibility},
            "plastic_layer": {"yield_stress": yield_stress, "hardening": hardening}},
    })
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

fn built(configuration: &Configuration) -> (Box<dyn Model>, Store) {
    let setup = MechSolver.configure(configuration).unwrap_or_else(|error| panic!("{error}"));
    let store = Store::for_layout(setup.layout(), &configuration.outputs);
    (setup.build(&Progress::default()).expect("a checked case builds"), store)
}

/// Section `contact` of the summary after every window of this length.
fn windows(configuration: &Configuration, count: u64, length: f64) -> Vec<Value> {
    let (mut model, mut store) = built(configuration);
    let window = |window: u64| {
        let start = window as f64 * length;
        let step = Step { window, iteration: 1, start, end: start + length };
        model.solve(&step, &NoInputs, &mut store).expect("a solution");
        model.accept();
        model.summary()["contact"].clone()
    };
    (0..count).map(window).collect()
}

fn number(contact: &Value, key: &str) -> f64 {
    contact[key].as_f64().unwrap_or_else(|| panic!("{key} is not in the summary"))
}

/// Cumulative sums of the steps.
fn sums(steps: &[f64]) -> Vec<f64> {
    steps
        .iter()
        .scan(0.0, |sum, step| {
            *sum += step;
            Some(*sum)
        })
        .collect()
}

/// Clay that hardens, reversed on the way; sand that softens down to a tenth; and sulphide: an
/// elastic spring and two sliders in series, by hand. Tolerance: four digits of the element's own
/// flexibility.
#[test]
fn one_element_is_a_spring_and_two_sliders() {
    for (flexibility, yield_stress, hardening, steps) in [
        (
            0.02e-3 / 106.25e6,
            200e6,
            435e9,
            vec![-4e-5, -4e-5, -4e-5, 3.6e-5, 3.6e-5, 9e-5, -9e-5, -5e-4],
        ),
        (0.02e-3 / 176.63e6, 400e6, -195e9, vec![-2.5e-5, -5e-5, 6e-5, -9e-5, -2e-3, -2e-3, 1e-4]),
        (0.02e-3 / 20.238e6, 20e6, 20.4e9, vec![-2e-5, -4e-5, 5e-5, -5e-5]),
        (0.02e-3 / 106.25e6, 200e6, 435e9, vec![-2e-3, -1e-4]),
    ] {
        let case = element(flexibility, yield_stress, hardening);
        let found =
            windows(&over(&case, &[("motion.shift.x", sums(&steps))]), steps.len() as u64, 1.0);
        let compliance = OWN + flexibility;
        let (mut traction, mut plastic) = (0.0_f64, 0.0_f64);
        for (step, contact) in steps.iter().zip(found) {
            let free = traction - step / compliance;
            let yields =
                |plastic: f64| (yield_stress + hardening * plastic).max(0.1 * yield_stress);
            let bound: f64 = 630e6;
            let size = if free.abs() <= bound.min(yields(plastic)) {
                free.abs()
            } else {
                // The spring releases the displacement that the layer takes up.
                let taken =
                    (free.abs() - yields(plastic)) * compliance / (1.0 + hardening * compliance);
                let lowest = (free.abs() - 0.1 * yield_stress) * compliance;
                let taken =
                    if yields(plastic + taken) > 0.1 * yield_stress { taken } else { lowest };
                let taken = if yields(plastic + taken) < bound {
                    taken
                } else {
                    (bound - yields(plastic)) / hardening
                };
                plastic += taken.max(0.0);
                bound.min(yields(plastic))
            };
            traction = size * free.signum();
            assert_close(1e6 * number(&contact, "creep_force_x_n"), traction, 1e-4);
            assert_close(number(&contact, "layer_plastic_shift_m"), plastic, 2e-4);
        }
    }
}

/// Contact of the paper on a layer, at a creepage.
fn rolling(creepage: Value, hardening: f64) -> Value {
    let mut case = paper();
    case["motion"] = json!({"speed": SPEED, "creepage": creepage});
    case["mech"] = json!({"model": "half-space", "resolution": 12});
    case["effects"]["third_body_layer"] = json!({"flexibility": 5e-15});
    case["effects"]["plastic_layer"] = json!({"yield_stress": 250e6, "hardening": hardening});
    case
}

/// Under all creepages the power of friction and layer together equals that of the forces. The
/// share of the layer is a part of it, or all of it if the layer never hardens up to friction.
/// Without hardening the result is that of `shear_limit`. Tolerances: rounding of the balance, 1e-4
/// of the tractions.
#[test]
fn what_the_layer_takes_is_friction_power() {
    for creepage in
        [json!({"xi": -2e-3}), json!({"xi": -2e-3, "eta": 2e-3, "phi": 0.3}), json!({"xi": -2e-2})]
    {
        for hardening in [0.0, 5e12, 1e14, -2e12] {
            let found = run(&rolling(creepage.clone(), hardening));
            let (power, given) = (found.number("friction_power_w"), found.number("creep_power_w"));
            println!(
                "{creepage} {hardening:e}: F_x {} N, {power} W, in the layer {}, area {}, shift {}",
                found.number("creep_force_x_n"),
                found.number("layer_power_w"),
                found.number("layer_area_ratio"),
                found.number("layer_plastic_shift_m")
            );
            assert_close(power, given, 1e-9);
            let part = found.number("layer_power_w");
            assert!(part > 0.01 * power && part <= power, "{part} of {power}");
            if hardening == 0.0 {
                let mut limited = without(rolling(creepage.clone(), 0.0), "plastic_layer");
                limited["effects"]["shear_limit"] = json!({"yield_stress": 250e6});
                let limited = run(&limited);
                for key in ["creep_force_x_n", "friction_power_w", "slip_area_ratio"] {
                    assert_close(found.number(key), limited.number(key), 2e-4);
                }
            }
        }
    }
}

/// After enough rolling, with particles that carry their plastic shift from step to step, a contact
/// reaches its steady state, where shifts accumulate along the rows. The slip zone is so long that
/// both grids are the same. Tolerance: that of tractions.
#[test]
fn rolling_with_memory_comes_to_the_steady_state() {
    for hardening in [5e12, 1e14, -2e12] {
        let creepage = json!({"xi": -5e-3, "eta": 1e-3, "phi": 0.2});
        let steady = run(&rolling(creepage.clone(), hardening));
        let mut case = rolling(creepage, hardening);
        case["mech"]["rolling"] = json!("transient");
        let configuration = Configuration { mode: Mode::Transient, ..configuration(&case) };
        let steps = windows(&configuration, 3, 0.03 / SPEED);
        let last = steps.last().expect("windows");
        for key in [
            "creep_force_x_n",
            "creep_force_y_n",
            "friction_power_w",
            "layer_power_w",
            "layer_plastic_shift_m",
        ] {
            assert_close(number(last, key), steady.number(key), 1e-3);
        }
    }
}

/// Large full slip, where the rigid slip decides: a particle at x carries τ₀ + kξ(x₀ − x), up to
/// the friction limit. Tolerance: the displacement of the bodies relative to the slip distance.
#[test]
fn a_particle_hardens_by_the_way_that_it_slides() {
    let (creepage, hardening) = (0.1, 2e11);
    let mut case = rolling(json!({"xi": -creepage}), hardening);
    case["bodies"]["rail"].as_object_mut().expect("a table").remove("radius_y");
    case["contact"] = json!({"width": 0.1});
    case["mech"]["resolution"] = json!(40);
    case["effects"]["plastic_layer"]["yield_stress"] = json!(100e6);
    let run = run(&case);
    let grid = run.grid().as_structured().expect("a plane");
    let (pressure, traction) = (run.longitudinal("pressure"), run.longitudinal("traction"));
    let enters = (0..grid.ni).rev().find(|i| pressure[*i] * FRICTION > 100e6).expect("it yields");
    let mut flowed = 0;
    for i in (0..enters).filter(|i| pressure[*i] > 0.0) {
        let way = creepage * (grid.x(enters) - grid.x(i));
        let expected = (100e6 + hardening * way).min(FRICTION * pressure[i]);
        assert!(
            (traction[i] - expected).abs() < 0.02 * expected,
            "{i}: {} {expected}",
            traction[i]
        );
        flowed += usize::from(expected < FRICTION * pressure[i]);
    }
    assert!(flowed > 20, "{flowed}");
}

/// A restored contact continues bit for bit like the saved one, and a state without a layer is
/// refused.
#[test]
fn plastic_shifts_are_part_of_the_state() {
    let mut case = rolling(json!({"xi": -3e-3}), 5e12);
    case["mech"]["rolling"] = json!("transient");
    let with = |case: &Value| Configuration { mode: Mode::Transient, ..configuration(case) };
    let window = |model: &mut Box<dyn Model>, store: &mut Store, window: u64| {
        let (start, length) = (window as f64 * 1e-3 / SPEED, 1e-3 / SPEED);
        let step = Step { window, iteration: 1, start, end: start + length };
        model.solve(&step, &NoInputs, store).expect("a solution");
        model.accept();
    };
    let (mut one, mut store) = built(&with(&case));
    (0..3).for_each(|at| window(&mut one, &mut store, at));
    let mut saved = Vec::new();
    one.save(&mut saved).expect("memory");
    let (mut other, mut again) = built(&with(&case));
    other.restore(&mut saved.as_slice()).expect("its own state");
    for at in 3..6 {
        window(&mut one, &mut store, at);
        window(&mut other, &mut again, at);
        assert_eq!(one.summary(), other.summary());
    }
    let (mut bare, _) = built(&with(&without(case, "plastic_layer")));
    assert!(bare.restore(&mut saved.as_slice()).is_err());
}

/// A longitudinal force is met by a creepage, which is larger on a flowing layer.
#[test]
fn a_force_is_met_over_a_layer_that_flows() {
    let mut case = driven(paper(), "traction_coefficient", 0.3);
    case["mech"] = json!({"model": "half-space", "resolution": 12});
    let free = run(&case);
    case["effects"]["plastic_layer"] = json!({"yield_stress": 250e6, "hardening": 5e12});
    let found = run(&case);
    assert_close(found.number("traction_coefficient"), 0.3, 2e-6);
    assert!(found.number("creepage_xi") < 1.02 * free.number("creepage_xi"), "more creepage");
    assert_close(found.number("friction_power_w"), found.number("creep_power_w"), 1e-9);
}

#[test]
fn refused_with_reason_and_fix() {
    let sliding = without(rolling(json!({"xi": -0.05}), 0.0), "partial_slip");
    assert_eq!(refusal(&configuration(&sliding)).key, "effects.partial_slip");
    let jumps = refusal(&configuration(&rolling(json!({"xi": -0.05}), -2.1e14)));
    assert_eq!(jumps.key, "effects.plastic_layer.hardening");
    let both = rolling(json!({"xi": -0.05}), -1.5e14);
    let (mut model, mut store) = built(&configuration(&both));
    let refused = model.solve(&Step::STEADY, &NoInputs, &mut store).unwrap_err().to_string();
    assert!(refused.contains("faster than an element"), "{refused}");
}
