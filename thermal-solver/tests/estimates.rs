//! What the thermal side estimates of a scene before it is run, against what its models find in it.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so does what it calls")]

mod support;

use proto::advice::{Known, Scene};
use proto::configuration::Mode;
use proto::grid::Structured;
use proto::model::Solver;
use proto::params::Params;
use serde_json::{Value, json};
use support::*;
use thermal_solver::ThermalSolver;

/// Friction power [W].
const POWER: f64 = 2e3;

/// What is said of a scene whose contact is an ellipse.
fn opinion(case: &Value, [a, b]: [f64; 2]) -> proto::advice::Opinion {
    let known = [
        ("contact.friction_power_w", POWER),
        ("contact.semi_axis_a_m", a),
        ("contact.semi_axis_b_m", b),
        ("contact.approach_m", 1e-4),
    ];
    let known: Known = known.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
    ThermalSolver.advise(&Scene { case: Params(case.clone()), mode: Mode::Steady, known })
}

/// A model's answer under q₀ √(1 − x²/a² − y²/b²) of the same power, some elements to the smaller semi-axis.
fn solved(model: &str, case: &Value, [a, b]: [f64; 2], speed: f64) -> Run {
    let per_axis = 24.0;
    let sides = [a / per_axis, b / per_axis];
    let half = per_axis as usize + 2;
    let count = 2 * half + 1;
    let [x0, y0] = sides.map(|side| -(half as f64) * side);
    let grid = Structured::contact_plane(x0, y0, sides[0], sides[1], count, count);
    let means = (0..grid.points()).map(|at| {
        let (x, y) = (grid.x(at % count), grid.y(at / count));
        let place = |k: usize| (k as f64 - 3.5) / 8.0;
        let value = |k: usize| {
            let x = (x + place(k % 8) * sides[0]) / a;
            let y = (y + place(k / 8) * sides[1]) / b;
            (1.0 - x * x - y * y).max(0.0).sqrt()
        };
        (0..64).map(value).sum::<f64>() / 64.0
    });
    let means: Vec<f64> = means.collect();
    let sum: f64 = means.iter().sum::<f64>() * grid.element_area();
    let flux: Vec<f64> = means.iter().map(|mean| POWER * mean / sum).collect();
    let mut run = Run::new(model, Mode::Steady, grid, case.clone());
    run.given.speeds = vec![speed; 2];
    run.given.pressure = Some(flux.clone());
    run.advance(&flux, f64::INFINITY);
    run
}

/// A case at a speed, at rest at 0.
fn at(speed: f64) -> Value {
    let mut case = steel();
    case["motion"]["speed"] = json!(speed);
    case
}

const RISE: &str = "temperature.rail.max_rise_k";

/// Ellipses at rest and slow and fast: at rest the closed form, (q₀b/2λ) K(k), to the grid; fast that of heat straight down, to 1/Pe;
/// between the two what is between them, to a tenth, and to a quarter where heat goes sideways out of an ellipse that is six times as long
/// as wide.
#[test]
fn the_rise_is_that_of_the_models() {
    for axes in [[4e-3, 4e-3], [8e-3, 4e-3], [2e-3, 6e-3], [6e-3, 1e-3]] {
        let between = if axes[0] > 2.0 * axes[1] { 0.25 } else { 0.1 };
        for (peclet, tolerance) in [(0.0, 3e-3), (0.5, between), (5.0, between), (1e3, 2e-2)] {
            let speed = 2.0 * DIFFUSIVITY * peclet / axes[0];
            let case = at(speed);
            let estimate = opinion(&case, axes).known[RISE];
            let found = solved("moving-source", &case, axes, speed);
            let found = found.summary("rail", "max_rise_k").unwrap();
            println!("{axes:?} Pe {peclet}: {estimate:.3} K, {found:.3} K");
            let apart = (estimate / found - 1.0).abs();
            assert!(apart < tolerance, "{axes:?} {peclet}: {estimate} {found}");
        }
    }
}

/// What effects change of the largest rise, by what they say and by what a run with and without them finds: of the same sign, and within a
/// factor of two where it is more than a per cent.
#[test]
fn what_effects_change_is_what_they_say() {
    let axes = [6e-3, 4e-3];
    let conducts = |conductance: f64| json!({"conductance": conductance});
    let air = |h: f64| json!({"coefficient": h, "temperature": 293.15});
    let table = [
        ("moving-source", "contact_conductance", conducts(1e5), 0.02),
        ("moving-source", "contact_conductance", conducts(1e3), 0.02),
        ("fe", "convection", air(50.0), 2.0),
        ("fe", "radiation", json!({"emissivity": 0.9, "temperature": 293.15}), 2.0),
    ];
    for (model, effect, law, speed) in table {
        let mut case = at(speed);
        if effect == "contact_conductance" {
            let mut other = case["materials"]["steel"].clone();
            other["conductivity"] = json!(20.0);
            case["materials"]["other"] = other;
            case["bodies"]["wheel"]["material"] = json!("other");
        }
        let mut with = case.clone();
        with["effects"][effect] = law;
        let opinion = opinion(&with, axes);
        let advice = opinion.advice.iter().find(|advice| advice.effect == effect).unwrap();
        let change = advice.change.as_ref().unwrap();
        let body = if change.figure == RISE { "rail" } else { "wheel" };
        let [without, with] = [&case, &with]
            .map(|case| solved(model, case, axes, speed).summary(body, "max_rise_k").unwrap());
        let found = with / without - 1.0;
        println!("{effect} at {speed} m/s: {:.4} said, {found:.4} found", change.relative);
        if found.abs() < 0.01 {
            assert!(change.relative.abs() < 0.01, "{effect} {}", change.relative);
        } else {
            let ratio = change.relative / found;
            assert!((0.5..2.0).contains(&ratio), "{effect} {ratio}");
        }
    }
}
