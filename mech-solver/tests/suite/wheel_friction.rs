//! Friction that depends on slip or temperature, on a wheel on a track.

use super::common::{FRICTION, Run, configuration, fitted, paper, refusal, run};
use mech_solver::MechSolver;
use proto::field::FieldSpec;
use proto::grid::{Grid, Structured};
use proto::model::{InputField, Inputs, Solver, Step};
use proto::progress::Progress;
use serde_json::{Value, json};

use super::common::Store;

const RATIO: f64 = 0.4;
const DECREASE: f64 = 0.6;

fn on_track() -> Value {
    let mut case = fitted(paper(), "wheel-on-track");
    case["mech"]["resolution"] = json!(20);
    case["wheelset"]["y"] = json!(3e-3);
    case
}

fn falling(extra: Value) -> Value {
    let mut case = on_track();
    case["effects"]["speed_friction"] = json!({"ratio": RATIO, "decrease": DECREASE});
    for (key, value) in extra.as_object().expect("a table") {
        case["effects"]["speed_friction"][key] = value.clone();
    }
    case
}

/// Traction over pressure, and slip velocity, of every slipping element with a pressure above a
/// share of the largest.
fn sliding(run: &Run) -> Vec<[f64; 2]> {
    let pressure = &run.fields["pressure"];
    let count = pressure.len();
    let size = |field: &str, at: usize| {
        let values = &run.fields[field];
        values[at].hypot(values[count + at])
    };
    let largest = pressure.iter().copied().fold(0.0, f64::max);
    let pressed = (0..count).filter(|at| pressure[*at] > 0.05 * largest);
    pressed.map(|at| [size("traction", at) / pressure[at], size("slip_velocity", at)]).collect()
}

fn friction_at(velocity: f64) -> f64 {
    FRICTION * ((1.0 - RATIO) * (-DECREASE * velocity).exp() + RATIO)
}

/// Full sliding: every element has the friction of its own rigid slip. Tolerance: slip is taken a
/// sixth of an element ahead of the middle, where it differs because of spin.
#[test]
fn elements_that_slide_have_the_friction_of_their_slip() {
    let mut case = falling(json!({}));
    case["effects"].as_object_mut().expect("a table").remove("partial_slip");
    for slip in ["surfaces", "plane"] {
        case["mech"]["rigid_slip"] = json!(slip);
        let elements = sliding(&run(&case));
        assert!(elements.len() > 50);
        for [friction, velocity] in elements {
            let expected = friction_at(velocity);
            assert!((friction / expected - 1.0).abs() < 2e-3, "{velocity}: {friction} {expected}");
            assert!(expected < 0.98 * FRICTION);
        }
    }
}

/// Friction that depends on local slip: all slipping elements have the friction of that slip.
/// Tolerance: tractions converge to 1e-5 of the largest.
#[test]
fn friction_follows_the_slip_of_elements() {
    for start in ["below", "above"] {
        let mut case = falling(json!({"slip": "local", "start": start}));
        case["wheelset"]["yaw"] = json!(4e-3);
        let found = run(&case);
        let slipping: Vec<_> =
            sliding(&found).into_iter().filter(|[_, velocity]| *velocity > 1e-3).collect();
        assert!(slipping.len() > 50, "{}", slipping.len());
        for [friction, velocity] in &slipping {
            let expected = friction_at(*velocity);
            assert!((friction / expected - 1.0).abs() < 1e-3, "{velocity}: {friction} {expected}");
        }
        let least = slipping.iter().map(|[friction, _]| *friction).fold(f64::INFINITY, f64::min);
        assert!(least < 0.95 * FRICTION, "the law says something: {least}");
    }
}

/// A law without a fall is constant friction, for either slip, on half-spaces and springs.
/// Tolerance: that of the tractions.
#[test]
fn no_fall_is_constant_friction() {
    for tangential in ["half-space", "fastsim", "fastrip"] {
        let mut plain = on_track();
        plain["mech"]["tangential"] = json!(tangential);
        let force = |case: &Value| run(case).model.summary()["wheelset"]["force_y_n"].as_f64();
        let expected = force(&plain).expect("a force");
        for slip in ["rigid", "local"] {
            let mut level = falling(json!({"slip": slip, "ratio": 1.0}));
            level["mech"]["tangential"] = json!(tangential);
            if slip == "local" && tangential != "half-space" {
                let refused = refusal(&configuration(&level));
                assert_eq!(refused.key, "mech.tangential");
                continue;
            }
            let found = force(&level).expect("a force");
            assert!(
                (found / expected - 1.0).abs() < 1e-5,
                "{tangential} {slip}: {found} {expected}"
            );
        }
    }
}

/// Surface with one temperature rise below y = 0 on the grid of the fields, and another above.
struct Lanes(Grid, [f64; 2]);

impl Lanes {
    fn of(below: f64, above: f64) -> Self {
        let lanes = Structured::contact_plane(-0.5, -1e-6, 1.0, 2e-6, 1, 2);
        Self(Grid::structured("contact", lanes), [below, above])
    }
}

impl Inputs for Lanes {
    fn get(&self, field: &FieldSpec) -> Option<InputField<'_>> {
        let wanted = field.name.ends_with("_temperature");
        wanted.then_some(InputField { values: &self.1, grid: &self.0 })
    }
}

/// Lateral forces of the wheels at these temperatures, from left to right.
fn lateral_forces(case: &Value, inputs: &dyn Inputs) -> Vec<f64> {
    let configuration = configuration(case);
    let setup = MechSolver.configure(&configuration).unwrap_or_else(|error| panic!("{error}"));
    let mut store = Store::for_layout(setup.layout(), &configuration.outputs);
    let mut model = setup.build(&Progress::default()).expect("a checked case builds");
    model.first_outputs(&mut store);
    assert!(store.0["pressure"].iter().all(|p| *p == 0.0), "nothing came in yet");
    assert!(store.0["surface_speed"].iter().all(|speed| *speed > 0.0));
    model.solve(&Step::STEADY, inputs, &mut store).expect("an answer");
    model.accept();
    let wheels = &model.summary()["wheelset"];
    ["left", "right"].iter().filter_map(|side| wheels[side]["force_y_n"].as_f64()).collect()
}

/// Every wheel has the friction of the temperature on its own lane. Tolerance: that of heights and
/// forces.
#[test]
fn every_wheel_has_the_friction_of_its_own_lane() {
    let mut case = on_track();
    case["wheelset"]["side"] = json!("both");
    case["wheelset"]["y"] = json!(0.0);
    case["wheelset"]["yaw"] = json!(6e-3);
    case["load"] = json!({"axle_load": 200e3});
    let mut warm = case.clone();
    warm["effects"]["temperature_friction"] = json!({"limit": 0.1, "decay_temperature": 100.0});
    let at = |below: f64, above: f64| lateral_forces(&warm, &Lanes::of(below, above));
    let (cold, hot, left) = (at(0.0, 0.0), at(80.0, 80.0), at(0.0, 80.0));
    println!("{cold:?} {hot:?} {left:?}");
    assert!(hot[0].abs() < 0.8 * cold[0].abs() && hot[1].abs() < 0.8 * cold[1].abs());
    // The roll under both loads differs, which changes the creepages.
    assert!((left[0] / hot[0] - 1.0).abs() < 5e-3 && (left[1] / cold[1] - 1.0).abs() < 5e-3);
    // Same force as without the effect.
    let plain = run(&case).model.summary()["wheelset"]["left"]["force_y_n"].as_f64();
    assert!((cold[0] / plain.expect("a force") - 1.0).abs() < 1e-4);
}
