//! `moving-source` through the contract: the paper's case, what flows between the surfaces, its state.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so does what it calls")]

mod support;

use proto::configuration::Mode;
use proto::field;
use proto::grid::Structured;
use proto::model::Solver;
use serde_json::{Value, json};
use support::*;
use thermal_solver::ThermalSolver;

const B: f64 = 6.01e-3;

/// An element and more all round the ellipse, square elements.
fn plane(per_semi_axis: usize) -> Structured {
    let side = SEMI_AXIS / per_semi_axis as f64;
    let (half_x, half_y) = (per_semi_axis + 1, (B / side).ceil() as usize + 1);
    let (x0, y0) = (-(half_x as f64) * side, -(half_y as f64) * side);
    Structured::contact_plane(x0, y0, side, side, 2 * half_x + 1, 2 * half_y + 1)
}

/// Element means of q₀ √(1 − x²/a² − y²/b²).
fn ellipse(grid: &Structured, q0: f64) -> Vec<f64> {
    let place = |k: usize| (k as f64 - 7.5) / 16.0;
    let mean = |at: usize| {
        let (x, y) = (grid.x(at % grid.ni), grid.y(at / grid.ni));
        let value = |k: usize| {
            let x = (x + place(k % 16) * grid.dx()) / SEMI_AXIS;
            let y = (y + place(k / 16) * grid.dy()) / B;
            (1.0 - x * x - y * y).max(0.0).sqrt()
        };
        q0 * (0..256).map(value).sum::<f64>() / 256.0
    };
    (0..grid.points()).map(mean).collect()
}

fn figure(run: &Run, body: &str, key: &str) -> f64 {
    run.model.summary()["temperature"][body][key].as_f64().unwrap()
}

/// 1.9e8 W/m² at the centre into each body at 38.889 m/s: 261.850 K by an independent quadrature of the
/// kernel in three dimensions. Tolerance: the grid, of which half the elements leave 4 times the error.
#[test]
fn the_papers_ellipse() {
    let mut rises = [0.0; 2];
    for (rise, n) in rises.iter_mut().zip([24, 48]) {
        let grid = plane(n);
        let mut run = Run::steady("moving-source", grid);
        run.try_solve(&ellipse(&grid, 3.8e8), f64::INFINITY).unwrap();
        run.model.accept();
        *rise = figure(&run, "rail", "max_rise_k");
    }
    let error = (rises[1] - rises[0]).abs();
    assert!(error < 1e-3 * 261.85, "{rises:?}");
    assert!((rises[1] - 261.850).abs() < error, "{rises:?}");
}

/// A case with another material below, and how the surfaces share the heat.
fn case(partition: &Value, conductivity: f64) -> Value {
    let mut case = steel();
    case["effects"]["friction_heat"] = partition.clone();
    case["materials"]["other"] = case["materials"]["steel"].clone();
    case["materials"]["other"]["conductivity"] = json!(conductivity);
    case["bodies"]["rail"]["material"] = json!("other");
    case
}

struct Shared {
    run: Run,
    heat: f64,
}

fn shared(partition: &Value, conductivity: f64, speeds: [f64; 2]) -> Shared {
    let grid = plane(12);
    let case = case(partition, conductivity);
    let mut run = Run::new("moving-source", Mode::Steady, grid, case);
    run.given.speeds = speeds.to_vec();
    let flux = ellipse(&grid, 1e8);
    let report = run.try_solve(&flux, f64::INFINITY).unwrap();
    run.model.accept();
    let sent: f64 = flux.iter().sum::<f64>() * grid.element_area();
    // The interface neither makes nor loses heat; rounding of sums.
    let heat = report.heat_received.unwrap();
    assert!((heat / sent - 1.0).abs() < 1e-12, "{heat} of {sent}");
    Shared { run, heat }
}

impl Shared {
    fn surfaces(&self) -> [&[f64]; 2] {
        [&field::UPPER_TEMPERATURE, &field::LOWER_TEMPERATURE]
            .map(|spec| self.run.surfaces.of(spec))
    }
}

/// With `continuity` both surfaces have one temperature wherever they rub, for equal bodies, for
/// conductivities of 1 to 1000 either way, for a body at rest. Tolerance: what the iteration is asked for.
#[test]
fn surfaces_that_touch_have_one_temperature() {
    let continuity = json!({"partition": "continuity"});
    for (conductivity, speeds) in
        [(50.0, [2.0; 2]), (50.0, [0.0, 2.0]), (0.05, [2.0; 2]), (5e4, [38.0, 40.0])]
    {
        let shared = shared(&continuity, conductivity, speeds);
        let [upper, lower] = shared.surfaces();
        let warmest = upper.iter().chain(lower).copied().fold(0.0, f64::max);
        let flux = shared.run.given.flux.as_ref().unwrap();
        let rubbing = flux.iter().zip(upper.iter().zip(lower)).filter(|(q, _)| **q > 0.0);
        for (_, (upper, lower)) in rubbing {
            assert!((upper - lower).abs() <= 1e-7 * warmest, "{conductivity} {speeds:?}");
        }
        assert!(shared.heat > 0.0 && warmest > 0.0);
    }
}

/// At high speed continuity is the split by effusivity, and equal bodies share alike at any speed.
/// Tolerance: heat that goes sideways, 1/Pe.
#[test]
fn continuity_is_the_split_by_effusivity_at_high_speed() {
    let speeds = [20.0, 45.0];
    let of = |partition: &str| {
        let shared = shared(&json!({"partition": partition}), 200.0, speeds);
        ["wheel", "rail"].map(|body| figure(&shared.run, body, "max_rise_k"))
    };
    let (continuity, effusivity) = (of("continuity"), of("effusivity"));
    let peclet = 20.0 * SEMI_AXIS / (2.0 * 4.0 * DIFFUSIVITY);
    for (one, other) in continuity.iter().zip(effusivity) {
        assert!((one / other - 1.0).abs() < 1.0 / peclet, "{continuity:?} {effusivity:?}");
    }
    let alike = shared(&json!({"partition": "continuity"}), 50.0, [0.3; 2]);
    let equal = shared(&json!({"partition": "equal"}), 50.0, [0.3; 2]);
    assert_eq!(alike.surfaces(), equal.surfaces());
}

/// A conductance lies between halves and one temperature, and what flows follows from the difference.
#[test]
fn a_conductance_lies_between() {
    let speeds = [0.2, 2.0];
    let wheel =
        |partition: Value| figure(&shared(&partition, 50.0, speeds).run, "wheel", "max_rise_k");
    let halves = wheel(json!({"partition": "equal"}));
    let one = wheel(json!({"partition": "continuity"}));
    let by = |h: f64| wheel(json!({"partition": "conductance", "conductance": h}));
    let found = [1e-3, 1e3, 1e5, 1e7, 1e13].map(by);
    assert!(found.windows(2).all(|pair| pair[0] > pair[1]), "{found:?}");
    // Of the iteration.
    assert!((found[0] / halves - 1.0).abs() < 1e-6, "{found:?} {halves}");
    assert!((found[4] / one - 1.0).abs() < 1e-5, "{found:?} {one}");
}

#[test]
fn models_with_one_share_refuse_what_flows_between() {
    for model in ["columns", "ertz-knothe"] {
        let case = case(&json!({"partition": "continuity"}), 50.0);
        let given = configuration(model, Mode::Steady, plane(4), case);
        let refusal = ThermalSolver.configure(&given).err().unwrap();
        assert_eq!(refusal.key, "effects.friction_heat.partition");
    }
    let case = case(&json!({"partition": "conductance"}), 50.0);
    let given = configuration("moving-source", Mode::Steady, plane(4), case);
    let refusal = ThermalSolver.configure(&given).err().unwrap();
    assert_eq!(refusal.key, "effects.friction_heat.conductance");
}

/// A restored model gives the summary and the sections of the saved one, to the bit.
#[test]
fn a_state_is_whole() {
    let one = shared(&json!({"partition": "continuity"}), 5.0, [0.5, 2.0]);
    let mut saved = Vec::new();
    one.run.model.save(&mut saved).unwrap();
    let case = case(&json!({"partition": "continuity"}), 5.0);
    let mut other = Run::new("moving-source", Mode::Steady, plane(12), case);
    other.model.restore(&mut saved.as_slice()).unwrap();
    assert_eq!(one.run.model.summary(), other.model.summary());
    let mut again = Vec::new();
    other.model.save(&mut again).unwrap();
    assert!(again == saved);
    assert!(other.model.restore(&mut &saved[..saved.len() - 1]).is_err());
}
