//! Models whose contact has no inertia, under an axle with inertia.

use super::common::{NoInputs, RADIUS, SPEED, Store, assert_close, configuration, paper, refusal};
use mech_solver::MechSolver;
use proto::configuration::{Configuration, Mode};
use proto::model::{Solver, Step};
use proto::progress::Progress;
use serde_json::{Value, json};
use std::f64::consts::PI;

const LOAD: f64 = 134e3;
const MASS: f64 = 900.0;
const STIFFNESS: f64 = 1150e3;
const DAMPING: f64 = 2500.0;
const WINDOW: f64 = 50e-6;

fn case(model: &str, form: &str, depth: f64, length: f64) -> Value {
    let mut case = paper();
    case["motion"] = json!({"speed": SPEED, "creepage": {"xi": -3e-3}});
    case["mech"] = json!({"model": model, "resolution": 8});
    case["effects"]["suspension"] = json!({"mass": MASS, "stiffness": STIFFNESS, "damping": DAMPING,
        "irregularity": form, "depth": depth, "length": length, "at": 0.06});
    case
}

fn in_time(case: &Value) -> Configuration {
    Configuration { mode: Mode::Transient, ..configuration(case) }
}

/// Normal forces of windows, and the largest force and the time without contact reported by the
/// last one.
fn forces(case: &Value, windows: u64) -> (Vec<f64>, [f64; 2]) {
    let configuration = in_time(case);
    let setup = MechSolver.configure(&configuration).unwrap_or_else(|error| panic!("{error}"));
    let layout = setup.layout().clone();
    let mut model = setup.build(&Progress::default()).expect("a checked case builds");
    let mut found = Vec::new();
    for window in 0..windows {
        let mut store = Store::for_layout(&layout, &configuration.outputs);
        let [start, end] = [window, window + 1].map(|at| at as f64 * WINDOW);
        let step = Step { window, iteration: 1, start, end };
        model.solve(&step, &NoInputs, &mut store).expect("a solution");
        model.accept();
        let force =
            layout.grid_of("pressure").expect("always there").integrate(&store.0["pressure"]);
        found.push(force);
    }
    let summary = model.summary();
    let number =
        |key: &str| summary["contact"][key].as_f64().unwrap_or_else(|| panic!("{summary}"));
    (found, [number("largest_normal_force_n"), number("apart_s")])
}

/// Independent integration of the same wheel: the minimum over the rail's hollow under the whole
/// round wheel at a thousand positions, the semi-implicit Euler scheme with a step of 0.1 µs,
/// Hertz's spring by its exponent.
fn independently(form: &str, depth: f64, length: f64, windows: u64) -> (Vec<f64>, [f64; 2]) {
    // Hertz's approach δ_H of the paper's contact, in closed form [m].
    let still = 126.5461e-6;
    let hollow = |way: f64| {
        let from = way - 0.06;
        match form {
            _ if 2.0 * from.abs() >= length => 0.0,
            "joint" => depth * (1.0 - 2.0 * from.abs() / length),
            _ => 0.5 * depth * (1.0 + (2.0 * PI * from / length).cos()),
        }
    };
    let reach = (2.0 * RADIUS * depth).sqrt();
    let bridged = |way: f64| {
        let places = (-500..=500).map(|k| reach * f64::from(k) / 500.0);
        places.map(|xi| hollow(way + xi) + 0.5 * xi * xi / RADIUS).fold(f64::INFINITY, f64::min)
    };
    let (step, steps) = (1e-7, (WINDOW / 1e-7).round() as u64);
    let (mut raised, mut rising, mut largest, mut apart) = (0.0, 0.0, LOAD, 0.0);
    let mut means = Vec::new();
    for window in 0..windows {
        let mut mean = 0.0;
        // The position hardly changes in a step: its hollow is evaluated twice a microsecond.
        let mut below = 0.0;
        for sub in 0..steps {
            if sub % 5 == 0 {
                below = bridged(SPEED * step * (window * steps + sub + 2) as f64);
            }
            let approach: f64 = (still - raised - below).max(0.0);
            let force = LOAD * (approach / still).powf(1.5);
            rising += step * (force - LOAD - STIFFNESS * raised - DAMPING * rising) / MASS;
            raised += step * rising;
            mean += force / steps as f64;
            largest = largest.max(force);
            apart += if force == 0.0 { step } else { 0.0 };
        }
        means.push(mean);
    }
    (means, [largest, apart])
}

/// A wheel over a dip and over a joint, with loss and return of contact: the forces of the windows
/// against an independent integration, for all three models. Tolerances: 1 % of the largest force,
/// the error of the Euler scheme and of the sampling at the kink; the element size in which a
/// contact is resolved.
#[test]
fn a_wheel_over_a_joint_moves_as_integrated_independently() {
    for (form, depth, length) in [("dip", 0.1e-3, 0.08), ("joint", 0.5e-3, 0.08)] {
        let (expected, [most, without]) = independently(form, depth, length, 80);
        for model in ["hertz-carter", "fastsim", "half-space"] {
            let (found, [largest, apart]) = forces(&case(model, form, depth, length), 80);
            let worst = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            println!(
                "{form} {model}: {largest:.4e} {most:.4e} N, {apart:.3e} {without:.3e} s, {:.4}",
                worst / most
            );
            assert!(worst < 0.01 * most, "{form} {model}: {worst} of {most} N");
            assert_close(largest, most, 0.01);
            assert!((apart - without).abs() < 0.01 * without + 1e-5, "{apart} {without}");
        }
        assert!(
            (form == "joint") == (without > 1e-4),
            "contact is lost over the joint alone: {without}"
        );
    }
}

/// A smooth surface changes nothing, and a flat returns after a turn.
#[test]
fn nothing_to_run_over_and_a_flat() {
    let mut smooth = case("hertz-carter", "dip", 1e-4, 0.05);
    smooth["effects"]["suspension"] = json!({"mass": MASS});
    let (still, [largest, apart]) = forces(&smooth, 3);
    // The fields are element means of Hertz's ellipse.
    assert!(still.iter().all(|force| (force / LOAD - 1.0).abs() < 1e-9), "{still:?}");
    assert_eq!((largest, apart), (LOAD, 0.0));
    let turn = 2.0 * PI * RADIUS / SPEED;
    // Damping much higher than on a railway, so that the wheel is at rest before the flat returns.
    let mut flat = case("hertz-carter", "flat", 0.1e-3, 0.04);
    flat["effects"]["suspension"]["damping"] = json!(4e5);
    let (forces, _) = forces(&flat, ((turn + 3e-3) / WINDOW) as u64);
    let least = |from: f64, to: f64| {
        forces[(from / WINDOW) as usize..(to / WINDOW) as usize]
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min)
    };
    let first = 0.06 / SPEED;
    let [once, between, again] = [
        least(first - 1e-3, first + 1e-3),
        least(turn - 5e-3, turn - 1e-3),
        least(first + turn - 1e-3, first + turn + 1e-3),
    ];
    assert!(
        once < 0.5 * LOAD && again < 0.5 * LOAD && between > 0.8 * LOAD,
        "{once} {between} {again}"
    );
}

/// A prescribed force is lost with the contact: that window has none, and the following ones have
/// it again.
#[test]
fn a_force_is_lost_with_the_contact() {
    for model in ["hertz-carter", "fastsim", "half-space"] {
        let mut joint = case(model, "joint", 0.5e-3, 0.08);
        joint["motion"] = json!({"speed": SPEED, "traction_coefficient": 0.2});
        let (found, [_, apart]) = forces(&joint, 80);
        let lost = found.iter().filter(|force| **force < 1e-5 * LOAD).count();
        assert!(apart > 1e-3 && lost > 10, "{model}: {apart} {lost}");
        assert!(found[79] > 0.1 * LOAD, "{model}: {}", found[79]);
    }
}

/// A damper far stiffer than its mass is integrated with steps of its own time constant, and keeps
/// the wheel in place.
#[test]
fn a_stiff_damper_is_followed() {
    let mut dip = case("hertz-carter", "dip", 0.1e-3, 0.08);
    dip["effects"]["suspension"]["damping"] = json!(2e8);
    let (found, _) = forces(&dip, 60);
    let least = found.iter().copied().fold(f64::INFINITY, f64::min);
    // The wheel stays in place, and the rail's hollow takes most of the approach.
    assert!(least < 0.2 * LOAD && found.iter().all(|force| *force < 1.2 * LOAD), "{least}");
}

#[test]
fn an_axle_that_has_no_answer_is_refused() {
    let dip = case("half-space", "dip", 1e-4, 0.05);
    assert_eq!(refusal(&configuration(&dip)).key, "effects.suspension");
    let mut driven = dip.clone();
    driven["effects"]["suspension"]["rotary_inertia"] = json!(100.0);
    assert!(refusal(&in_time(&driven)).reason.contains("speed of the surface"));
    let mut remembers = dip;
    remembers["mech"]["rolling"] = json!("transient");
    assert_eq!(refusal(&in_time(&remembers)).key, "mech.rolling");
}
