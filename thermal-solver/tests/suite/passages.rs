//! Rises left by earlier passages, and layers transformed by a passage.

use crate::support::*;
use proto::configuration::Mode;
use proto::field;
use proto::grid::Structured;
use proto::model::Solver;
use serde_json::{Value, json};
use std::f64::consts::PI;
use thermal_solver::ThermalSolver;

const CONDUCTIVITY: f64 = 50.0;

fn case(effect: &str, table: Value) -> Value {
    let mut case = steel();
    case["effects"][effect] = table;
    case
}

/// A plane of some rows with a uniform flux, except in the first and last columns [W/m²].
fn heated(rows: usize, width: f64, flux: f64) -> (Structured, Vec<f64>) {
    let (columns, length) = (24, 1e-3);
    let plane = Structured::contact_plane(
        0.0,
        -0.5 * (rows - 1) as f64 * width,
        length,
        width,
        columns,
        rows,
    );
    let inside = |index: usize| (2..columns - 2).contains(&(index % columns));
    let of = |index: usize| if inside(index) { flux } else { 0.0 };
    (plane, (0..plane.points()).map(of).collect())
}

/// Refused are a passage that begins before the previous one is over, and surfaces raised by
/// earlier passages.
#[test]
fn what_passages_have_no_answer_to_is_refused() {
    let (plane, flux) = heated(3, 1e-3, 1e8);
    let mut hasty = case("bulk_heating", json!({}));
    hasty["bodies"]["rail"]["passages"] = json!(3);
    hasty["bodies"]["rail"]["passage_interval"] = json!(1e-9);
    let mut run = Run::new("columns", Mode::Steady, plane, hasty.clone());
    let refused = run.try_solve(&flux, 0.0).unwrap_err().to_string();
    assert!(refused.contains("bodies.rail.passage_interval"), "{refused}");
    hasty["effects"]["thermal_expansion"] = json!({});
    let given = configuration("columns", Mode::Steady, plane, hasty);
    let refused = ThermalSolver.configure(&given).err().unwrap();
    assert_eq!(refused.key, "effects.thermal_expansion");
}

fn figure(run: &Run, pointer: &str) -> f64 {
    let summary = run.model.summary();
    summary
        .pointer(pointer)
        .and_then(Value::as_f64)
        .unwrap_or_else(|| panic!("{pointer}: {summary}"))
}

/// A body with the heat loss G is warmer by its heat input over G, and unchanged otherwise.
/// Tolerance: rounding.
#[test]
fn a_body_in_balance_gives_off_what_it_takes() {
    let (plane, flux) = heated(5, 1e-3, 1e8);
    let cold = {
        let mut run = Run::new("columns", Mode::Steady, plane, steel());
        run.advance(&flux, 0.0);
        run
    };
    for model in ["ertz-knothe", "columns", "moving-source"] {
        let mut case = case("bulk_heating", json!({}));
        case["bodies"]["wheel"]["heat_loss"] = json!(40.0);
        let mut run = Run::new(model, Mode::Steady, plane, case);
        run.advance(&flux, 0.0);
        let power = 0.5 * flux.iter().sum::<f64>() * plane.element_area();
        let bulk = figure(&run, "/temperature/wheel/bulk_rise_k");
        assert!((bulk / (power / 40.0) - 1.0).abs() < 1e-12, "{model}: {bulk}");
        assert_eq!(figure(&run, "/temperature/rail/bulk_rise_k"), 0.0);
        if model == "columns" {
            let changes = run.wheel().iter().zip(cold.wheel()).map(|(warm, cold)| warm - cold);
            assert!(changes.into_iter().all(|change| (change / bulk - 1.0).abs() < 1e-9));
            assert_eq!(run.rail(), cold.rail());
            let depth = |run: &Run| figure(run, "/temperature/wheel/penetration_depth_m");
            assert_eq!(depth(&run), depth(&cold), "the depth is the flash's");
        }
    }
}

/// Passages leave Σ e/(β√(πt)) in the middle of a wide track. Under a narrow track heat spreads
/// across as well, E/(2πλt) of the heat E per metre. Tolerances: the tails of the Gaussian beyond
/// the sides (4 of its standard deviations), and the width of the track, whose second moment is
/// Δy²/12 of 2κt.
#[test]
fn passages_leave_what_conduction_leaves() {
    let (interval, passages) = (0.05, 3);
    let of = |rows: usize, width: f64| {
        let (plane, flux) = heated(rows, width, 1e8);
        let mut case = case("bulk_heating", json!({}));
        case["bodies"]["rail"]["passages"] = json!(passages);
        case["bodies"]["rail"]["passage_interval"] = json!(interval);
        let mut run = Run::new("columns", Mode::Steady, plane, case);
        run.advance(&flux, 0.0);
        figure(&run, "/temperature/rail/residual_rise_k")
    };
    let per_area = 0.5 * 1e8 * 20.0 * 1e-3 / SPEED;
    let times = || (1..=passages).map(|passage| f64::from(passage) * interval);
    let even: f64 = times().map(|time| per_area / (effusivity() * (PI * time).sqrt())).sum();
    let wide = of(41, 1e-3);
    assert!((wide / even - 1.0).abs() < 1e-4, "{wide} {even}");
    let width = 1e-4;
    let line: f64 = times().map(|time| per_area * width / (2.0 * PI * CONDUCTIVITY * time)).sum();
    let narrow = of(1, width);
    assert!(
        (narrow / line - 1.0).abs() < width * width / (48.0 * DIFFUSIVITY * interval) + 1e-3,
        "{narrow} {line}"
    );
}

#[test]
fn what_has_no_background_is_refused() {
    let (plane, _) = heated(3, 1e-3, 1.0);
    let refused = |mode: Mode, case: Value| {
        ThermalSolver.configure(&configuration("columns", mode, plane, case)).err().unwrap().key
    };
    let mut asked = case("bulk_heating", json!({}));
    assert_eq!(refused(Mode::Steady, asked.clone()), "effects.bulk_heating", "nothing is warm");
    asked["bodies"]["wheel"]["passages"] = json!(2);
    assert_eq!(refused(Mode::Steady, asked.clone()), "bodies.wheel.passage_interval");
    asked["bodies"]["wheel"]["passage_interval"] = json!(0.1);
    assert_eq!(refused(Mode::Transient, asked.clone()), "effects.bulk_heating");
}

/// Returns the rise of a column at a depth, a time after the start of a uniform flux of limited
/// duration, by error functions (Carslaw & Jaeger, 2.9).
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

/// The layer that exceeds A_c1 under a uniform flux, and its rates, against the closed form of a
/// column. Tolerances: an element of the path, within which the highest temperature at a depth
/// lies, and over which rates are means; the law of cooling behind the grid.
#[test]
fn the_transformed_layer_is_that_of_a_heated_column() {
    let (columns, length, flux) = (400, 5e-5, 1.2e9);
    let plane = Structured::contact_plane(0.0, 0.0, length, 1e-3, columns, 3);
    let heating = 100..300;
    let given: Vec<f64> = (0..plane.points())
        .map(|k| if heating.contains(&(k % columns)) { flux } else { 0.0 })
        .collect();
    let lasts = 200.0 * length / SPEED;
    let (start, into) = (293.15 + 400.0, 0.5 * flux);
    let highest = |depth: f64| {
        (0..=4000)
            .map(|k| pulse(into, lasts, depth, f64::from(k) * 1e-3 * lasts))
            .fold(0.0, f64::max)
    };
    let (mut inside, mut outside) = (0.0, 1e-3);
    for _ in 0..40 {
        let middle = 0.5 * (inside + outside);
        if highest(middle) > 400.0 { inside = middle } else { outside = middle }
    }
    // T = 2 q √(t/π)/β passes 400 K after this time.
    let crossing = PI * (400.0 * effusivity() / (2.0 * into)).powi(2);
    // The surface passes 400 K again behind the grid.
    let surface = |time: f64| pulse(into, lasts, 0.0, time);
    let (mut warm, mut cold) = (lasts, 10.0 * lasts);
    for _ in 0..60 {
        let middle = 0.5 * (warm + cold);
        if surface(middle) > 400.0 { warm = middle } else { cold = middle }
    }
    assert!(warm > 1.5 * lasts, "behind the grid");
    let quench = (surface(0.999 * warm) - surface(1.001 * warm)) / (2e-3 * warm);
    for model in ["columns", "moving-source"] {
        let mut run = Run::new(
            model,
            Mode::Steady,
            plane,
            case("phase_transformation", json!({"start_temperature": start})),
        );
        run.advance(&given, 0.0);
        let [depth, width, rate, cooling, margin] = [
            "depth_m",
            "width_m",
            "heating_rate_k_per_s",
            "cooling_rate_k_per_s",
            "temperature_margin_k",
        ]
        .map(|name| figure(&run, &format!("/white_layer/rail/{name}")));
        println!(
            "{model}: {depth:e} {inside:e}, {rate:e} {:e}, {cooling:e} {quench:e}, {margin} {}",
            200.0 / crossing,
            highest(0.0) - 400.0
        );
        assert!((depth / inside - 1.0).abs() < 0.01, "{model}: {depth} {inside}");
        assert_eq!(width, 3e-3);
        assert!((rate / (200.0 / crossing) - 1.0).abs() < 0.05, "{model}: {rate}");
        // The parabolas of the flux overshoot at its jump, by 15 % in an element of two hundred.
        assert!((margin / (highest(0.0) - 400.0) - 1.0).abs() < 0.03, "{model}: {margin}");
        assert!((cooling / quench - 1.0).abs() < 0.05, "{model}: {cooling} {quench}");
    }
    // A critical rate above the cooling rate leaves pearlite.
    let slow = json!({"start_temperature": start, "critical_cooling_rate": 1e12});
    let mut run = Run::new("columns", Mode::Steady, plane, case("phase_transformation", slow));
    run.advance(&given, 0.0);
    assert_eq!(figure(&run, "/white_layer/rail/depth_m"), 0.0);
    assert_eq!(run.surfaces.of(&field::LOWER_TEMPERATURE).len(), plane.points());
}
