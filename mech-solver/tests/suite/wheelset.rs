//! Both wheels of a wheelset in model `wheel-on-track`: parts and sums, loads, mirror image, and
//! torque on the axle.

use super::common::{
    NoInputs, Run, Store, assert_close, configuration, fitted, paper, refusal, run,
};
use mech_solver::MechSolver;
use proto::model::{Solver, Step};
use proto::progress::Progress;
use serde_json::{Value, json};

const LOAD: f64 = 200e3;

/// A wheelset under its load, with elements of 0.4 mm.
fn both(y: f64, yaw: f64) -> Value {
    let mut case = fitted(paper(), "wheel-on-track");
    case["mech"]["resolution"] = json!(25);
    case["wheelset"] = json!({"side": "both", "nominal_radius": 0.46, "y": y, "yaw": yaw});
    case["load"] = json!({"axle_load": LOAD});
    case
}

fn totals(run: &Run) -> Value {
    run.model.summary()["wheelset"].clone()
}

#[track_caller]
fn of(figures: &Value, path: &str) -> f64 {
    let figure = figures.pointer(&format!("/{}", path.replace('.', "/")));
    figure.and_then(Value::as_f64).unwrap_or_else(|| panic!("{path}: {figures}"))
}

/// At a height and a roll both wheels equal the left and the right wheel alone, to the bit. The
/// sums are those of both, and the fields of each rail lie on its own lane.
#[test]
fn the_whole_is_the_sum_of_its_parts() {
    let mut case = both(2e-3, 3e-3);
    case["load"] = json!({});
    case["wheelset"]["z"] = json!(-0.6e-3);
    case["wheelset"]["roll"] = json!(1e-4);
    let whole = run(&case);
    let parts = ["left", "right"].map(|side| {
        case["wheelset"]["side"] = json!(side);
        run(&case)
    });
    let all = totals(&whole);
    for (side, part) in ["left", "right"].iter().zip(&parts) {
        let own = totals(part);
        for key in ["force_x_n", "force_y_n", "force_z_n"] {
            assert_eq!(of(&all, &format!("{side}.{key}")), of(&own, key));
        }
        assert_eq!(of(&all, &format!("{side}.axle_moment_nm")), of(&own, "axes.moment_y_nm"));
        assert!(own.pointer("/left/axle_moment_nm").is_none() && own.get("roll_rad").is_none());
    }
    let [left, right] = parts.each_ref().map(totals);
    for key in ["force_y_n", "moment_x_nm", "axes.force_y_n", "axes.moment_z_nm"] {
        assert_eq!(of(&all, key), of(&left, key) + of(&right, key));
    }
    let listed = |run: &Run| run.contact["each_patch"].as_array().expect("patches").clone();
    let [left, right] = parts.each_ref().map(listed);
    let (of_whole, mut of_parts) = (listed(&whole), [right, left].concat());
    assert_eq!(of_whole.len(), 2);
    for (one, other) in of_whole.iter().zip(&mut of_parts) {
        // Only the position on the grid differs, by the same shift to either side.
        let shift = of(one, "y_m") - of(other, "y_m");
        assert_close(shift.abs(), (of(&of_whole[1], "y_m") - of(&of_whole[0], "y_m")) / 2.0, 0.5);
        other["y_m"] = one["y_m"].clone();
        // A single wheel has no name.
        other["name"] = one["name"].clone();
        assert_eq!(one, other);
    }
    for field in ["pressure", "traction"] {
        let sum: f64 = parts.iter().map(|part| part.integral(field)).sum();
        assert_close(whole.integral(field), sum, 1e-12);
    }
    let grid = whole.grid().as_structured().expect("a plane");
    let pressed: Vec<f64> =
        whole.longitudinal("pressure").chunks(grid.ni).map(|row| row.iter().sum()).collect();
    let free = pressed.iter().skip_while(|row| **row == 0.0).skip_while(|row| **row > 0.0);
    let between = free.take_while(|row| **row == 0.0).count();
    assert!(between as f64 * grid.dy() >= 5e-3 && between < pressed.len() / 2, "{between}");
}

/// Loads are shared as prescribed, at one height: the left wheel alone, with its load at the roll
/// found, stands at the same height. Tolerances: that of the forces, 1e-5, and its effect on the
/// depth.
#[test]
fn both_wheels_carry_their_shares_at_one_height() {
    for (y, share) in [(0.0, 0.6), (-4e-3, 0.5), (6.3e-3, 0.45), (8e-3, 0.5)] {
        let mut case = both(y, -1e-3);
        case["load"]["left_share"] = json!(share);
        let all = totals(&run(&case));
        assert_close(of(&all, "left.force_z_n"), share * LOAD, 1.1e-5);
        assert_close(of(&all, "right.force_z_n"), (1.0 - share) * LOAD, 1.1e-5);
        for (side, share) in [("left", share), ("right", 1.0 - share)] {
            case["wheelset"]["side"] = json!(side);
            case["wheelset"]["roll"] = all["roll_rad"].clone();
            case["load"] = json!({"vertical_force": share * LOAD});
            let alone = totals(&run(&case));
            assert!((of(&alone, "z_m") - of(&all, "z_m")).abs() < 5e-9, "{alone} {all}");
            let force = |figures: &Value, name: &str| of(figures, &format!("{name}force_y_n"));
            let own = force(&all, &format!("{side}."));
            assert!((force(&alone, "") - own).abs() < 1e-4 * LOAD, "{y}: {alone} {all}");
        }
    }
}

/// A centred wheelset has no roll and no lateral force, and mirroring the case mirrors the result.
/// Tolerances: rounding of the profiles, which the pressure magnifies; the balance, 1e-5.
#[test]
fn a_wheelset_is_its_mirror_image() {
    let mut middle = both(0.0, 0.0);
    middle["wheelset"]["torque"] = json!(300.0);
    let found = totals(&run(&middle));
    assert!(of(&found, "roll_rad").abs() < 1e-9);
    assert!(of(&found, "force_y_n").abs() < 1e-5 * LOAD);
    assert_close(of(&found, "left.force_x_n"), of(&found, "right.force_x_n"), 1e-6);
    let [one, other] = [1.0, -1.0].map(|sign| {
        let mut case = both(sign * 5e-3, sign * 2e-3);
        case["wheelset"]["torque"] = json!(300.0);
        totals(&run(&case))
    });
    assert_close(of(&one, "roll_rad"), -of(&other, "roll_rad"), 1e-5);
    assert_close(of(&one, "z_m"), of(&other, "z_m"), 1e-6);
    let spin = "angular_velocity_rad_per_s";
    assert_close(of(&one, spin), of(&other, spin), 1e-7);
    for (key, sign) in [("force_x_n", 1.0), ("force_y_n", -1.0), ("force_z_n", 1.0)] {
        let (left, right) = (format!("left.{key}"), format!("right.{key}"));
        assert!((of(&one, &left) - sign * of(&other, &right)).abs() < 1e-4 * LOAD, "{key}");
        assert!((of(&one, &right) - sign * of(&other, &left)).abs() < 1e-4 * LOAD, "{key}");
    }
}

/// Incomplete values for two wheels, and values that a single wheel does not support, are refused.
#[test]
fn what_does_not_fit_a_wheelset_is_refused() {
    let refused = |change: &dyn Fn(&mut Value), key: &str, words: &str| {
        let mut case = both(0.0, 0.0);
        change(&mut case);
        let refusal = refusal(&configuration(&case));
        assert!(refusal.key == key && refusal.to_string().contains(words), "{refusal}");
    };
    refused(&|case| case["load"] = json!({"vertical_force": 1e5}), "load.vertical_force", "axle");
    refused(&|case| case["load"] = json!({}), "load.axle_load", "a force or a height");
    refused(
        &|case| case["wheelset"]["roll"] = json!(1e-3),
        "wheelset.roll",
        "follows from the loads",
    );
    refused(&|case| case["wheelset"]["side"] = json!("left"), "load.axle_load", "a single wheel");
}

/// The torque on the axle balances the contact forces at the angular velocity found, for both
/// wheels and for one. Prescribing that angular velocity gives the same contact. The driving power
/// goes into friction and into the pull: T Ω = F_x V + P. Tolerances: the balance, 1e-5 of the load
/// on the nominal radius; for the power, the load on a twentieth of an element, the distance of the
/// centre of pressure from the reference.
#[test]
fn a_torque_is_in_balance_with_the_contact_forces() {
    for (side, torque) in [("both", 0.0), ("both", 6e3), ("both", -9e3), ("right", 2e3)] {
        let mut case = both(-3e-3, 1e-3);
        case["wheelset"]["side"] = json!(side);
        if side == "right" {
            case["load"] = json!({"vertical_force": 0.5 * LOAD});
        }
        case["wheelset"]["torque"] = json!(torque);
        let own = run(&case);
        let found = totals(&own);
        let most = 1.1e-5 * LOAD * 0.46;
        assert!((of(&found, "axes.moment_y_nm") + torque).abs() < most, "{found}");
        let spin = of(&found, "angular_velocity_rad_per_s");
        let given = -of(&found, "axes.moment_y_nm") * spin;
        let taken = of(&found, "force_x_n") * 38.889 + own.number("friction_power_w");
        assert!((given - taken).abs() < 2e-5 * LOAD * spin, "{side} {torque}: {given} {taken}");
        case["wheelset"].as_object_mut().expect("a table").remove("torque");
        case["wheelset"]["angular_velocity"] = json!(spin);
        let again = totals(&run(&case));
        assert!((of(&again, "axes.moment_y_nm") + torque).abs() < 2.0 * most, "{again}");
    }
    let mut case = both(0.0, 0.0);
    case["wheelset"]["torque"] = json!(0.61 * LOAD * 0.46);
    let setup = MechSolver.configure(&configuration(&case)).expect("its patches are found");
    let mut model = setup.build(&Progress::default()).expect("a checked case builds");
    let error = model.solve(&Step::STEADY, &NoInputs, &mut Store::default());
    let error = error.expect_err("more than friction carries").to_string();
    assert!(error.contains("at any angular velocity"), "{error}");
}
