//! Transformation in time, against closed forms of heated columns.

use crate::support::*;
use proto::configuration::Mode;
use proto::grid::Structured;
use proto::model::Solver;
use serde_json::{Value, json};
use std::f64::consts::PI;
use thermal_solver::ThermalSolver;

const COLUMNS: usize = 400;
const ELEMENT: f64 = 5e-5;
const FLUX: f64 = 1.2e9;
/// Rise at which the steel of these tests transforms [K].
const RISE: f64 = 400.0;

fn plane() -> Structured {
    Structured::contact_plane(0.0, 0.0, ELEMENT, 1e-3, COLUMNS, 1)
}

fn case(table: Value) -> Value {
    let mut case = steel();
    case["effects"]["phase_transformation"] = table;
    case["effects"]["phase_transformation"]["start_temperature"] = json!(293.15 + RISE);
    case
}

fn figures(run: &Run, body: &str) -> impl Fn(&str) -> Option<f64> + use<> {
    let summary = run.model.summary()["white_layer"][body].clone();
    move |name: &str| summary[name].as_f64()
}

/// Returns the flux of the elements.
fn along(of: impl Fn(usize) -> f64) -> Vec<f64> {
    (0..COLUMNS).map(of).collect()
}

/// Returns the rise of a column at a depth, a time after the start of a uniform flux of limited
/// duration (Carslaw & Jaeger, 2.9).
fn pulse(flux: f64, lasts: f64, depth: f64, time: f64) -> f64 {
    let ierfc = |x: f64| (-x * x).exp() / PI.sqrt() - x * (1.0 - libm::erf(x));
    let of = |time: f64| match time > 0.0 {
        true => {
            2.0 * flux * time.sqrt() / effusivity()
                * ierfc(depth / (2.0 * (DIFFUSIVITY * time).sqrt()))
        }
        false => 0.0,
    };
    of(time) - of(time - lasts)
}

/// Returns the time after which a column reaches the required rise under half of a flux [s].
fn crossing(flux: f64) -> f64 {
    PI * (RISE * effusivity() / flux).powi(2)
}

/// Returns the highest rise at a depth over all times [K].
fn highest(lasts: f64, depth: f64) -> f64 {
    let at = |k: i32| pulse(0.5 * FLUX, lasts, depth, f64::from(k) * 1e-3 * lasts);
    (0..=40_000).map(at).fold(0.0, f64::max)
}

/// Returns the largest depth that reaches the required rise, by bisection [m].
fn depth_of(highest: impl Fn(f64) -> f64) -> f64 {
    let (mut inside, mut outside) = (0.0, 1e-2);
    for _ in 0..40 {
        let middle = 0.5 * (inside + outside);
        if highest(middle) > RISE { inside = middle } else { outside = middle }
    }
    inside
}

/// A uniform flux over the length P, switched on for the time D. Material is heated while it passes
/// the flux and the flux is on. Material heated for longer than the time t* to the required rise
/// has the length P + V(D − 2t*). Windows of several elements and of fractions of one. Tolerance:
/// an element at both ends, and the motion in a window in which the rise is not linear.
#[test]
fn the_layer_of_a_passage_is_as_long_as_what_has_been_hot() {
    let heated = 100..300;
    let length = heated.len() as f64 * ELEMENT;
    let passing = length / SPEED;
    assert!(crossing(FLUX) < 0.6 * passing, "the rise is reached before the material has passed");
    for elements in [0.37, 6.3] {
        let window = elements * ELEMENT / SPEED;
        let on = (1.5 * passing / window).round();
        let mut run = Run::new("columns", Mode::Transient, plane(), case(json!({})));
        let flux = along(|column| if heated.contains(&column) { FLUX } else { 0.0 });
        for _ in 0..on as usize {
            run.advance(&flux, window);
        }
        let hot = figures(&run, "rail")("hot_length_m").unwrap();
        for _ in 0..(3.0 * passing / window) as usize {
            run.advance(&along(|_| 0.0), window);
        }
        let rail = figures(&run, "rail");
        let expected = length + SPEED * (on * window - 2.0 * crossing(FLUX));
        let found = rail("length_m").unwrap();
        let depth = depth_of(|depth| highest(passing, depth));
        println!(
            "{elements}: {found:e} {expected:e}, depth {:e} {depth:e}",
            rail("depth_m").unwrap()
        );
        let tolerance = (2.0 + elements) * ELEMENT;
        assert!((found - expected).abs() < tolerance, "{found} {expected}");
        assert!(hot > 0.0 && hot < found, "{hot}");
        assert_eq!(rail("hot_length_m"), Some(0.0), "all has cooled");
        assert_eq!(rail("width_m"), Some(1e-3));
        assert!((rail("depth_m").unwrap() / depth - 1.0).abs() < 0.02);
        let rate = rail("heating_rate_k_per_s").unwrap();
        let heating = 0.5 * RISE / crossing(FLUX);
        assert!((rate / heating - 1.0).abs() < 0.1, "{rate} {heating}");
    }
}

/// A locked wheel under a flux that falls linearly to both sides. The layer is the heated patch,
/// with the length and depth of the closed form. It is hot at the end of the slide, and quenched
/// after cooling. The middle cools last and slowest: with a critical rate above its rate only the
/// edges remain. Tolerance: elements at both ends of both edges; windows (rates).
#[test]
fn the_layer_of_a_locked_wheel_is_the_patch_that_was_hot() {
    let (slide, window) = (4e-3, 2e-5);
    let middle = 200;
    let half = 150.0;
    let of = |column: usize| FLUX * (1.0 - column.abs_diff(middle) as f64 / half).max(0.0);
    let needed = FLUX * (crossing(FLUX) / slide).sqrt();
    let length = 2.0 * half * ELEMENT * (1.0 - needed / FLUX);
    // Time at which a column under this fraction of the flux has cooled, and its cooling rate.
    let cooled = |part: f64| {
        let surface = |time: f64| pulse(0.5 * part * FLUX, slide, 0.0, time);
        let (mut warm, mut cold) = (slide, 1e3 * slide);
        for _ in 0..60 {
            let between = 0.5 * (warm + cold);
            if surface(between) > RISE { warm = between } else { cold = between }
        }
        let step = 1e-3 * (warm - slide);
        (warm, (surface(warm - step) - surface(warm + step)) / (2.0 * step))
    };
    let (last, quench) = cooled(1.0);
    let critical = 10.0 * quench;
    let (mut fast, mut slow) = (needed / FLUX, 1.0);
    for _ in 0..60 {
        let between = 0.5 * (fast + slow);
        if cooled(between).1 > critical { fast = between } else { slow = between }
    }
    let edges = 2.0 * half * ELEMENT * (fast - needed / FLUX);
    for (critical, expected) in [(100.0, length), (critical, edges)] {
        let mut locked = case(json!({"critical_cooling_rate": critical}));
        locked["bodies"]["wheel"]["surface_speed"] = json!(0.0);
        let mut run = Run::new("columns", Mode::Transient, plane(), locked.clone());
        run.given.speeds = vec![0.0, SPEED];
        let flux = along(of);
        let mut state = Vec::new();
        for at in 0..(slide / window).round() as usize {
            if at == 90 {
                run.model.save(&mut state).unwrap();
            }
            run.advance(&flux, window);
        }
        // A run resumed from an intermediate state gives the same layer.
        let mut resumed = Run::new("columns", Mode::Transient, plane(), locked);
        resumed.given.speeds = vec![0.0, SPEED];
        resumed.model.restore(&mut state.as_slice()).unwrap();
        for _ in 90..(slide / window).round() as usize {
            resumed.advance(&flux, window);
        }
        assert_eq!(run.model.summary(), resumed.model.summary());
        let wheel = figures(&run, "wheel");
        let found = wheel("length_m").unwrap();
        let depth = depth_of(|depth| pulse(0.5 * FLUX, slide, depth, slide));
        println!("{found:e} {length:e}, {:e} {depth:e}", wheel("depth_m").unwrap());
        assert!((found - length).abs() < 2.0 * ELEMENT, "{found} {length}");
        assert_eq!(wheel("hot_length_m"), Some(found), "the slide has just ended");
        assert_eq!(wheel("cooling_rate_k_per_s"), None);
        assert!((wheel("depth_m").unwrap() / depth - 1.0).abs() < 0.01);
        while run.time < 1.05 * last {
            run.advance(&along(|_| 0.0), 2.0 * window);
        }
        let wheel = figures(&run, "wheel");
        assert_eq!(wheel("hot_length_m"), Some(0.0));
        let slowest = wheel("cooling_rate_k_per_s").unwrap();
        assert!((slowest / quench - 1.0).abs() < 0.02, "{slowest} {quench}");
        let left = wheel("length_m").unwrap();
        println!("critical rate {critical:e} K/s: {left:e} {expected:e}");
        assert!((left - expected).abs() < 4.0 * ELEMENT, "{left} {expected}");
        if critical < quench {
            let depth = depth_of(|depth| highest(slide, depth));
            let reached = wheel("depth_m").unwrap();
            assert!((reached / depth - 1.0).abs() < 0.01, "{reached} {depth}");
        }
    }
}

/// Steady case: the layer of a moving body has no length; the layer of a body at rest has the
/// length of its hot part.
#[test]
fn a_steady_layer_has_a_length_where_the_material_stays() {
    let flux = along(|column| if (100..300).contains(&column) { FLUX } else { 0.0 });
    let mut run = Run::new("moving-source", Mode::Steady, plane(), case(json!({})));
    run.advance(&flux, 0.0);
    assert!(figures(&run, "rail")("depth_m").unwrap() > 0.0);
    assert_eq!(figures(&run, "rail")("length_m"), None);
    let mut locked = case(json!({}));
    locked["bodies"]["wheel"]["surface_speed"] = json!(0.0);
    let mut run = Run::new("moving-source", Mode::Steady, plane(), locked);
    run.given.speeds = vec![0.0, SPEED];
    run.advance(&flux, 0.0);
    let wheel = figures(&run, "wheel");
    let hot = |row: &[f64]| row.iter().filter(|rise| **rise >= RISE).count();
    let longest = run.wheel().chunks_exact(COLUMNS).map(hot).max().unwrap();
    assert!(longest > 200, "the layer extends beyond the flux: {longest}");
    assert_eq!(wheel("length_m"), Some(longest as f64 * ELEMENT));
    assert_eq!(wheel("hot_length_m"), wheel("length_m"));
    assert!(wheel("depth_m").unwrap() > ELEMENT);
    assert_eq!(figures(&run, "rail")("length_m"), None);
}

/// Repeating contacts are refused in time, because a place that has passed returns.
#[test]
fn places_that_come_again_are_refused_in_time() {
    let given = configuration("periodic", Mode::Transient, plane(), case(json!({})));
    let refused = ThermalSolver.configure(&given).err().unwrap();
    assert_eq!(refused.key, "effects.phase_transformation");
}
