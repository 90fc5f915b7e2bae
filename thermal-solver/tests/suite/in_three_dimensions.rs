//! The three-dimensional models through the contract: the paper's case, heat flow between the
//! surfaces, saved states.

use crate::support::*;
use proto::configuration::Mode;
use proto::field;
use proto::grid::Structured;
use proto::model::Solver;
use serde_json::{Value, json};
use thermal_solver::ThermalSolver;

const B: f64 = 6.01e-3;

/// The three-dimensional models of a single contact.
const MODELS: [&str; 2] = ["moving-source", "fe"];

/// A grid of square elements that extends beyond the ellipse by more than an element on each side.
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

/// 1.9e8 W/m² at the centre into each body at 38.889 m/s: 261.850 K by an independent quadrature of
/// the three-dimensional kernel. Tolerance: the grid; half as many elements have 4 times the error.
#[test]
fn the_papers_ellipse() {
    for model in MODELS {
        let mut rises = [0.0; 2];
        for (rise, n) in rises.iter_mut().zip([24, 48]) {
            let grid = plane(n);
            let mut run = Run::steady(model, grid);
            run.try_solve(&ellipse(&grid, 3.8e8), f64::INFINITY).unwrap();
            run.model.accept();
            *rise = figure(&run, "rail", "max_rise_k");
        }
        let error = (rises[1] - rises[0]).abs();
        assert!(error < 1e-3 * 261.85, "{model} {rises:?}");
        assert!((rises[1] - 261.850).abs() < error, "{model} {rises:?}");
    }
}

/// A case with another material below, and the heat partition or conductance of the contact.
fn case(partition: &Value, conductivity: f64) -> Value {
    let (mut case, mut partition) = (steel(), partition.clone());
    if let Some(law) = partition.as_object_mut().unwrap().remove("contact_conductance") {
        case["effects"]["contact_conductance"] = law;
    }
    case["effects"]["friction_heat"] = partition;
    case["materials"]["other"] = case["materials"]["steel"].clone();
    case["materials"]["other"]["conductivity"] = json!(conductivity);
    case["bodies"]["rail"]["material"] = json!("other");
    case
}

struct Shared {
    run: Run,
    heat: f64,
}

fn shared(model: &str, partition: &Value, conductivity: f64, speeds: [f64; 2]) -> Shared {
    let grid = plane(12);
    let mut case = case(partition, conductivity);
    for (body, speed) in ["wheel", "rail"].into_iter().zip(speeds) {
        case["bodies"][body]["surface_speed"] = json!(speed);
    }
    let mut run = Run::new(model, Mode::Steady, grid, case);
    run.given.speeds = speeds.to_vec();
    run.given.pressure = Some(ellipse(&grid, 1e9));
    let flux = ellipse(&grid, 1e8);
    let report = run.try_solve(&flux, f64::INFINITY).unwrap();
    run.model.accept();
    let sent: f64 = flux.iter().sum::<f64>() * grid.element_area();
    // The interface creates and destroys no heat. Tolerance: rounding of sums.
    let heat = report.received_power.unwrap();
    assert!((heat / sent - 1.0).abs() < 1e-12, "{heat} of {sent}");
    Shared { run, heat }
}

impl Shared {
    fn surfaces(&self) -> [&[f64]; 2] {
        [&field::UPPER_TEMPERATURE, &field::LOWER_TEMPERATURE]
            .map(|spec| self.run.surfaces.of(spec))
    }
}

/// Partition `continuity`: both surfaces have equal temperatures wherever there is friction, for
/// equal bodies, for conductivity ratios of 1 to 1000 either way, and for a body at rest.
/// Tolerance: that of the iteration.
#[test]
fn surfaces_that_touch_have_one_temperature() {
    let continuity = json!({"partition": "continuity"});
    let hard = [(50.0, [2.0; 2]), (50.0, [0.0, 2.0]), (0.05, [2.0; 2]), (5e4, [38.0, 40.0])];
    for (model, (conductivity, speeds)) in
        MODELS.iter().flat_map(|model| hard.map(|of| (model, of)))
    {
        let shared = shared(model, &continuity, conductivity, speeds);
        let [upper, lower] = shared.surfaces();
        let warmest = upper.iter().chain(lower).copied().fold(0.0, f64::max);
        let flux = shared.run.given.flux.as_ref().unwrap();
        let rubbing = flux.iter().zip(upper.iter().zip(lower)).filter(|(q, _)| **q > 0.0);
        for (_, (upper, lower)) in rubbing {
            assert!((upper - lower).abs() <= 1e-7 * warmest, "{model} {conductivity} {speeds:?}");
        }
        assert!(shared.heat > 0.0 && warmest > 0.0);
    }
}

/// At high speed continuity agrees with the split by effusivity, and equal bodies have equal shares
/// at any speed. Tolerance: heat that flows sideways, 1/Pe.
#[test]
fn continuity_is_the_split_by_effusivity_at_high_speed() {
    let speeds = [20.0, 45.0];
    for model in MODELS {
        let of = |partition: &str| {
            let shared = shared(model, &json!({"partition": partition}), 200.0, speeds);
            ["wheel", "rail"].map(|body| figure(&shared.run, body, "max_rise_k"))
        };
        let (continuity, effusivity) = (of("continuity"), of("effusivity"));
        let peclet = 20.0 * SEMI_AXIS / (2.0 * 4.0 * DIFFUSIVITY);
        for (one, other) in continuity.iter().zip(effusivity) {
            assert!((one / other - 1.0).abs() < 1.0 / peclet, "{model} {continuity:?}");
        }
        let alike = shared(model, &json!({"partition": "continuity"}), 50.0, [0.3; 2]);
        let equal = shared(model, &json!({"partition": "equal"}), 50.0, [0.3; 2]);
        assert_eq!(alike.surfaces(), equal.surfaces());
    }
}

/// A conductance lies between equal shares and equal temperatures, and the exchanged flux follows
/// from the difference.
#[test]
fn a_conductance_lies_between() {
    let speeds = [0.2, 2.0];
    for model in MODELS {
        let wheel = |partition: Value| {
            figure(&shared(model, &partition, 50.0, speeds).run, "wheel", "max_rise_k")
        };
        let halves = wheel(json!({"partition": "equal"}));
        let one = wheel(json!({"partition": "continuity"}));
        let by = |h: f64| wheel(json!({"contact_conductance": {"conductance": h}}));
        let found = [1e-3, 1e3, 1e5, 1e7, 1e13].map(by);
        assert!(found.windows(2).all(|pair| pair[0] > pair[1]), "{model} {found:?}");
        // Tolerance: that of the iteration.
        assert!((found[0] / halves - 1.0).abs() < 1e-6, "{model} {found:?} {halves}");
        assert!((found[4] / one - 1.0).abs() < 1e-5, "{model} {found:?} {one}");
    }
}

/// Both models give the same heat flow between the bodies, with independent discretisations.
/// Tolerance: twelve elements a semi-axis.
#[test]
fn both_models_let_the_same_flow() {
    for (partition, speeds) in [("continuity", [0.0, 2.0]), ("continuity", [0.4, 2.0])] {
        let rises = MODELS.map(|model| {
            let shared = shared(model, &json!({"partition": partition}), 20.0, speeds);
            ["wheel", "rail"].map(|body| figure(&shared.run, body, "max_rise_k"))
        });
        for (one, other) in rises[0].iter().zip(rises[1]) {
            assert!((one / other - 1.0).abs() < 5e-3, "{speeds:?} {rises:?}");
        }
    }
}

/// Heat flow in time, for any windows in elements, slow and fast, under a varying flux: nodes of
/// each body pass the elements of the contact at the body's speed. Tolerance: 1.1 times the
/// difference of the models with equal shares, which is due to time steps, and hats two elements
/// wide.
#[test]
fn both_models_let_the_same_flow_in_time() {
    let conductance = json!({"contact_conductance": {"conductance": 1e5}});
    let grid = plane(12);
    let flux = ellipse(&grid, 1e8);
    let of = |model: &str, partition: &Value, speeds: [f64; 2], passage: f64| {
        let mut case = case(partition, 20.0);
        for (body, speed) in ["wheel", "rail"].into_iter().zip(speeds) {
            case["bodies"][body]["surface_speed"] = json!(speed);
        }
        let mut run = Run::new(model, Mode::Transient, grid, case);
        run.given.speeds = speeds.to_vec();
        run.given.pressure = Some(ellipse(&grid, 1e9));
        let steps = (30.0 / passage).ceil();
        for step in 0..steps as usize {
            let part = 1.0 + 0.5 * (20.0 * step as f64 / steps).sin();
            let now: Vec<f64> = flux.iter().map(|q| part * q).collect();
            let report = run.advance(&now, passage * grid.dx() / speeds[1]);
            let sent = now.iter().sum::<f64>() * grid.element_area();
            // The interface creates and destroys no heat. Tolerance: rounding of sums.
            assert!((report.received_power.unwrap() / sent - 1.0).abs() < 1e-12);
        }
        ["wheel", "rail"].map(|body| figure(&run, body, "max_rise_k"))
    };
    for speeds in [[0.2, 0.4], [10.0, 10.1], [40.0, 36.0]] {
        // Short windows are many: they pass once, with bodies that differ most in their speed.
        let shortest = if speeds[1] == 2.0 * speeds[0] { 0.2 } else { 1.0 };
        for passage in [0.2, 1.0, 2.63].into_iter().filter(|passage| *passage >= shortest) {
            let apart = |partition: &Value| {
                let [one, other] = MODELS.map(|model| of(model, partition, speeds, passage));
                let apart = |body: usize| (one[body] / other[body] - 1.0).abs();
                apart(0).max(apart(1))
            };
            let tolerance = 1.1 * apart(&json!({"partition": "equal"})) + 2e-4;
            for partition in [&json!({"partition": "continuity"}), &conductance] {
                let apart = apart(partition);
                println!(
                    "{speeds:?} m/s, windows of {passage}, {partition}: {apart:.5} (tolerance {tolerance:.5})"
                );
                assert!(apart < tolerance, "{speeds:?} {passage} {partition}: {apart} {tolerance}");
            }
        }
    }
}

/// Surfaces under a pressure, in contact beyond the region with friction, which is the rear half of
/// the contact.
fn pressed(model: &str, law: &Value, pressure: impl Fn(f64) -> f64) -> Run {
    let grid = plane(12);
    let mut case = case(&json!({"contact_conductance": law}), 20.0);
    case["bodies"]["wheel"]["surface_speed"] = json!(0.4);
    case["bodies"]["rail"]["surface_speed"] = json!(2.0);
    let mut run = Run::new(model, Mode::Steady, grid, case);
    run.given.speeds = vec![0.4, 2.0];
    let whole = ellipse(&grid, 1.0);
    run.given.pressure = Some(whole.iter().map(|part| pressure(*part)).collect());
    let rear =
        |(at, part): (usize, &f64)| if grid.x(at % grid.ni) < 0.0 { 1e8 * part } else { 0.0 };
    let flux: Vec<f64> = whole.iter().enumerate().map(rear).collect();
    let report = run.try_solve(&flux, f64::INFINITY).unwrap();
    let sent: f64 = flux.iter().sum::<f64>() * grid.element_area();
    assert!((report.received_power.unwrap() / sent - 1.0).abs() < 1e-12);
    run
}

/// Conductance by pressure: a uniform pressure conducts like a constant. A high conductance gives
/// equal temperatures wherever there is pressure, with or without friction. Tolerance: that of the
/// iteration.
#[test]
fn a_conductance_by_pressure() {
    let even = |part: f64| if part > 0.0 { 2e8 } else { 0.0 };
    let wheel = |run: &Run| run.surfaces.of(&field::UPPER_TEMPERATURE).to_vec();
    for model in MODELS {
        let rough = pressed(model, &json!({"conductance": 1e6, "hardness": 2e9}), even);
        let constant = 1e6 * 0.1_f64.powf(0.95);
        let other = pressed(model, &json!({"conductance": constant}), even);
        let [one, same] = [&rough, &other].map(wheel);
        let warmest = one.iter().copied().fold(0.0, f64::max);
        assert!(one.iter().zip(&same).all(|(a, b)| (a - b).abs() < 1e-6 * warmest), "{model}");

        let close =
            pressed(model, &json!({"conductance": 1e14, "hardness": 1e9}), |part| 1e9 * part);
        let touching = close.given.pressure.as_ref().unwrap().iter();
        let rises = [&field::UPPER_TEMPERATURE, &field::LOWER_TEMPERATURE];
        let [upper, lower] = rises.map(|spec| close.surfaces.of(spec));
        let apart = touching.zip(upper.iter().zip(lower)).filter(|(p, _)| **p > 0.0);
        let apart = apart.map(|(_, (upper, lower))| (upper - lower).abs()).fold(0.0, f64::max);
        println!("{model}: {apart:.1e} of {warmest:.0} K");
        assert!(apart < 1e-5 * warmest, "{model} {apart:e}");

        // The pressure of an ellipse, which falls to zero at the edge.
        let rough =
            pressed(model, &json!({"conductance": 1e5, "hardness": 2e9}), |part| 1e9 * part);
        let halves =
            pressed(model, &json!({"conductance": 1e-3, "hardness": 2e9}), |part| 1e9 * part);
        let [rough, halves, one] =
            [&rough, &halves, &close].map(|run| wheel(run).iter().copied().fold(0.0, f64::max));
        assert!(halves > rough && rough > one, "{model} {halves} {rough} {one}");
    }
}

/// After a hot window follows a window without friction. Heat still flows between surfaces under
/// pressure, and finally leaves them at nearly equal temperatures. Tolerance: the difference left
/// after ten times the hot window; without conductance it is twenty times as large.
#[test]
fn heat_goes_on_without_friction() {
    let grid = plane(6);
    let flux = ellipse(&grid, 1e9);
    for model in MODELS {
        let apart = |conductance: f64| {
            let mut law = json!({"conductance": conductance});
            if model == "moving-source" {
                law["hardness"] = json!(1e9);
            }
            let mut case = case(&json!({"contact_conductance": law}), 20.0);
            for body in ["wheel", "rail"] {
                case["bodies"][body]["surface_speed"] = json!(0.1);
            }
            let mut run = Run::new(model, Mode::Transient, grid, case);
            run.given.speeds = vec![0.1; 2];
            run.given.pressure = Some(ellipse(&grid, 1e9));
            run.advance(&flux, 1e-3);
            for _ in 0..10 {
                run.advance(&vec![0.0; grid.points()], 1e-3);
            }
            let middle = grid.points() / 2;
            run.surfaces.of(&field::UPPER_TEMPERATURE)[middle]
                - run.surfaces.of(&field::LOWER_TEMPERATURE)[middle]
        };
        let (open, close) = (apart(1e-3), apart(1e9));
        println!("{model}: {open:.1} K, {close:.3} K");
        assert!(open.abs() > 20.0 * close.abs(), "{model} {open} {close}");
    }
}

/// Bodies of different temperature that roll on each other. The heat flow without friction is the
/// limit of little friction, for equal temperatures and for a conductance, for equal and different
/// bodies, steady and in time. A solve reports the friction heat alone as received, however small
/// it is. Tolerances: that of the iteration; rounding of the friction heat.
#[test]
fn no_friction_is_the_limit_of_little() {
    let grid = plane(8);
    let laws = [
        json!({"partition": "continuity"}),
        json!({"contact_conductance": {"conductance": 1e5}}),
        json!({"contact_conductance": {"conductance": 1e-3}}),
    ];
    let ways = MODELS.iter().flat_map(|model| {
        [Mode::Steady, Mode::Transient].into_iter().map(move |mode| (*model, mode))
    });
    for (model, mode) in ways {
        for (law, conductivity) in laws.iter().flat_map(|law| [(law, 50.0), (law, 20.0)]) {
            let of = |friction: f64| {
                let mut case = case(law, conductivity);
                case["bodies"]["wheel"]["initial_temperature"] = json!(400.0);
                let mut run = Run::new(model, mode, grid, case);
                run.given.speeds = vec![2.0; 2];
                run.given.pressure = Some(ellipse(&grid, 1e9));
                let flux = ellipse(&grid, friction);
                let duration = if mode == Mode::Steady { f64::INFINITY } else { 2e-3 };
                let report = run.advance(&flux, duration);
                let sent = flux.iter().sum::<f64>() * grid.element_area();
                let received = report.received_power.unwrap();
                assert!((received - sent).abs() <= 1e-12 * sent, "{model} {received} {sent}");
                (run.rail().to_vec(), run.wheel().to_vec())
            };
            let none = of(0.0);
            let warmest = largest(&none.0);
            assert!(warmest > 0.0, "{model} {mode:?} {law}");
            for friction in [1e-12, 1e-9] {
                let little = of(friction);
                let apart = [difference(&little.0, &none.0), difference(&little.1, &none.1)];
                assert!(largest(&apart) < 1e-6, "{model} {mode:?} {law} {friction}: {apart:?}");
            }
            if mode == Mode::Steady && conductivity == 50.0 && law["partition"] == "continuity" {
                // Equal bodies meet in the middle.
                let pressure = ellipse(&grid, 1e9);
                let touching = pressure.iter().zip(none.0.iter().zip(&none.1));
                for (_, (rail, wheel)) in touching.filter(|(p, _)| **p > 0.0) {
                    let middle = 0.5 * (400.0 - 293.15);
                    assert!((rail - middle).abs() < 1e-6 * middle, "{model}: {rail} K");
                    assert!((wheel + middle).abs() < 1e-6 * middle, "{model}: {wheel} K");
                }
            }
        }
    }
}

#[test]
fn models_with_one_share_refuse_what_flows_between() {
    for model in ["columns", "ertz-knothe"] {
        let case = case(&json!({"partition": "continuity"}), 50.0);
        let given = configuration(model, Mode::Steady, plane(4), case);
        let refusal = ThermalSolver.configure(&given).err().unwrap();
        assert_eq!(refusal.key, "effects.friction_heat.partition");
        let law = json!({"contact_conductance": {"conductance": 1e5}});
        let given = configuration(model, Mode::Steady, plane(4), self::case(&law, 50.0));
        let refusal = ThermalSolver.configure(&given).err().unwrap();
        assert_eq!(refusal.key, "effects.contact_conductance");
    }
    let case = case(
        &json!({"partition": "continuity", "contact_conductance": {"conductance": 1e5}}),
        50.0,
    );
    let given = configuration("moving-source", Mode::Steady, plane(4), case);
    let refusal = ThermalSolver.configure(&given).err().unwrap();
    assert_eq!(refusal.key, "effects.contact_conductance");
    let law = json!({"contact_conductance": {"conductance": 1e5, "hardness": 1e9}});
    let given = configuration("fe", Mode::Transient, plane(4), self::case(&law, 50.0));
    let refusal = ThermalSolver.configure(&given).err().unwrap();
    assert_eq!(refusal.key, "effects.contact_conductance.hardness");
}

/// A restored model gives bit-identical summary and sections.
#[test]
fn a_state_is_whole() {
    for model in MODELS {
        let one = shared(model, &json!({"partition": "continuity"}), 5.0, [0.5, 2.0]);
        let mut saved = Vec::new();
        one.run.model.save(&mut saved).unwrap();
        let mut other = shared(model, &json!({"partition": "continuity"}), 5.0, [0.5, 2.0]).run;
        other.try_solve(&vec![1e6; other.grid().points()], f64::INFINITY).unwrap();
        other.model.accept();
        other.model.restore(&mut saved.as_slice()).unwrap();
        assert_eq!(one.run.model.summary(), other.model.summary());
        let mut again = Vec::new();
        other.model.save(&mut again).unwrap();
        assert!(again == saved);
        // A second body that fails leaves the first one as it was.
        let older = shared(model, &json!({"partition": "continuity"}), 5.0, [0.5, 1.0]).run;
        let (mut older_state, mut after) = (Vec::new(), Vec::new());
        older.model.save(&mut older_state).unwrap();
        assert!(other.model.restore(&mut &older_state[..older_state.len() - 1]).is_err());
        other.model.save(&mut after).unwrap();
        assert!(after == saved, "{model}");
    }
}

/// A disc at rest under a flux that is switched on: T = 2q√(κt)/λ (1/√π − ierfc(a/√(4κt))) at its
/// centre (Carslaw & Jaeger, 10.5), for any windows. Tolerance: elements cut by the edge.
#[test]
fn a_disc_that_is_switched_on() {
    let (n, q, radius) = (16, 1e7, 4e-3);
    let side = radius / f64::from(n);
    let from = -f64::from(n) * side;
    let count = 2 * n as usize + 1;
    let grid = Structured::contact_plane(from, from, side, side, count, count);
    let place = |k: usize| (k as f64 - 7.5) / 16.0 * side;
    let mean = |at: usize| {
        let (x, y) = (grid.x(at % count), grid.y(at / count));
        let inside = |k: &usize| (x + place(k % 16)).hypot(y + place(k / 16)) < radius;
        2.0 * q * (0..256).filter(inside).count() as f64 / 256.0
    };
    let flux: Vec<f64> = (0..grid.points()).map(mean).collect();
    let mut run = Run::new("moving-source", Mode::Transient, grid, steel());
    run.given.speeds = vec![0.0; 2];
    let mut time = 0.0;
    for duration in [1e-3, 1e-3, 5e-3, 0.1, 0.2, 2.0, 10.0] {
        run.advance(&flux, duration);
        time += duration;
        let spread = (4.0 * DIFFUSIVITY * time).sqrt();
        let far = radius / spread;
        let ierfc = (-far * far).exp() / std::f64::consts::PI.sqrt() - far * libm::erfc(far);
        let expected = q * spread / 50.0 * (1.0 / std::f64::consts::PI.sqrt() - ierfc);
        let found = run.rail()[grid.points() / 2];
        assert!((found / expected - 1.0).abs() < 2e-3, "{time}: {found} {expected}");
    }
}

/// A lasting flux ends in the steady state. Tolerance: the quadrature of the ages, panel by panel.
#[test]
fn a_lasting_flux_ends_in_the_steady_state() {
    let grid = plane(8);
    let flux = ellipse(&grid, 1e8);
    let (speed, passing) = (0.2, 2.5 * SEMI_AXIS / 0.2);
    let mut steady = Run::steady("moving-source", grid);
    steady.given.speeds = vec![speed; 2];
    steady.advance(&flux, f64::INFINITY);
    let mut run = Run::new("moving-source", Mode::Transient, grid, steel());
    run.given.speeds = vec![speed; 2];
    for duration in [0.01, 0.04, 0.05, 0.1, 0.2, 0.5, 1.0].map(|part| part * passing) {
        run.advance(&flux, duration);
    }
    let warmest = steady.rail().iter().copied().fold(0.0, f64::max);
    for (one, other) in run.rail().iter().zip(steady.rail()) {
        assert!((one - other).abs() < 1e-7 * warmest, "{one} {other}");
    }
    let (one, other) = (run.summary("rail", "max_rise_k"), steady.summary("rail", "max_rise_k"));
    assert!((one.unwrap() / other.unwrap() - 1.0).abs() < 1e-7);
}

/// A flux that rises and falls at a speed with conduction normal to the surface gives the rises of
/// columns. Tolerance: 2/Pe of the highest rise so far.
#[test]
fn at_high_speed_it_is_columns_in_time_too() {
    let grid = plane(8);
    let flux = ellipse(&grid, 1e8);
    let mut case = steel();
    case["motion"]["speed"] = json!(10.0);
    let peclet = 10.0 * SEMI_AXIS / (2.0 * DIFFUSIVITY);
    let mut runs = ["moving-source", "columns"]
        .map(|model| Run::new(model, Mode::Transient, grid, case.clone()));
    let mut warmest = 0.0;
    for step in 0..30 {
        let part = 1.0 + 0.8 * (0.7 * f64::from(step)).sin();
        let now: Vec<f64> = flux.iter().map(|q| part * q).collect();
        for run in &mut runs {
            run.given.speeds = vec![10.0; 2];
            run.advance(&now, 2e-4);
        }
        let [source, columns] = &runs;
        warmest = columns.rail().iter().copied().fold(warmest, f64::max);
        for (one, other) in source.rail().iter().zip(columns.rail()) {
            assert!((one - other).abs() < 2.0 * warmest / peclet, "{step}: {one} {other}");
        }
    }
}

/// A model restored during a run continues bit-identically, for any scheme and solver.
#[test]
fn a_restored_history_goes_on() {
    let of = [
        ("periodic", None),
        ("moving-source", None),
        ("fe", None),
        ("fe", Some("bdf2")),
        ("fe", Some("iterative")),
    ];
    for (model, option) in of {
        let repeats = model == "periodic";
        let grid = if repeats { even(plane(6)) } else { plane(6) };
        let flux = ellipse(&grid, 1e8);
        let partition = if repeats { "effusivity" } else { "continuity" };
        let mut case = case(&json!({"partition": partition}), 20.0);
        case["bodies"]["wheel"]["surface_speed"] = json!(0.2);
        case["bodies"]["rail"]["surface_speed"] = json!(0.4);
        match option {
            Some("iterative") => case["thermal"]["solver"] = json!("iterative"),
            Some(scheme) => case["thermal"]["scheme"] = json!(scheme),
            None => {}
        }
        let new = || {
            let mut run = Run::new(model, Mode::Transient, grid, case.clone());
            run.given.speeds = vec![0.2, 0.4];
            run.given.pressure = Some(ellipse(&grid, 1e9));
            run
        };
        let window = |run: &mut Run, step: i32| {
            let part = 1.0 + 0.5 * f64::from(step).sin();
            let now: Vec<f64> = flux.iter().map(|q| part * q).collect();
            run.advance(&now, 1e-3);
        };
        let mut one = new();
        (0..12).for_each(|step| window(&mut one, step));
        let mut saved = Vec::new();
        one.model.save(&mut saved).unwrap();
        let mut other = new();
        other.model.restore(&mut saved.as_slice()).unwrap();
        (12..20).for_each(|step| window(&mut one, step));
        other.time = 12e-3;
        (12..20).for_each(|step| window(&mut other, step));
        assert_eq!(one.surfaces.0, other.surfaces.0, "{model} {option:?}");
        assert_eq!(one.model.summary(), other.model.summary(), "{model} {option:?}");
    }
}

/// Extends a grid to an even number of elements along x.
fn even(grid: Structured) -> Structured {
    Structured { ni: grid.ni + grid.ni % 2, ..grid }
}

/// A contact that repeats at a large distance behaves like a single one until heat arrives from its
/// neighbour: at the surface, below it, and in the rise integral except for its mean. Tolerance:
/// the flux is a sum of waves in one model and of parabolas in the other, which represent jumps
/// differently.
#[test]
fn far_neighbours_are_not_felt() {
    let grid = Structured::contact_plane(-16e-3, -16e-3, 0.5e-3, 0.5e-3, 64, 64);
    let bell = |at: usize| {
        let (x, y) = (grid.x(at % 64), grid.y(at / 64));
        1e7 * (-(x * x + y * y) / 9e-6).exp()
    };
    let flux: Vec<f64> = (0..grid.points()).map(bell).collect();
    let runs = ["periodic", "moving-source"].map(|model| {
        let mut case = case(&json!({"partition": "equal"}), 20.0);
        case["bodies"]["wheel"]["surface_speed"] = json!(0.0);
        case["bodies"]["rail"]["surface_speed"] = json!(0.1);
        let mut run = Run::new(model, Mode::Transient, grid, case);
        run.given.speeds = vec![0.0, 0.1];
        (0..5).for_each(|_| {
            run.advance(&flux, 4e-3);
        });
        run
    });
    let [mut one, mut other] = runs;
    let close = |name: &str, one: &[f64], other: &[f64], tolerance: f64| {
        let highest = other.iter().copied().fold(0.0, f64::max);
        let error = one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        println!("{name}: {:.1e} of {highest:.1} K", error / highest);
        assert!(highest > 1.0 && error < tolerance * highest, "{name}: {error} of {highest}");
    };
    close("upper", one.wheel(), other.wheel(), 5e-3);
    close("lower", one.rail(), other.rail(), 5e-3);
    let (one, other) = (one.sections(), other.sections());
    for section in [&field::LOWER_SECTION_TEMPERATURE, &field::UPPER_SECTION_TEMPERATURE] {
        close(section.name, one.of(section), other.of(section), 5e-3);
    }
}
