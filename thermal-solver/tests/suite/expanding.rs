//! Rise integrals through the contract: in time and steady, for both models that compute them.

use crate::support::*;
use proto::configuration::Mode;
use proto::grid::Structured;
use proto::model::Solver;
use serde_json::{Value, json};
use thermal_solver::ThermalSolver;

const MODELS: [&str; 2] = ["columns", "moving-source"];

fn case() -> Value {
    let mut case = steel();
    case["effects"]["thermal_expansion"] = json!({});
    case
}

/// A grid from one and a half semi-axes behind to one and a half ahead, with a heated square in the
/// middle.
fn heated() -> (Structured, Vec<f64>) {
    let h = SEMI_AXIS / 8.0;
    let grid = Structured::contact_plane(-12.0 * h, -8.0 * h, h, h, 25, 17);
    let inside = |at: usize| grid.x(at % grid.ni).abs().max(grid.y(at / grid.ni).abs()) < 5.5 * h;
    let flux = (0..grid.points()).map(|at| if inside(at) { 4e8 } else { 0.0 }).collect();
    (grid, flux)
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most: f64, value| most.max(value.abs()))
}

/// Windows of half an element, continued until the heated material has left the grid, end in the
/// steady integrals. Tolerance: the dropped material that has left the grid, of the order of the
/// heated depth over the length of the grid.
#[test]
fn windows_end_in_the_steady_integral() {
    let (grid, flux) = heated();
    for model in MODELS {
        let mut steady = Run::new(model, Mode::Steady, grid, case());
        steady.advance(&flux, f64::INFINITY);
        let mut moving = Run::new(model, Mode::Transient, grid, case());
        for _ in 0..80 {
            moving.advance(&flux, 0.5 * grid.dx() / SPEED);
        }
        for integral in INTEGRALS {
            let [one, other] = [&steady, &moving].map(|run| run.surfaces.of(integral));
            let apart = one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            println!("{model} {}: {:.1e}", integral.name, apart / largest(one));
            assert!(apart < 3e-3 * largest(one), "{model} {}", integral.name);
        }
    }
}

/// Both models give the same integral for the same flux: columns use the integral of half-spaces
/// too. Tolerance: rounding.
#[test]
fn both_models_have_one_integral() {
    let (grid, flux) = heated();
    let of = |model: &str| {
        let mut run = Run::new(model, Mode::Steady, grid, case());
        run.advance(&flux, f64::INFINITY);
        run.surfaces.of(INTEGRALS[0]).to_vec()
    };
    let [columns, exact] = MODELS.map(of);
    let apart = columns.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-9 * largest(&exact), "{apart:e}");
}

/// Finite elements integrate the heat of their nodes. Tolerance: 0.1 % in the middle, from jumps of
/// the flux at the sides of its elements and heat far behind the grid; 1 % for windows of half an
/// element in time.
#[test]
fn finite_elements_have_the_same_integral() {
    let (grid, flux) = heated();
    let of = |model: &str, duration: f64, windows: usize| {
        let mode = if duration.is_finite() { Mode::Transient } else { Mode::Steady };
        let mut run = Run::new(model, mode, grid, case());
        for _ in 0..windows {
            run.advance(&flux, duration);
        }
        run.surfaces.of(INTEGRALS[0]).to_vec()
    };
    for (duration, windows) in [(f64::INFINITY, 1), (0.5 * grid.dx() / SPEED, 12)] {
        let [exact, elements] = ["moving-source", "fe"].map(|model| of(model, duration, windows));
        let apart = exact.iter().zip(&elements).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        println!("{duration}: {:.1e}", apart / largest(&exact));
        let middle = (8 * grid.ni..9 * grid.ni).filter(|at| flux[*at] > 0.0);
        let inside = middle.map(|at| (exact[at] - elements[at]).abs()).fold(0.0, f64::max);
        assert!(inside < 1e-2 * largest(&exact), "{duration}: {inside:e}");
        assert!(apart < 0.015 * largest(&exact), "{duration}: {apart:e} of {:e}", largest(&exact));
    }
}

/// A restored state continues with bit-identical integrals.
#[test]
fn a_restored_state_has_the_same_integrals() {
    let (grid, flux) = heated();
    let window = 0.7 * grid.dx() / SPEED;
    for model in MODELS {
        let mut whole = Run::new(model, Mode::Transient, grid, case());
        for _ in 0..5 {
            whole.advance(&flux, window);
        }
        let mut saved = Vec::new();
        whole.model.save(&mut saved).unwrap();
        let mut resumed = Run::new(model, Mode::Transient, grid, case());
        resumed.model.restore(&mut saved.as_slice()).unwrap();
        for run in [&mut whole, &mut resumed] {
            run.time = 5.0 * window;
            run.advance(&flux, window);
        }
        assert_eq!(whole.surfaces.0, resumed.surfaces.0, "{model}");
    }
}

/// The surface of a body that is heated at one place for ever rises without limit.
#[test]
fn a_body_at_rest_has_no_steady_height() {
    let mut case = case();
    case["bodies"]["wheel"]["surface_speed"] = json!(0.0);
    let given = configuration("moving-source", Mode::Steady, heated().0, case);
    let refusal = ThermalSolver.configure(&given).err().unwrap();
    assert_eq!(refusal.key, "bodies.wheel.surface_speed");
    let (grid, flux) = heated();
    let mut run = Run::new("moving-source", Mode::Steady, grid, self::case());
    run.given.speeds = vec![0.0, SPEED];
    let error = run.try_solve(&flux, f64::INFINITY).unwrap_err().to_string();
    assert!(error.contains("no steady height"), "{error}");
    assert!(refusal.reason.contains("no steady height"), "{refusal}");
}
