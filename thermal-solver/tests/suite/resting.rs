//! Bodies at rest: heat flow between bodies of different temperature, and an electric current
//! through their contact.

use crate::support::*;
use proto::configuration::Mode;
use proto::field;
use proto::grid::{Grid, Structured};
use proto::model::{Model, Solver, Step};
use proto::progress::Progress;
use serde_json::{Value, json};
use thermal_solver::ThermalSolver;

const RADIUS: f64 = 1e-3;
const CONDUCTIVITY: f64 = 50.0;

/// A circular contact between bodies at rest.
fn rest(effects: &Value) -> Value {
    let mut case = steel();
    case["motion"]["speed"] = json!(0.0);
    for (name, table) in effects.as_object().unwrap() {
        case["effects"][name] = table.clone();
    }
    case
}

/// Returns the summary under a pressure on a circle with `per_radius` elements to its radius.
fn pressed(model: &str, case: Value, per_radius: usize) -> Value {
    solved(model, case, per_radius).summary()
}

/// Returns a model after a steady solve under a pressure on a circle.
fn solved(model: &str, case: Value, per_radius: usize) -> Box<dyn Model> {
    let h = RADIUS / per_radius as f64;
    let half = per_radius + 2;
    let count = 2 * half + 1;
    let plane =
        Structured::contact_plane(-(half as f64) * h, -(half as f64) * h, h, h, count, count);
    let inside = |index: usize| {
        let (x, y) = (plane.x(index % count), plane.y(index / count));
        f64::from(u8::from(x.hypot(y) < RADIUS))
    };
    let grid = Grid::structured("contact", plane);
    let mut configuration = configuration(model, Mode::Steady, plane, case.clone());
    if case["effects"]["joule_heat"].is_object() && case["effects"]["contact_conductance"].is_null()
    {
        configuration.inputs.push(proto::configuration::Input {
            field: field::PRESSURE.kind(),
            producer: "mech".to_owned(),
            grid: Some(grid.clone()),
            moves: false,
            peak: None,
            extent: None,
        });
    }
    let setup =
        ThermalSolver.configure(&configuration).unwrap_or_else(|refusal| panic!("{refusal}"));
    let mut model = setup.build(&Progress::default()).unwrap();
    let given = Given {
        flux: Some(vec![0.0; plane.points()]),
        pressure: Some((0..plane.points()).map(inside).collect()),
        speeds: vec![0.0; 2],
        grids: [grid, one_point()],
    };
    let mut surfaces = Wanted(vec![
        (field::LOWER_TEMPERATURE.name, vec![0.0; plane.points()]),
        (field::UPPER_TEMPERATURE.name, vec![0.0; plane.points()]),
    ]);
    model.solve(&Step::STEADY, &given, &mut surfaces).unwrap();
    model.accept();
    model
}

#[track_caller]
fn number(summary: &Value, pointer: &str) -> f64 {
    summary
        .pointer(pointer)
        .and_then(Value::as_f64)
        .unwrap_or_else(|| panic!("{pointer}: {summary}"))
}

/// Checks the errors of a circle made of squares. The rim is known to a fraction of a square, so
/// the error is of first order in their size, and extrapolation from two grids gives the closed
/// form to 0.1 %.
#[track_caller]
fn assert_holms(errors: &[f64]) {
    let [coarse, middle, fine] = errors else { panic!("three grids") };
    assert!(
        coarse.abs() > middle.abs() && middle.abs() > fine.abs() && fine.abs() < 5e-3,
        "{errors:?}"
    );
    assert!((2.0 * fine - middle).abs() < 1e-3, "{errors:?}");
}

/// Perfect contact over a circle conducts Q = 2λaΔT, and both surfaces meet half-way. A conductance
/// reduces the flow, and zero conductance stops it.
#[test]
fn heat_through_a_circle_is_holms() {
    let flow = |conductance: f64, per_radius: usize| {
        let mut case = rest(&json!({"contact_conductance": {"conductance": conductance}}));
        case["bodies"]["wheel"]["initial_temperature"] = json!(393.15);
        let summary = pressed("moving-source", case, per_radius);
        (number(&summary, "/exchange/heat_w"), summary)
    };
    let exact = 2.0 * CONDUCTIVITY * RADIUS * 100.0;
    let mut errors = Vec::new();
    for per_radius in [20, 40, 80] {
        let (heat, summary) = flow(1e14, per_radius);
        errors.push(heat / exact - 1.0);
        let [up, down] = [
            number(&summary, "/temperature/rail/max_rise_k"),
            number(&summary, "/temperature/wheel/min_rise_k"),
        ];
        assert!((up - 50.0).abs() < 1e-4 && (down + 50.0).abs() < 1e-4, "{up} {down}");
    }
    println!("{errors:.6?}");
    assert_holms(&errors);
    // Equal temperatures by the partition `continuity`.
    let mut case = rest(&json!({"friction_heat": {"partition": "continuity"}}));
    case["bodies"]["wheel"]["initial_temperature"] = json!(393.15);
    let summary = pressed("moving-source", case, 40);
    let up = number(&summary, "/temperature/rail/max_rise_k");
    assert!((up - 50.0).abs() < 1e-4, "{up}");
    // Three resistances in series, each for its own flow of least resistance. No single flow is all
    // three, so the true flow is slightly smaller.
    let film = 1e5;
    let (heat, _) = flow(film, 40);
    let even = 100.0
        / (1.0 / (film * std::f64::consts::PI * RADIUS * RADIUS)
            + 1.0 / (2.0 * CONDUCTIVITY * RADIUS));
    assert!((0.92..1.0).contains(&(heat / even)), "{heat} {even}");
    assert!(flow(1e-6, 20).0 < 1e-6 * exact);
}

/// Holm's resistance ρ/2a of a circle to 0.1 %, and Kohlrausch's rise V²/(8λρ) for that voltage, of
/// which the solve uses only the potential. Bodies of different materials divide the voltage in
/// proportion to their resistivities.
#[test]
fn a_current_meets_holms_resistance() {
    let resistivity = 1.7e-7;
    let case = |of_wheel: f64| {
        let mut case = rest(&json!({"joule_heat": {"current": 200.0}}));
        case["materials"]["steel"]["resistivity"] = json!(resistivity);
        let mut other = case["materials"]["steel"].clone();
        other["resistivity"] = json!(of_wheel);
        case["materials"]["other"] = other;
        case["bodies"]["wheel"]["material"] = json!("other");
        case
    };
    let exact = resistivity / (2.0 * RADIUS);
    let of = |per_radius: usize| {
        let summary = pressed("moving-source", case(resistivity), per_radius);
        number(&summary, "/current/resistance_ohm") / exact - 1.0
    };
    let errors = [20, 40, 80].map(of);
    println!("{errors:.6?}");
    assert_holms(&errors);
    let summary = pressed("moving-source", case(resistivity), 60);
    let found = number(&summary, "/current/resistance_ohm");
    let voltage = number(&summary, "/current/voltage_v");
    assert!((voltage / (200.0 * found) - 1.0).abs() < 1e-12);
    let rise = voltage * voltage / (8.0 * CONDUCTIVITY * resistivity);
    for body in ["rail", "wheel"] {
        let own = number(&summary, &format!("/temperature/{body}/max_rise_k"));
        assert!((own / rise - 1.0).abs() < 1e-5, "{body}: {own} {rise}");
        assert!(number(&summary, &format!("/temperature/{body}/x_m")).abs() < 0.1 * RADIUS);
        // On the axis the potential falls as 2/π atan(a/z), and the rise as 1 − (1 − φ)²: to 1/e at
        // 2.995 a.
        let depth = number(&summary, &format!("/temperature/{body}/penetration_depth_m"));
        assert!((depth / (2.995 * RADIUS) - 1.0).abs() < 0.01, "{depth}");
    }
    let summary = pressed("moving-source", case(3.0 * resistivity), 30);
    let both = number(&summary, "/current/resistance_ohm");
    assert!((both / (2.0 * exact) - 1.0).abs() < 1.2e-2, "{both} {exact}");
    let [wheel, rail] =
        ["wheel", "rail"].map(|body| number(&summary, &format!("/temperature/{body}/max_rise_k")));
    assert!((wheel / rail - 1.0).abs() < 1e-4, "equal temperatures: {wheel} {rail}");
}

#[test]
fn what_does_not_rest_is_refused() {
    let key = |model: &str, case: Value| {
        let plane = Structured::contact_plane(0.0, 0.0, 1e-4, 1e-4, 8, 8);
        let refusal =
            ThermalSolver.configure(&configuration(model, Mode::Steady, plane, case)).err();
        refusal.map(|refusal| refusal.key)
    };
    let mut moving = rest(&json!({"joule_heat": {"current": 1.0}}));
    moving["materials"]["steel"]["resistivity"] = json!(1e-7);
    let resting = moving.clone();
    moving["motion"]["speed"] = json!(1.0);
    assert_eq!(key("moving-source", moving), Some("effects.joule_heat".to_owned()));
    let with = |effect: &str, table: Value| {
        let mut both = resting.clone();
        both["effects"][effect] = table;
        key("moving-source", both)
    };
    // Combinations that the model does not solve together are refused.
    assert_eq!(
        with("contact_conductance", json!({"conductance": 100.0})),
        Some("effects.contact_conductance".to_owned())
    );
    assert_eq!(with("bulk_heating", json!({})), Some("effects.bulk_heating".to_owned()));
    assert_eq!(
        with("phase_transformation", json!({})),
        Some("effects.phase_transformation".to_owned())
    );
    assert_eq!(key("columns", resting), Some("effects.joule_heat".to_owned()));
    assert_eq!(key("columns", rest(&json!({}))), Some("motion.speed".to_owned()));
}

/// A restored model has the summary of the saved one, with its current and its exchanged heat. A
/// state that ends too early changes nothing.
#[test]
fn currents_and_exchanged_heat_are_saved() {
    let mut current = rest(&json!({"joule_heat": {"current": 200.0}}));
    current["materials"]["steel"]["resistivity"] = json!(1.7e-7);
    let mut other = current.clone();
    other["effects"]["joule_heat"]["current"] = json!(300.0);
    let mut exchange = rest(&json!({"contact_conductance": {"conductance": 1e4}}));
    exchange["bodies"]["wheel"]["initial_temperature"] = json!(393.15);
    let mut weaker = exchange.clone();
    weaker["effects"]["contact_conductance"]["conductance"] = json!(1e3);
    for (case, changed) in [(current, other), (exchange, weaker)] {
        let one = solved("moving-source", case.clone(), 8);
        let mut other = solved("moving-source", changed, 8);
        let before = other.summary();
        let mut saved = Vec::new();
        one.save(&mut saved).unwrap();
        assert!(other.restore(&mut &saved[..saved.len() - 1]).is_err());
        assert_eq!(other.summary(), before);
        let mut fresh = solved("moving-source", case, 8);
        fresh.restore(&mut saved.as_slice()).unwrap();
        assert_eq!(fresh.summary(), one.summary());
        let mut again = Vec::new();
        fresh.save(&mut again).unwrap();
        assert!(again == saved);
    }
}

const WHEEL: [f64; 3] = [3200.0, 700.0, 25.0];

/// Returns the summary of a ceramic wheel that is 100 K warmer than a steel rail and rolls on it at
/// 12 m/s without friction, with `per_semi_axis` elements to a semi-axis.
fn preheated(model: &str, law: &Value, per_semi_axis: usize) -> Value {
    let [density, specific_heat, conductivity] = WHEEL;
    let mut case = rest(law);
    case["motion"]["speed"] = json!(12.0);
    case["bodies"]["wheel"]["initial_temperature"] = json!(393.15);
    case["bodies"]["wheel"]["material"] = json!("ceramic");
    case["materials"]["ceramic"] =
        json!({"density": density, "specific_heat": specific_heat, "conductivity": conductivity});
    let h = SEMI_AXIS / per_semi_axis as f64;
    let half = per_semi_axis + 2;
    let (from, count) = (-(half as f64) * h, 2 * half + 1);
    let plane = Structured::contact_plane(from, from, h, h, count, count);
    let pressure = |index: usize| {
        let (x, y) = (plane.x(index % count) / SEMI_AXIS, plane.y(index / count) / SEMI_AXIS);
        1e9 * (1.0 - x * x - y * y).max(0.0).sqrt()
    };
    let mut run = Run::new(model, Mode::Steady, plane, case);
    run.given.speeds = vec![12.0; 2];
    run.given.pressure = Some((0..plane.points()).map(pressure).collect());
    run.advance(&vec![0.0; plane.points()], f64::INFINITY);
    run.model.summary()
}

/// Surfaces of equal temperature meet at T β_u/(β_u + β_l) everywhere; with a conductance the
/// hottest place is the trailing end of the longest row, T β_u/(β_u + β_l) (1 − e^{s²} erfc s),
/// s = h (1/β_u + 1/β_l) √t. Nothing between the middles of elements is hotter. Tolerance: heat
/// that flows sideways, and the length of the row, which is known to half an element at either end.
#[test]
fn no_place_is_hotter_than_bodies_that_meet() {
    let beta = |[density, heat, conductivity]: [f64; 3]| (density * heat * conductivity).sqrt();
    let (upper, lower) = (beta(WHEEL), effusivity());
    let most = 100.0 * upper / (upper + lower);
    let continuity = json!({"friction_heat": {"partition": "continuity"}});
    for (model, per_semi_axis) in
        [("moving-source", 10), ("moving-source", 20), ("moving-source", 40), ("fe", 20)]
    {
        let summary = preheated(model, &continuity, per_semi_axis);
        let found = number(&summary, "/temperature/rail/max_rise_k");
        println!("{model}, a/{per_semi_axis}: {found:.3} K of {most:.3} K");
        assert!((found / most - 1.0).abs() < 6e-3, "{model} {per_semi_axis}: {found} {most}");
        let wheel = &summary["temperature"]["wheel"];
        assert_eq!((wheel["max_rise_k"].as_f64(), wheel.get("each_strip")), (Some(0.0), None));
        let [heated, cooled] =
            ["rail", "wheel"].map(|body| number(&summary, &format!("/temperature/{body}/heat_w")));
        assert!(heated > 0.0 && (heated + cooled).abs() < 1e-9 * heated, "{heated} {cooled}");
    }
    for conductance in [2e4, 2e5] {
        let law = json!({"contact_conductance": {"conductance": conductance}});
        let time = 2.0 * SEMI_AXIS / 12.0;
        let s = conductance * (1.0 / upper + 1.0 / lower) * time.sqrt();
        let expected = most * (1.0 - (s * s).exp() * libm::erfc(s));
        let heats = [10, 20, 40].map(|per_semi_axis| {
            let summary = preheated("moving-source", &law, per_semi_axis);
            let found = number(&summary, "/temperature/rail/max_rise_k");
            println!("h {conductance}, a/{per_semi_axis}: {found:.4} K of {expected:.4} K");
            let tolerance = 0.25 / per_semi_axis as f64;
            assert!(
                (found / expected - 1.0).abs() < tolerance,
                "{conductance}: {found} {expected}"
            );
            number(&summary, "/exchange/heat_w")
        });
        println!("{heats:?}");
        // The area from pressures at the middles of elements has an error of second order.
        assert!((heats[0] / heats[2] - 1.0).abs() < 2.5e-2, "{heats:?}");
        assert!((heats[1] / heats[2] - 1.0).abs() < 7e-3, "{heats:?}");
    }
}
