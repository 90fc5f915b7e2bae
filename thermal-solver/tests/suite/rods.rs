//! Model `rod` against closed forms.

use crate::support::{DIFFUSIVITY, Run, configuration, effusivity, steel};
use proto::configuration::Mode;
use proto::grid::Structured;
use proto::model::Solver;
use serde_json::{Value, json};
use std::f64::consts::PI;
use thermal_solver::ThermalSolver;

const LENGTH: f64 = 0.02;
const CONDUCTIVITY: f64 = 50.0;
const FLUX: f64 = 1e6;

/// The lower body is a rod; the upper body keeps its initial temperature.
fn case() -> Value {
    let mut case = steel();
    case["bodies"]["rail"]["length"] = json!(LENGTH);
    case["motion"] = json!({"speed": 0.0});
    case
}

fn run(mode: Mode) -> Run {
    let end = Structured::contact_plane(0.0, 0.0, 0.01, 0.01, 1, 1);
    let mut run = Run::new("rod", mode, end, case());
    run.given.speeds = vec![0.0; 2];
    run
}

/// A flux that begins at once: 2q√(t/π)/β until the far end has an influence, qL/λ finally, in
/// windows of any length. The share of the body without a rise is lost. Tolerances: neglected
/// modes, which decay within 1e-5 of L²/κ.
#[test]
fn a_rod_that_is_heated() {
    let unit = LENGTH * LENGTH / DIFFUSIVITY;
    for windows in [vec![0.01], vec![0.001; 10], vec![1e-9, 0.004, 0.006 - 1e-9]] {
        let mut rod = run(Mode::Transient);
        for part in &windows {
            rod.advance(&[FLUX], part * unit);
        }
        let expected = FLUX * (0.01 * unit / PI).sqrt() / effusivity();
        let found = rod.rail()[0];
        assert!((found / expected - 1.0).abs() < 1e-6, "{windows:?}: {found} {expected}");
        assert_eq!(rod.wheel(), [0.0]);
    }
    let mut late = run(Mode::Transient);
    for _ in 0..10 {
        late.advance(&[FLUX], unit);
    }
    let steady = 0.5 * FLUX * LENGTH / CONDUCTIVITY;
    assert!((late.rail()[0] / steady - 1.0).abs() < 1e-9, "{}", late.rail()[0]);
    let mut rod = run(Mode::Steady);
    rod.advance(&[FLUX], 0.0);
    assert!((rod.rail()[0] / steady - 1.0).abs() < 1e-14, "{}", rod.rail()[0]);
}

/// A rod restored during a run continues bit-identically.
#[test]
fn a_restored_rod_goes_on() {
    let window = |run: &mut Run, step: i32| {
        run.advance(&[FLUX * f64::from(step)], 0.3);
    };
    let mut one = run(Mode::Transient);
    (0..5).for_each(|step| window(&mut one, step));
    let mut saved = Vec::new();
    one.model.save(&mut saved).unwrap();
    let mut other = run(Mode::Transient);
    other.model.restore(&mut saved.as_slice()).unwrap();
    other.time = one.time;
    (5..9).for_each(|step| window(&mut one, step));
    (5..9).for_each(|step| window(&mut other, step));
    assert_eq!(one.surfaces.0, other.surfaces.0);
    assert_eq!(one.model.summary(), other.model.summary());
}

#[test]
fn what_is_no_rod_is_refused() {
    let end = Structured::contact_plane(0.0, 0.0, 0.01, 0.01, 1, 1);
    let refused = |grid: Structured, change: &dyn Fn(&mut Value)| {
        let mut case = case();
        change(&mut case);
        let given = configuration("rod", Mode::Steady, grid, case);
        ThermalSolver.configure(&given).err().unwrap().key
    };
    let wide = Structured { ni: 2, ..end };
    assert_eq!(refused(wide, &|_| ()), "thermal.model");
    assert_eq!(
        refused(end, &|case| case["bodies"]["rail"]["length"] = json!(-1.0)),
        "bodies.rail.length"
    );
    assert_eq!(
        refused(end, &|case| case["bodies"]["wheel"]["start_rise"] = json!(5.0)),
        "bodies.wheel.start_rise"
    );
}
