//! The contact force as a field, as received by vehicle models.

use crate::common::{
    NoInputs, Store, assert_close, configuration, driven, fields_of, fitted, paper,
};
use mech_solver::MechSolver;
use proto::grid::Grid;
use proto::model::{Model, Solver, Step};
use proto::progress::Progress;
use serde_json::{Value, json};

/// Force, sums of pressure and traction over the elements [N], and the summary.
fn forces_and_summary(case: &Value) -> ([f64; 3], [f64; 3], Value) {
    let mut configuration = configuration(case);
    configuration.outputs = [fields_of(case), vec!["contact_force".to_owned()]].concat();
    let setup = MechSolver.configure(&configuration).expect("a case that can be");
    let layout = setup.layout().clone();
    let mut store = Store::for_layout(&layout, &configuration.outputs);
    let mut model: Box<dyn Model> =
        setup.build(&Progress::default()).expect("a checked case builds");
    model.solve(&Step::STEADY, &NoInputs, &mut store).expect("a solution");
    model.accept();
    assert_eq!(layout.grid_of("contact_force").map(Grid::points), Some(1));
    let grid = layout.grid_of("pressure").expect("always there");
    let (x, y) = store.0["traction"].split_at(grid.points());
    let sums = [x, y, &store.0["pressure"]].map(|values| grid.integrate(values));
    let force = store.0["contact_force"].as_slice().try_into().expect("three components");
    (force, sums, model.summary())
}

fn forces(case: &Value) -> ([f64; 3], [f64; 3]) {
    let (force, sums, _) = forces_and_summary(case);
    (force, sums)
}

/// The force is the integral of the tractions on the upper body, positive forward for a driving
/// wheel, and of the pressure.
#[test]
fn the_force_is_that_of_pressure_and_traction() {
    for model in ["hertz-carter", "fastsim", "half-space"] {
        let mut case = paper();
        case["mech"]["model"] = json!(model);
        let (force, sums) = forces(&case);
        assert!(force[0] > 0.0 && force[2] > 0.0, "{model}: {force:?}");
        for (part, sum) in force.into_iter().zip(sums) {
            // Tolerance: rounding of the sums over the elements, relative to 134 kN; the lateral
            // force is zero.
            assert!((part - sum).abs() < 1e-9 * force[2], "{model}: {force:?}, {sums:?}");
        }
        assert_close(force[2], 134e3, 1e-9);
    }
    for model in ["fastsim", "half-space"] {
        let mut case = driven(paper(), "creepage", 1e-3);
        case["mech"]["model"] = json!(model);
        case["motion"]["creepage"]["eta"] = json!(-2e-3);
        let (force, sums) = forces(&case);
        assert!(
            force[0] < 0.0 && force[1] > 0.0,
            "a braking wheel that drifts to the right: {force:?}"
        );
        assert!((force[1] - sums[1]).abs() < 1e-9 * force[2], "{model}: {force:?}, {sums:?}");
    }
}

/// On a track the force acts on the wheel in track axes; for two wheels it is their sum.
#[test]
fn on_a_track_the_force_is_that_of_the_wheels() {
    for load in [json!({"vertical_force": 100e3}), json!({"axle_load": 150e3})] {
        let mut case = fitted(paper(), "wheel-on-track");
        let side = if load["axle_load"].is_null() { "left" } else { "both" };
        case["wheelset"]["side"] = json!(side);
        case["load"] = load;
        case["mech"]["resolution"] = json!(15);
        let (force, _, summary) = forces_and_summary(&case);
        let told = ["force_x_n", "force_y_n", "force_z_n"]
            .map(|key| summary["wheelset"][key].as_f64().expect("a figure"));
        assert_eq!(force, told);
        assert!(force[2] > 99e3);
    }
}
