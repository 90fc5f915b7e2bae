//! Rolling of viscoelastic half-spaces against Hunter's cylinder, CONTACT, and the elastic limits.

use super::common::{assert_close, configuration, refusal, run};
use elastic::Elasticity;
use elastic::Material;
use elastic::hertz::elliptic_contact;
use elastic::hunter::Cylinder;
use half_space::difference::Difference;
use half_space::extent::{Moments, fit_grid, sample};
use half_space::grid_continuation::{Contact, Levels, Motion};
use half_space::normal::{NormalContact, NormalSolver, Prescribed};
use half_space::tangential::{ElementState, PrescribedMotion};
use half_space::viscoelastic::{Bodies, Delayed};
use proto::grid::Structured;
use serde_json::{Value, json};

const RUBBER: Material = Material { youngs_modulus: 1.0, poisson_ratio: 0.3 };
const RIGID: Material = Material { youngs_modulus: f64::INFINITY, poisson_ratio: 0.0 };
const RADIUS: f64 = 100.0;

/// Viscoelastic body on a rigid one.
fn on_rigid(delayed: f64, length: f64) -> Bodies {
    let [own, _] = Elasticity::of_bodies(&[RUBBER, RIGID]);
    let memory = Delayed { elasticity: own.scaled(delayed), length };
    Bodies { instantaneous: own, delayed: [memory, Delayed::default()] }
}

/// Relative error of the centre of pressure, against Hunter, for a contact of half-width 1 with
/// this number of elements per half-width. The row is long enough for plane strain.
fn centre_error(delayed: f64, length: f64, resolution: usize) -> f64 {
    let bodies = on_rigid(delayed, length);
    let compliance = bodies.instantaneous.contact_compliance();
    let exact = Cylinder { compliance, delayed, length, radius: RADIUS }.of_half_width(1.0);
    let (dx, row) = (1.0 / resolution as f64, 3e3 * length.max(1.0));
    let count = (2.6 * resolution as f64) as usize;
    let first = exact.middle - 1.3 + 0.5 * dx;
    let grid = Structured::contact_plane(first, 0.0, dx, row, count, 1);
    let distance = sample(&grid, &|x, _| 0.5 * x * x / RADIUS);
    let mut pressure = vec![0.0; count];
    let mut solver = NormalSolver::of_bodies(count, 1, [dx, row], &bodies);
    solver.solve(&distance, Prescribed::Load(exact.load * row), &mut pressure).expect("a contact");
    Moments::of(&grid, &pressure).centre[0] / exact.centre - 1.0
}

/// Rolling resistance of a rigid cylinder, N x̄/R. Tolerances: the element relative to the shorter
/// of contact and memory length; the length of the row.
#[test]
fn hunters_cylinder() {
    println!("error of the resistance with 20, 40 and 80 elements a half-width");
    for delayed in [1.0, 10.0, 100.0] {
        for length in [0.05, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0] {
            let errors = [20, 40, 80].map(|resolution| centre_error(delayed, length, resolution));
            println!(
                "f = {delayed}, l/a = {length}: {:.1e} {:.1e} {:.1e}",
                errors[0], errors[1], errors[2]
            );
            let [coarse, _, fine] = errors.map(f64::abs);
            assert!(coarse < 1e-2 && fine < 1e-3, "f = {delayed}, l/a = {length}: {errors:?}");
        }
    }
}

/// Round contact under the load that gives instantaneously elastic bodies a radius of 1; elements
/// are this part of the relaxed radius.
fn round(delayed: f64, length: f64, resolution: usize) -> (Structured, Vec<f64>, NormalContact) {
    let bodies = on_rigid(delayed, length);
    let load = 1.0 / (0.75 * RADIUS * bodies.instantaneous.contact_compliance());
    let dx = (1.0 + delayed).cbrt() / resolution as f64;
    let half = resolution as i32 + 2;
    let (first, count) = (-f64::from(half) * dx, 2 * half as usize + 1);
    let grid = Structured::contact_plane(first, first, dx, dx, count, count);
    let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
    let gap = |x: f64, y: f64| 0.5 * (x * x + y * y) / RADIUS;
    let (load, bound) = (Prescribed::Load(load), f64::INFINITY);
    let fitted = fit_grid(grid, bodies, &gap, load, everywhere, 100_000, bound).expect("a contact");
    (fitted.grid, fitted.pressure, fitted.contact)
}

/// The contact conditions hold for any memory, and the iterations stay few. Tolerance of the
/// residual: that of the iteration.
#[test]
fn a_memory_of_any_length() {
    let mut most = [0; 2];
    for delayed in [0.1, 1.0, 10.0, 100.0] {
        for length in [1e-3, 0.1, 1.0, 10.0, 1e3] {
            let (grid, pressure, contact) = round(delayed, length, 16);
            let sides = [grid.dx(), grid.dy()];
            let bodies = on_rigid(delayed, length);
            let mut again = pressure.clone();
            let mut solver = NormalSolver::of_bodies(grid.ni, grid.nj, sides, &bodies);
            let distance = sample(&grid, &|x, y| 0.5 * (x * x + y * y) / RADIUS);
            // Prescribing the approach found gives the same pressure.
            let approach = Prescribed::Approach(contact.approach);
            solver.solve(&distance, approach, &mut again).unwrap();
            let largest = pressure.iter().copied().fold(0.0, f64::max);
            for (at, (p, q)) in pressure.iter().zip(&again).enumerate() {
                assert!((p - q).abs() < 1e-6 * largest, "f = {delayed}, l = {length}: {p} {q}");
                let gap = distance[at] + solver.displacement()[at] - contact.approach;
                let limit = 1e-8 * contact.approach;
                assert!(if *q > 0.0 { gap.abs() < limit } else { gap > -limit }, "{gap} {q}");
            }
            let centre = Moments::of(&grid, &pressure).centre[0];
            assert!(centre > 0.0, "f = {delayed}, l = {length}: {centre}");
            most[usize::from(delayed > 1.0)] =
                contact.iterations.max(most[usize::from(delayed > 1.0)]);
        }
    }
    println!("iterations, f <= 1 and above: {most:?}");
    assert!(most[0] <= 75 && most[1] <= 300, "{most:?}");
}

/// Very slow and very fast rolling agree with Hertz. Tolerance: 16 elements per radius, and the
/// finite memory length.
#[test]
fn fast_and_slow_bodies_are_elastic() {
    for (length, factor) in [(1e-3, 5.0), (2e4, 1.0)] {
        let (grid, pressure, contact) = round(4.0, length, 16);
        let compliance = factor * on_rigid(4.0, length).instantaneous.contact_compliance();
        let load = contact.normal_force;
        let hertz = elliptic_contact(0.5 / RADIUS, 0.5 / RADIUS, load, compliance);
        let Moments { semi_axes, centre } = Moments::of(&grid, &pressure);
        let largest = pressure.iter().copied().fold(0.0, f64::max);
        println!("{length}: {semi_axes:?} {largest} {} {hertz:?} {centre:?}", contact.approach);
        assert!((semi_axes[0] / hertz.semi_axis_a - 1.0).abs() < 2e-3);
        assert!((largest / hertz.max_pressure - 1.0).abs() < 5e-3);
        assert!((contact.approach / hertz.approach - 1.0).abs() < 2e-3);
        assert!(centre[0].abs() < 1e-3);
    }
}

/// Reference values of CONTACT.
struct Case {
    length: f64,
    approach: f64,
    max_pressure: f64,
    creepage: f64,
    elements: usize,
    adhesion: usize,
}

/// Two cylinders of PA6 that transmit 0.6 f N, computed by CONTACT (its example visc_cylindr after
/// Wang and Knothe, Trans. ASME 60 (1993) 310; version of 2025-07-23; N, mm). Tolerance: the
/// printed digits.
#[test]
fn cylinders_of_contact() {
    let shear_modulus = 1143.0;
    let body = Material { youngs_modulus: 2.8 * shear_modulus, poisson_ratio: 0.4 };
    let cases = [
        (9.0, 2.36736, 78.74, 1.365e-2, 62, 37),
        (45.0, 2.06321, 84.72, 1.152e-2, 57, 36),
        (2000.0, 1.45462, 85.31, 9.932e-3, 56, 35),
    ];
    for (length, approach, max_pressure, creepage, elements, adhesion) in cases {
        let case = Case { length, approach, max_pressure, creepage, elements, adhesion };
        let delayed = Elasticity::of_bodies(&[body, body])
            .map(|elasticity| Delayed { elasticity, length: case.length });
        let bodies = Bodies { instantaneous: Elasticity::of_pair(&body, &body), delayed };
        let grid = Structured::contact_plane(-7.92, 0.0, 0.16, 1000.0, 99, 1);
        let distance = sample(&grid, &|x, _| 0.01 * x * x);
        let mut pressure = vec![0.0; 99];
        let mut solver = NormalSolver::of_bodies(99, 1, [0.16, 1000.0], &bodies);
        let contact = solver.solve(&distance, Prescribed::Load(6e5), &mut pressure).unwrap();
        assert!((contact.approach / case.approach - 1.0).abs() < 3e-5, "{}", contact.approach);
        let largest = pressure.iter().copied().fold(0.0, f64::max);
        assert!((largest - case.max_pressure).abs() < 0.011, "{largest}");
        assert_eq!(contact.contact_elements, case.elements);
        let bound: Vec<f64> = pressure.iter().map(|p| 0.3 * p).collect();
        let semi_axes = [5.0, 500.0];
        let motion = Motion::SteadyRolling;
        let contact = Contact {
            bodies,
            layer: 0.0,
            yields: None,
            semi_axes,
            motion,
            difference: Difference::Upwind,
            tolerance: 1e-5,
        };
        let asked = PrescribedMotion::longitudinal_force(-0.18 * 6e5);
        let solved = Levels::new(&grid, &contact).solve(&bound, &asked).unwrap();
        let found = solved.state.creepage[0];
        assert!((found / case.creepage - 1.0).abs() < 4e-4, "{found}");
        let sticks = solved.state.element.iter().filter(|e| **e == ElementState::Adhesion).count();
        assert_eq!(sticks, case.adhesion);
        assert!(solved.newton_steps <= 14, "{}", solved.newton_steps);
    }
}

/// A polyurethane tyre, or one with its share of the compliance, on a track of the same or of
/// another material.
pub(crate) fn case(creepage: [f64; 3], track: &str) -> Value {
    let [xi, eta, phi] = creepage;
    json!({
        "mech": {"model": "half-space", "resolution": 10},
        "bodies": {
            "tyre": {"position": "upper", "radius_x": 0.2, "radius_y": 0.3, "material": "polyurethane"},
            "track": {"position": "lower", "material": track},
        },
        "materials": {
            "polyurethane": {"youngs_modulus": 200e6, "poisson_ratio": 0.4,
                "delayed_compliance_ratio": 3.0, "retardation_time": 2e-3},
            "steel": {"youngs_modulus": 210e9, "poisson_ratio": 0.3},
        },
        "motion": {"speed": 2.0, "creepage": {"xi": xi, "eta": eta, "phi": phi}},
        "load": {"normal_force": 2e3},
        "friction": {"coefficient": 0.4},
        "effects": {"partial_slip": {}, "viscoelasticity": {}, "friction_heat": {}},
    })
}

/// The power of the creepages and of the rolling resistance equals that of friction and of the
/// dissipation in the bodies, at every resolution. The bodies never supply power. This includes
/// different bodies, whose tractions and pressures are coupled.
#[test]
fn power_is_dissipated_in_the_bodies() {
    for track in ["polyurethane", "steel"] {
        for creepage in [[0.0; 3], [-0.01, 0.0, 0.0], [0.02, 0.005, 0.0], [0.0, 0.0, 1.0]] {
            for speed in [0.05, 2.0, 50.0] {
                let mut case = case(creepage, track);
                case["motion"]["speed"] = json!(speed);
                let run = run(&case);
                let parts = ["creep_power_w", "rolling_resistance_power_w", "edge_power_w"]
                    .map(|key| run.number(key));
                let taken = ["friction_power_w", "hysteresis_power_w"].map(|key| run.number(key));
                let scale: f64 = parts.iter().chain(&taken).map(|power| power.abs()).sum();
                let off = parts.iter().sum::<f64>() - taken.iter().sum::<f64>();
                println!(
                    "{track} {creepage:?} {speed} m/s: {parts:.3?} {taken:.3?}, off by {:.1e} {}",
                    off / scale,
                    run.number("power_imbalance")
                );
                assert!(off.abs() <= 1e-6 * scale);
                assert!(run.number("power_imbalance") <= 1e-6);
                assert!(taken.iter().all(|power| *power >= 0.0), "{taken:?}");
                let force = run.number("rolling_resistance_n");
                assert_close(force * speed, parts[1], 1e-12);
                assert_close(force, 2e3 * run.number("pressure_centre_x_m") / 0.2, 1e-9);
            }
        }
    }
}

/// A sliding contact dissipates the power of its pressure.
#[test]
fn a_sliding_contact_is_resisted_as_well() {
    let mut sliding = case([-0.05, 0.0, 0.0], "steel");
    sliding["effects"].as_object_mut().unwrap().remove("partial_slip");
    let run = run(&sliding);
    let resistance = run.number("rolling_resistance_power_w") + run.number("edge_power_w");
    assert!(resistance > 1.0);
    assert_close(run.number("hysteresis_power_w"), resistance, 1e-6);
    assert_close(run.number("friction_power_w"), 0.4 * 2e3 * 0.05 * 2.0, 1e-9);
}

/// Left and right are equivalent.
#[test]
fn a_mirrored_case_is_mirrored() {
    let run = |eta: f64, phi: f64| run(&case([0.004, eta, phi], "steel"));
    let (one, other) = (run(0.006, 0.7), run(-0.006, -0.7));
    for (key, sign) in [
        ("creep_force_x_n", 1.0),
        ("creep_force_y_n", -1.0),
        ("spin_moment_nm", -1.0),
        ("hysteresis_power_w", 1.0),
    ] {
        assert_close(one.number(key), sign * other.number(key), 1e-4);
    }
}

#[test]
fn what_has_no_answer_is_refused() {
    let refused = |change: &dyn Fn(&mut Value)| {
        let mut case = case([0.0; 3], "steel");
        change(&mut case);
        refusal(&configuration(&case))
    };
    let given = json!({"semi_axis_a": 5e-3, "semi_axis_b": 5e-3, "max_pressure": 1e6});
    type Change<'a> = (&'a str, &'a dyn Fn(&mut Value));
    let changes: [Change<'_>; 4] = [
        ("the case gives it", &|case| case["contact"] = given.clone()),
        ("pressure bound", &|case| case["effects"]["pressure_limit"] = json!({"hardness": 1e6})),
        ("no body", &|case| case["bodies"]["tyre"]["material"] = json!("steel")),
        ("missing", &|case| case["materials"]["steel"]["retardation_time"] = json!(1.0)),
    ];
    for (reason, change) in changes {
        let refusal = refused(change);
        assert!(refusal.reason.contains(reason), "{reason}: {refusal}");
    }
}
