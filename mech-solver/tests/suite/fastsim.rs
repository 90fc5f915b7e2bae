//! The model `fastsim` through the traits of a participant, against Kalker's linear theory, the
//! closed form of the simplified theory, and the energy balance.

use crate::common::*;
use elastic::{creep_force, kalker};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Rounding of the sums over cells and elements: a few units in the last place.
const ROUNDING: f64 = 1e-12;
const A: f64 = 7.98e-3;
const B: f64 = 6.01e-3;
const SHEAR_MODULUS: f64 = 210e9 / 2.6;
const NORMAL_FORCE: f64 = 2.0 / 3.0 * PI * A * B * 1352e6;

/// The paper's case with the ellipse of Table 2.
fn fastsim(creepage: [f64; 3]) -> Value {
    let mut case = paper_table_2();
    case["mech"]["model"] = json!("fastsim");
    case["motion"] = json!({"speed": SPEED});
    let [xi, eta, phi] = creepage;
    case["motion"]["creepage"] = json!({"xi": xi, "eta": eta, "phi": phi});
    case
}

fn at_force(traction_coefficient: f64) -> Value {
    driven(fastsim([0.0; 3]), "traction_coefficient", traction_coefficient)
}

fn with(mut case: Value, key: &str, value: impl Into<Value>) -> Value {
    case["mech"][key] = value.into();
    case
}

fn coefficients() -> kalker::CreepCoefficients {
    kalker::creep_coefficients(A / B, 0.3)
}

/// Creepage at which the linear theory reaches f N.
fn saturation() -> f64 {
    FRICTION * NORMAL_FORCE / (SHEAR_MODULUS * A * B * coefficients().c11)
}

/// Checks that sums, fields and creepages agree: forces and heat on the grid equal those of the
/// summary, and the heat equals the power of the creepages. `scale` is V f N times the largest
/// creepage.
#[track_caller]
fn assert_balance(run: &Run, scale: f64) {
    let creepages = ["creepage_xi", "creepage_eta", "creepage_phi_per_m"];
    let forces = ["creep_force_x_n", "creep_force_y_n", "spin_moment_nm"];
    let power: f64 =
        creepages.iter().zip(forces).map(|(c, f)| -SPEED * run.number(c) * run.number(f)).sum();
    let heat = run.number("friction_power_w");
    assert!((heat - power).abs() <= ROUNDING * scale, "{heat} is not {power}");
    assert!((run.integral("friction_power") - heat).abs() <= ROUNDING * scale);
    let bound = ROUNDING * FRICTION * NORMAL_FORCE;
    assert!((run.integral("traction") - run.number("creep_force_x_n")).abs() <= bound);
    assert!((run.lateral_integral("traction") - run.number("creep_force_y_n")).abs() <= bound);
    assert!(run.fields["friction_power"].iter().all(|power| *power >= 0.0));
}

fn power_scale([xi, eta, phi]: [f64; 3]) -> f64 {
    SPEED * FRICTION * NORMAL_FORCE * (xi.abs() + eta.abs() + A * phi.abs())
}

/// Tolerance: the share of the slip zone, proportional to the creepage (1e-4 of saturation). For
/// spin, whose traction in adhesion is a parabola, the trapezoidal rule over m = 2 · resolution
/// cells, 1/m².
#[test]
fn slopes_are_kalkers() {
    let small = 1e-4 * saturation();
    let c = coefficients();
    for resolution in [5, 20, 40] {
        for creepage in [[-small, 0.0, 0.0], [0.0, small, 0.0], [0.0, 0.0, small / A]] {
            let run = run(&with(fastsim(creepage), "resolution", resolution));
            let linear = c.forces([A, B], SHEAR_MODULUS, creepage);
            let largest = linear.force_x.abs().max(linear.force_y.abs());
            let (x, y) = (run.number("creep_force_x_n"), run.number("creep_force_y_n"));
            let rule = if creepage[2] == 0.0 { 0.0 } else { 0.25 / f64::from(resolution).powi(2) };
            let tolerance = (5e-4 + rule) * largest;
            assert!((x - linear.force_x).abs() < tolerance, "{x} {linear:?}");
            assert!((y - linear.force_y).abs() < tolerance, "{y} {linear:?}");
        }
    }
}

/// Every mixture of creepages has Kalker's slopes with three flexibilities. With one flexibility it
/// has the component of the linear force along the creepage. Tolerance: as in `slopes_are_kalkers`.
#[test]
fn slopes_of_mixed_creepages() {
    let s = 1e-4 * saturation();
    let creepage = [-s, 0.7 * s, -1.3 * s / A];
    let linear = coefficients().forces([A, B], SHEAR_MODULUS, creepage);
    let three = run(&with(fastsim(creepage), "flexibility", "three"));
    assert_close(three.number("creep_force_x_n"), linear.force_x, 1e-3);
    assert_close(three.number("creep_force_y_n"), linear.force_y, 2e-3);
    let single = run(&fastsim(creepage));
    assert!((single.number("creep_force_x_n") / linear.force_x - 1.0).abs() > 0.01);
}

/// Converges to the closed form without spin, with the order 2 of the scheme in the length of the
/// cells.
#[test]
fn converges_to_the_closed_form() {
    let springs = 8.0 * A / (3.0 * SHEAR_MODULUS * coefficients().c11);
    let bound = FRICTION * 2.0 * NORMAL_FORCE / (PI * A * B);
    for share in [0.1, 0.5, 0.9] {
        let creep = share * creep_force::FULL_SLIP * springs * bound / A;
        let exact = creep_force::force_ratio(share * creep_force::FULL_SLIP);
        let error = |resolution: usize| {
            let run = run(&with(fastsim([-creep, 0.0, 0.0]), "resolution", resolution));
            let ratio = run.number("traction_coefficient") / FRICTION;
            (ratio - exact).abs()
        };
        let errors = [10, 20, 40, 80].map(error);
        assert!(errors[0] < 3e-3 && errors[3] < 6e-5, "{share}: {errors:?}");
        let order = (errors[0] / errors[3]).log2() / 3.0;
        assert!(order > 1.8, "{share}: order {order}, {errors:?}");
    }
}

/// Order of the scheme with spin, where the direction of slip turns along a strip.
#[test]
fn converges_with_spin() {
    let s = saturation();
    let lateral = |resolution: usize| {
        let case = fastsim([-0.5 * s, 0.3 * s, 1.5 * s / A]);
        run(&with(case, "resolution", resolution)).number("creep_force_y_n")
    };
    let [a, b, c, d] = [20, 40, 80, 160].map(lateral);
    let order = ((a - b) / (c - d)).abs().log2() / 2.0;
    assert!(order > 0.8, "order {order}: {a} {b} {c} {d}");
    assert!(((c - d) / d).abs() < 2e-3);
}

#[test]
fn full_slip_carries_the_friction_bound() {
    let limit = FRICTION * NORMAL_FORCE;
    for resolution in [1, 2, 7, 20] {
        for (creepage, key) in
            [([-1.0, 0.0, 0.0], "creep_force_x_n"), ([0.0, -1.0, 0.0], "creep_force_y_n")]
        {
            let run = run(&with(fastsim(creepage), "resolution", resolution));
            assert_close(run.number(key), limit, ROUNDING);
            assert_close(run.number("slip_area_ratio"), 1.0, ROUNDING);
            assert_balance(&run, power_scale(creepage));
        }
    }
    let run = run(&at_force(FRICTION));
    assert_close(run.number("creep_force_x_n"), limit, ROUNDING);
    assert_close(run.number("slip_area_ratio"), 1.0, ROUNDING);
    // Parabola of the traction at the centre, 4/3 of f p_0.
    assert_close(run.number("max_traction_pa"), 4.0 / 3.0 * FRICTION * 1352e6, 1e-3);
}

#[test]
fn force_rises_with_creepage_to_saturation() {
    let (mut before, s) = (0.0, saturation());
    for step in 1..75 {
        let run = run(&fastsim([-0.05 * f64::from(step) * s, 0.0, 0.0]));
        let force = run.number("creep_force_x_n");
        assert!(force >= before && force <= FRICTION * NORMAL_FORCE * (1.0 + ROUNDING));
        before = force;
    }
    assert_close(before, FRICTION * NORMAL_FORCE, ROUNDING);
}

#[test]
fn force_round_trip() {
    for share in [1e-9, 1e-4, 0.1, 0.5, 0.9, 0.99, 0.999, -0.3, -0.999] {
        let mu = share * FRICTION;
        let by_force = run(&at_force(mu));
        assert_close(by_force.number("traction_coefficient"), mu, ROUNDING);
        assert!(
            by_force.number("creepage_xi") * mu < 0.0,
            "a driving wheel has a creepage below 0"
        );
        let creepage = [by_force.number("creepage_xi"), 0.0, 0.0];
        let by_creepage = run(&fastsim(creepage));
        assert_eq!(by_force.contact, by_creepage.contact);
        assert_balance(&by_force, power_scale(creepage));
        let newtons = by_force.number("creep_force_x_n");
        let third = run(&driven(fastsim([0.0; 3]), "tangential_force", newtons));
        assert_close(third.number("creep_force_x_n"), newtons, ROUNDING);
    }
}

#[test]
fn mirror_and_reversal() {
    let s = saturation();
    for kind in ["single", "three"] {
        let [xi, eta, phi] = [-0.6 * s, 0.4 * s, 0.8 * s / A];
        let solve = |creepage| run(&with(fastsim(creepage), "flexibility", kind));
        let (one, mirror) = (solve([xi, eta, phi]), solve([xi, -eta, -phi]));
        let reverse = solve([-xi, -eta, -phi]);
        for (key, mirrored, reversed) in [
            ("creep_force_x_n", 1.0, -1.0),
            ("creep_force_y_n", -1.0, -1.0),
            ("spin_moment_nm", -1.0, -1.0),
            ("friction_power_w", 1.0, 1.0),
            ("slip_area_ratio", 1.0, 1.0),
        ] {
            assert_close(mirror.number(key), mirrored * one.number(key), ROUNDING);
            assert_eq!(reverse.number(key), reversed * one.number(key), "{key}");
        }
        let grid = *one.grid().as_structured().unwrap();
        let largest = one.fields["friction_power"].iter().copied().fold(0.0, f64::max);
        for (index, value) in one.fields["friction_power"].iter().enumerate() {
            let (i, j) = (index % grid.ni, index / grid.ni);
            let other = mirror.fields["friction_power"][(grid.nj - 1 - j) * grid.ni + i];
            assert!((value - other).abs() < ROUNDING * largest);
        }
    }
    let longitudinal = run(&fastsim([-0.6 * s, 0.0, 0.0]));
    assert_eq!(longitudinal.number("creep_force_y_n"), 0.0);
    assert!(longitudinal.number("spin_moment_nm").abs() < ROUNDING * NORMAL_FORCE * A);
}

#[test]
fn no_creepage_no_heat() {
    for case in [fastsim([0.0; 3]), at_force(0.0)] {
        let [elliptic, strips, _, reduced] = variants(&case);
        for case in [case.clone(), without(case, "partial_slip"), elliptic, strips, reduced] {
            let run = run(&case);
            for field in ["traction", "slip_velocity", "friction_power"] {
                assert!(run.fields[field].iter().all(|v| v.to_bits() == 0), "{field}");
            }
            for key in ["creepage_xi", "creep_force_x_n", "friction_power_w", "slip_area_ratio"] {
                assert_eq!(run.number(key), 0.0);
            }
            assert_eq!(run.fields["surface_speed"], [SPEED, SPEED]);
            assert_close(run.integral("pressure"), NORMAL_FORCE, ROUNDING);
        }
    }
}

/// Creepages far below and far above saturation, down to where squares underflow.
#[test]
fn tiny_and_huge_creepages() {
    for size in [1e-300, 1e-160, 1e-12, 1e-6, 1.0, 1e6] {
        for creepage in [[-size, 0.0, 0.0], [0.0, size, 0.0], [0.0, 0.0, size], [size; 3]] {
            assert_balance(&run(&with(fastsim(creepage), "resolution", 6)), power_scale(creepage));
        }
    }
}

/// Spin alone pushes the wheel sideways, against Kalker's sign, and slips around the middle.
#[test]
fn spin_alone() {
    let phi = saturation() / A;
    let run = run(&fastsim([0.0, 0.0, phi]));
    assert!(run.number("creep_force_y_n") < 0.0);
    assert!(run.number("spin_moment_nm") < 0.0);
    assert!(run.number("creep_force_x_n").abs() < ROUNDING * NORMAL_FORCE);
    assert_balance(&run, power_scale([0.0, 0.0, phi]));
}

/// Everything slides without `partial_slip`, with f times Hertz's pressure against the rigid slip.
#[test]
fn without_partial_slip_everything_slides() {
    let sliding = run(&without(at_force(0.4), "partial_slip"));
    let sticking = run(&at_force(0.4));
    assert_eq!(sliding.number("creepage_xi"), sticking.number("creepage_xi"));
    assert_close(sliding.number("traction_coefficient"), FRICTION, ROUNDING);
    assert_close(sliding.number("slip_area_ratio"), 1.0, ROUNDING);
    let velocity = SPEED * sliding.number("creepage_xi");
    assert_close(sliding.integral("slip_velocity"), velocity * sliding.number("area_m2"), ROUNDING);
    let remark = |run: &Run| run.layout.remarks.iter().any(|r| r.contains("effects.partial_slip"));
    assert!(remark(&sliding) && !remark(&sticking));
    for creepage in [[-0.01, 0.0, 0.0], [0.003, 0.002, 1.0], [0.0, 0.0, -3.0]] {
        let run = run(&without(fastsim(creepage), "partial_slip"));
        assert_balance(&run, power_scale(creepage));
    }
    // Traction over pressure is f, except for the strips of which the mean of an element consists.
    let middle = sliding.grid().points() / 2;
    let share = sliding.longitudinal("traction")[middle] / sliding.fields["pressure"][middle];
    assert_close(share, FRICTION, 2e-3);
}

/// Three flexibilities balance the power of the creepages without spin, but not with spin.
#[test]
fn power_of_three_flexibilities() {
    let s = saturation();
    let without_spin = [-0.5 * s, 0.4 * s, 0.0];
    let run_three = |creepage| run(&with(fastsim(creepage), "flexibility", "three"));
    assert_balance(&run_three(without_spin), power_scale(without_spin));
    let run = run_three([-0.5 * s, 0.4 * s, s / A]);
    let power = -SPEED
        * (run.number("creepage_xi") * run.number("creep_force_x_n")
            + run.number("creepage_eta") * run.number("creep_force_y_n")
            + run.number("creepage_phi_per_m") * run.number("spin_moment_nm"));
    let missing = (run.number("friction_power_w") / power - 1.0).abs();
    assert!(missing > 1e-3 && missing < 0.3, "{missing}");
    assert_close(run.integral("friction_power"), run.number("friction_power_w"), ROUNDING);
    assert!(run.fields["friction_power"].iter().all(|power| *power >= 0.0));
}

#[test]
fn what_fastsim_cannot_take_is_refused() {
    let mut auxetic = at_force(0.3);
    auxetic["materials"]["steel"]["poisson_ratio"] = json!(-0.1);
    let refused = refusal(&configuration(&auxetic));
    assert_eq!(refused.key, "bodies.wheel.material");
    assert!(refused.reason.contains("begins at 0"), "{refused}");
    let refused = refusal(&configuration(&at_force(0.61)));
    assert_eq!(refused.key, "motion.traction_coefficient");
    let refused = refusal(&configuration(&with(at_force(0.3), "flexibility", "two")));
    assert_eq!(refused.key, "mech.flexibility");
    let refused = refusal(&configuration(&with(at_force(0.3), "stick_zone", "strips")));
    assert_eq!(refused.key, "mech.stick_zone");
    assert!(refused.fix.contains("elliptic"), "{refused}");
    let refused = refusal(&configuration(&with(at_force(0.3), "slope_factor", 1.2)));
    assert_eq!(refused.key, "mech.slope_factor");
}

/// Very long ellipses in both directions, beyond the table, and one element per semi-axis.
#[test]
fn extreme_ellipses() {
    for (a, b) in [(8e-3, 1e-5), (8e-3, 8e-4), (1e-4, 8e-3), (8e-3, 8e-3)] {
        for resolution in [1, 3] {
            let mut case = with(at_force(0.4), "resolution", resolution);
            case["contact"]["semi_axis_a"] = json!(a);
            case["contact"]["semi_axis_b"] = json!(b);
            let run = run(&case);
            assert_close(run.number("traction_coefficient"), 0.4, ROUNDING);
            let power = -SPEED * run.number("creepage_xi") * run.number("creep_force_x_n");
            assert_close(run.integral("friction_power"), power, ROUNDING);
        }
    }
}

/// The work depends on the number of cells only.
#[test]
fn work_is_the_number_of_cells() {
    let work = |resolution: usize| run(&with(at_force(0.4), "resolution", resolution)).report.work;
    assert_eq!([10, 20, 40].map(work), [48 * 20, 96 * 40, 190 * 80]);
}

/// Case with the elliptic bound, and springs or strip theory in the stick zone.
fn elliptic(creepage: [f64; 3], stick_zone: &str) -> Value {
    with(with(fastsim(creepage), "traction_bound", "elliptic"), "stick_zone", stick_zone)
}

/// All bounds of the traction and theories of the stick zone, and a reduced creep curve.
fn variants(case: &Value) -> [Value; 4] {
    let elliptic = with(case.clone(), "traction_bound", "elliptic");
    let strips = with(elliptic.clone(), "stick_zone", "strips");
    let reduced = |mut case: Value| {
        for (key, value) in
            [("slope_factor", 0.54), ("slope_factor_ratio", 0.1), ("slope_factor_decrease", 0.62)]
        {
            case = with(case, key, value);
        }
        case
    };
    [elliptic, strips.clone(), reduced(case.clone()), reduced(strips)]
}

/// Normalised creepage under the elliptic bound at a creep.
fn elliptic_reduced(creep: f64) -> f64 {
    let springs = 8.0 * A / (3.0 * SHEAR_MODULUS * coefficients().c11);
    A * creep / (springs * FRICTION * 1.5 * NORMAL_FORCE / (PI * A * B))
}

/// Polach's formula, and that of Haines and Ollerton, with the order of the scheme in the length of
/// the cells. Tolerance of strip theory: its cells are exact, but the sum over the strips has a
/// kink where strips begin to slip completely, of order 5/2.
#[test]
fn elliptic_bound_converges_to_the_closed_forms() {
    type Closed = fn(f64) -> f64;
    let both: [(&str, Closed, f64); 2] = [
        ("springs", creep_force::elliptic_force_ratio, 1.8),
        ("strips", creep_force::strip_force_ratio, 2.0),
    ];
    for (stick_zone, closed, least) in both {
        for share in [0.2, 0.7, 1.6] {
            let creep = share / elliptic_reduced(1.0);
            let error = |resolution: usize| {
                let case = with(elliptic([-creep, 0.0, 0.0], stick_zone), "resolution", resolution);
                let ratio = run(&case).number("traction_coefficient") / FRICTION;
                (ratio - closed(share)).abs()
            };
            let errors = [10, 20, 40, 80].map(error);
            println!("{stick_zone} {share}: {errors:?}");
            assert!(errors[0] < 3e-3 && errors[3] < 6e-5, "{stick_zone} {share}: {errors:?}");
            let order = (errors[0] / errors[3].max(1e-9)).log2() / 3.0;
            assert!(order > least, "{stick_zone} {share}: order {order}, {errors:?}");
        }
    }
}

/// Kalker's slopes depend neither on the bound nor on strip theory; a factor reduces all of them.
/// Tolerance: the share of the slip zone, proportional to the creepage; for spin the trapezoidal
/// rule over cells π/2 times as long in the middle.
#[test]
fn slopes_under_the_elliptic_bound() {
    let small = 1e-4 * saturation();
    let c = coefficients();
    for (stick_zone, creepage) in [
        ("springs", [-small, 0.0, 0.0]),
        ("springs", [0.0, small, 0.0]),
        ("springs", [0.0, 0.0, small / A]),
        ("strips", [-small, 0.0, 0.0]),
        ("strips", [0.0, small, 0.0]),
        ("strips", [0.0, 0.0, small / A]),
    ] {
        let case = elliptic(creepage, stick_zone);
        let linear = c.forces([A, B], SHEAR_MODULUS, creepage);
        let largest = linear.force_x.abs().max(linear.force_y.abs());
        for factor in [1.0, 0.54] {
            let tolerance = (if creepage[2] == 0.0 { 1e-3 } else { 1.6e-3 }) * largest;
            let run = run(&with(case.clone(), "slope_factor", factor));
            let (x, y) = (run.number("creep_force_x_n"), run.number("creep_force_y_n"));
            assert!((x - factor * linear.force_x).abs() < tolerance, "{x} {linear:?}");
            assert!((y - factor * linear.force_y).abs() < tolerance, "{y} {linear:?}");
        }
    }
}

/// A constant factor is equivalent to a creepage reduced by it.
#[test]
fn reduced_slope_is_less_creepage() {
    let creep = -1.3 * saturation();
    for case in variants(&fastsim([creep, 0.0, 0.0])).into_iter().take(2) {
        let reduced = run(&with(case.clone(), "slope_factor", 0.5));
        let mut less = case;
        less["motion"]["creepage"]["xi"] = json!(0.5 * creep);
        let less = run(&less);
        assert_close(reduced.number("creep_force_x_n"), less.number("creep_force_x_n"), ROUNDING);
    }
}

/// Forces and heat on the grid equal those of the summary, the heat equals the power of the
/// creepages, and forces stay within f N, for mixtures of creepages from adhesion to slip. With
/// strip theory the slip is scaled to this balance, so that several flexibilities satisfy it too.
#[test]
fn balance_of_the_variants() {
    for size in [1e-3, 0.1, 0.7, 3.0, 40.0] {
        for [xi, eta, phi] in
            [[-1.0, 0.0, 0.0], [0.3, -0.6, 0.0], [-0.4, 0.5, 0.8], [0.0, 0.0, -1.0]]
        {
            let s = size * saturation();
            let creepage = [xi * s, eta * s, phi * s / A];
            for case in variants(&fastsim(creepage)) {
                let run = run(&with(case, "resolution", 12));
                assert_balance(&run, power_scale(creepage));
                let force = run.number("creep_force_x_n").hypot(run.number("creep_force_y_n"));
                assert!(force <= FRICTION * NORMAL_FORCE * (1.0 + ROUNDING));
            }
        }
    }
    let s = saturation();
    let creepage = [-0.5 * s, 0.4 * s, s / A];
    let blended = with(elliptic(creepage, "strips"), "flexibility", "blended");
    assert_balance(&run(&blended), power_scale(creepage));
}

#[test]
fn force_round_trip_of_the_variants() {
    for share in [1e-6, 1e-4, 0.1, 0.5, 0.9, -0.99] {
        let mu = share * FRICTION;
        for case in variants(&at_force(mu)) {
            let by_force = run(&case);
            assert_close(by_force.number("traction_coefficient"), mu, 1e-9);
            let xi = by_force.number("creepage_xi");
            let mut by_creepage = case.clone();
            by_creepage["motion"] = json!({"speed": SPEED, "creepage": {"xi": xi}});
            assert_close(run(&by_creepage).number("traction_coefficient"), mu, 1e-9);
        }
    }
}

/// The bound at the centre is f times Hertz's pressure, and no element exceeds it.
#[test]
fn traction_under_the_elliptic_bound() {
    let s = saturation();
    for stick_zone in ["springs", "strips"] {
        let run = run(&elliptic([-0.7 * s, 0.5 * s, 0.9 * s / A], stick_zone));
        assert!(run.number("max_traction_pa") <= 1.001 * FRICTION * 1352e6);
        let (x, y) = run.fields["traction"].split_at(run.grid().points());
        let middle = run.grid().points() / 2;
        let pressures = &run.fields["pressure"];
        for (index, pressure) in pressures.iter().enumerate() {
            let traction = x[index].hypot(y[index]);
            // Elements on the rim hold means of strips; inside, the lattice is exact to 1e-3.
            let slack = 2e-2 * pressures[middle];
            assert!(traction <= FRICTION * (pressure + slack), "{stick_zone} {index}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Any mixture of creepages: the heat equals the power of the creepages and is nowhere
    /// negative; forces stay within f N.
    #[test]
    fn balance(
        xi in -3.0..3.0f64, eta in -3.0..3.0f64, phi in -6.0..6.0f64,
        decade in -4i32..3, resolution in 1usize..12,
    ) {
        let size = saturation() * 10f64.powi(decade);
        let creepage = [xi * size, eta * size, phi * size / A];
        let run = run(&with(fastsim(creepage), "resolution", resolution));
        assert_balance(&run, power_scale(creepage));
        let force = run.number("creep_force_x_n").hypot(run.number("creep_force_y_n"));
        prop_assert!(force <= FRICTION * NORMAL_FORCE * (1.0 + ROUNDING));
    }

    /// Changing the units of length, force and time changes figures by powers of the factors only.
    /// Tolerance: rounding, magnified by the search for the creepage close to f N.
    #[test]
    fn independent_of_the_units(
        length in 1e-3..1e3f64, force in 1e-3..1e3f64, time in 1e-3..1e3f64, mu in 0.01..0.57f64,
    ) {
        let mut case = driven(paper(), "traction_coefficient", mu);
        case["mech"]["model"] = json!("fastsim");
        let mut scaled = case.clone();
        for (pointer, factor) in [
            ("/bodies/wheel/radius_x", length),
            ("/bodies/rail/radius_y", length),
            ("/motion/speed", length / time),
            ("/load/normal_force", force),
        ] {
            let value = scaled.pointer_mut(pointer).unwrap();
            *value = json!(value.as_f64().unwrap() * factor);
        }
        let pressure = force / (length * length);
        scaled["materials"]["steel"]["youngs_modulus"] = json!(210e9 * pressure);
        let (one, other) = (run(&case), run(&scaled));
        for (key, factor) in [
            ("semi_axis_a_m", length),
            ("creepage_xi", 1.0),
            ("max_traction_pa", pressure),
            ("friction_power_w", force * length / time),
        ] {
            assert_close(other.number(key), factor * one.number(key), 1e-10);
        }
    }
}
