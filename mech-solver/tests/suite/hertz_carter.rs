//! The model `hertz-carter` through the traits of a participant, against closed forms.

use crate::common::*;
use elastic::carter;
use proptest::prelude::*;
use proto::model::Step;
use serde_json::json;
use std::f64::consts::PI;

/// Rounding of the sums over the elements: a few units in the last place.
const ROUNDING: f64 = 1e-13;

#[test]
fn the_papers_contact() {
    let run = run(&paper());
    // Reference values with five digits.
    assert_close(run.number("semi_axis_a_m"), 7.8956e-3, 1e-4);
    assert_close(run.number("semi_axis_b_m"), 5.9392e-3, 1e-4);
    assert_close(run.number("max_pressure_pa"), 1364.38e6, 1e-4);
    assert_close(run.number("approach_m"), 126.551e-6, 1e-4);
    assert_close(run.number("area_m2"), 147.3e-6, 5e-4);
    assert_close(run.number("traction_coefficient"), 0.58, ROUNDING);
}

/// Creepages of Table 3 for the ellipse of Table 2, by both laws. Fails with the printed eq. 18,
/// which equates both laws. Tolerance: half a unit of the last printed digit.
#[test]
fn creepages_of_both_laws() {
    for (mu, by_pressure, by_radius) in [
        (0.58, 1.149e-2, 0.851e-2),
        (0.5, 0.832e-2, 0.616e-2),
        (0.4, 0.594e-2, 0.440e-2),
        (0.3, 0.412e-2, 0.305e-2),
        (0.2, 0.258e-2, 0.191e-2),
    ] {
        let case = driven(paper_table_2(), "traction_coefficient", mu);
        let pressure = run(&case);
        assert!((pressure.number("creepage_xi") + by_pressure).abs() < 0.51e-5, "{mu}");
        let mut case = case;
        case["motion"]["creep_law"] = json!("carter-radius");
        let radius = run(&case);
        assert!((radius.number("creepage_xi") + by_radius).abs() < 0.51e-5, "{mu}");
        assert_close(radius.number("traction_coefficient"), mu, ROUNDING);
    }
}

/// Sums over element means equal the exact integrals, at every resolution.
#[test]
fn forces_and_power_are_exact_at_every_resolution() {
    for resolution in [1, 2, 5, 10, 40] {
        for mu in [1e-6, 0.2, 0.3, 0.58, 0.999 * FRICTION, FRICTION] {
            let mut case = driven(paper(), "traction_coefficient", mu);
            case["mech"]["resolution"] = json!(resolution);
            let run = run(&case);
            let power = SPEED * -run.number("creepage_xi") * mu * 134e3;
            assert_close(run.number("friction_power_w"), power, ROUNDING);
            assert_close(run.integral("pressure"), 134e3, ROUNDING);
            // Rounding, magnified by the subtraction in the stick zone: see `force_of_a_strip`.
            assert_close(run.integral("traction"), mu * 134e3, ROUNDING + 1e-13 / mu.sqrt());
            assert_close(run.integral("friction_power"), power, ROUNDING);
        }
    }
}

/// Sliding beyond the creep law's range, and sliding without a stick zone.
#[test]
fn power_of_a_sliding_contact_is_exact() {
    for xi in [-0.02, 0.05, -1.0] {
        for case in [paper(), without(paper(), "partial_slip")] {
            let run = run(&driven(case, "creepage", xi));
            let power = SPEED * xi.abs() * FRICTION * 134e3;
            assert_close(run.number("creep_force_x_n"), -xi.signum() * FRICTION * 134e3, ROUNDING);
            assert_close(run.number("friction_power_w"), power, ROUNDING);
            assert_close(run.integral("friction_power"), power, ROUNDING);
            assert_eq!(run.number("slip_area_ratio"), 1.0);
        }
    }
}

/// Elements inside the slip zone, across the edge and across the border of the stick zone, against
/// pointwise quadrature of the closed forms.
#[test]
fn element_means_are_means_of_the_closed_forms() {
    let case = driven(paper(), "traction_coefficient", 0.4);
    let run = run(&case);
    let grid = *run.grid().as_structured().unwrap();
    let (a, b) = (run.number("semi_axis_a_m"), run.number("semi_axis_b_m"));
    let bound = FRICTION * run.number("max_pressure_pa");
    let fraction = carter::slip_fraction(0.4 / FRICTION);
    let velocity = SPEED * 2.0 * bound * STEEL;
    let n = 400;
    for (i, j) in [(20, 15), (12, 17), (2, 11), (4, 22), (33, 26), (20, 30), (16, 15), (15, 18)] {
        let [x0, y0, _] = grid.centre(i, j);
        let mut means = [0.0; 3];
        for sample in 0..n * n {
            let offset = |k: usize| (k as f64 + 0.5) / n as f64 - 0.5;
            let (x, y) = (x0 + grid.dx() * offset(sample % n), y0 + grid.dy() * offset(sample / n));
            let eta_squared = 1.0 - (y / b).powi(2);
            let position = x / (a * eta_squared.max(1e-300).sqrt());
            if eta_squared > 0.0 && position.abs() < 1.0 {
                let traction =
                    bound * eta_squared.sqrt() * carter::traction_shape(position, fraction);
                let slip = velocity * carter::slip_shape(position, fraction);
                means[0] += traction / (n * n) as f64;
                means[1] += slip / (n * n) as f64;
                means[2] += traction * slip / (n * n) as f64;
            }
        }
        let at = j * grid.ni + i;
        // Sampling error: at the edge one of n columns of samples is uncertain.
        assert!((run.longitudinal("traction")[at] - means[0]).abs() < 2e-4 * bound, "{i} {j}");
        assert!((-run.longitudinal("slip_velocity")[at] - means[1]).abs() < 1e-3 * velocity);
        let power = run.longitudinal("friction_power")[at];
        assert!((power - means[2]).abs() < 1e-4 * bound * velocity, "{i} {j}: {power} {means:?}");
    }
}

#[test]
fn sign_of_a_driving_wheel() {
    let run = run(&driven(paper(), "creepage", -0.005));
    assert!(run.number("creepage_xi") == -0.005);
    assert!(run.number("creep_force_x_n") > 0.0 && run.number("traction_coefficient") > 0.0);
    assert!(run.longitudinal("traction").iter().all(|traction| *traction >= 0.0));
    assert!(run.longitudinal("slip_velocity").iter().all(|slip| *slip <= 0.0));
    assert!(run.integral("traction") > 0.0 && run.integral("slip_velocity") < 0.0);
    // The rim of a driving wheel passes through the contact faster than the rail.
    assert_eq!(run.fields["surface_speed"], [SPEED * 1.005, SPEED]);
}

#[test]
fn sign_of_a_braking_wheel() {
    let run = run(&driven(paper(), "tangential_force", -50e3));
    assert!(run.number("creepage_xi") > 0.0);
    assert_close(run.number("creep_force_x_n"), -50e3, ROUNDING);
    assert!(run.longitudinal("traction").iter().all(|traction| *traction <= 0.0));
    assert!(run.longitudinal("slip_velocity").iter().all(|slip| *slip >= 0.0));
    assert!(run.fields["surface_speed"][0] < SPEED);
}

/// The slip zone lies at the trailing edge, x < 0, and the friction power is never negative.
#[test]
fn slip_is_at_the_trailing_edge() {
    let run = run(&driven(paper(), "traction_coefficient", -0.4));
    let grid = run.grid().as_structured().unwrap();
    let border = (2.0 * carter::slip_fraction(0.4 / FRICTION) - 1.0) * run.number("semi_axis_a_m");
    let row = grid.nj / 2;
    for i in 0..grid.ni {
        let slips = run.longitudinal("slip_velocity")[row * grid.ni + i] > 0.0;
        assert_eq!(slips, grid.x(i) - 0.5 * grid.dx() < border, "column {i}");
    }
    assert!(run.fields["friction_power"].iter().all(|power| *power >= 0.0));
}

/// Driving and braking differ in sign only, left and right not at all, bit for bit.
#[test]
fn mirror_in_y_and_reversal_of_the_force() {
    let driving = run(&driven(paper(), "traction_coefficient", 0.4));
    let braking = run(&driven(paper(), "traction_coefficient", -0.4));
    let grid = *driving.grid().as_structured().unwrap();
    for field in ["pressure", "traction", "slip_velocity", "friction_power"] {
        let sign = if field == "traction" || field == "slip_velocity" { -1.0 } else { 1.0 };
        let (values, reversed) = (driving.longitudinal(field), braking.longitudinal(field));
        for (k, value) in values.iter().enumerate() {
            let (i, j) = (k % grid.ni, k / grid.ni);
            assert_eq!(*value, values[(grid.nj - 1 - j) * grid.ni + i], "{field} {i} {j}");
            assert_eq!(*value, sign * reversed[k], "{field} {i} {j}");
        }
    }
    let points = grid.points();
    assert!(driving.fields["traction"][points..].iter().all(|lateral| *lateral == 0.0));
    assert!(driving.fields["slip_velocity"][points..].iter().all(|lateral| *lateral == 0.0));
}

#[test]
fn no_creepage_no_slip_no_traction_no_heat() {
    for drive in ["creepage", "traction_coefficient", "tangential_force"] {
        for case in [paper(), without(paper(), "partial_slip")] {
            let run = run(&driven(case, drive, 0.0));
            for field in ["traction", "slip_velocity", "friction_power"] {
                assert!(run.fields[field].iter().all(|v| v.to_bits() == 0), "{drive} {field}");
            }
            for key in ["creepage_xi", "creep_force_x_n", "friction_power_w", "slip_area_ratio"] {
                assert_eq!(run.number(key), 0.0);
            }
            assert_eq!(run.fields["surface_speed"], [SPEED, SPEED]);
            assert_close(run.integral("pressure"), 134e3, ROUNDING);
        }
    }
}

/// Creepages so small that the slip zone is a fraction of one element.
#[test]
fn tiny_creepage_keeps_the_balance() {
    for xi in [-1e-6, -1e-9, -1e-15, -1e-300] {
        let run = run(&driven(paper(), "creepage", xi));
        let force = run.number("creep_force_x_n");
        let power = SPEED * -xi * force;
        assert!(force > 0.0);
        assert_close(run.number("friction_power_w"), power, ROUNDING);
        assert_close(run.integral("friction_power"), power, ROUNDING);
        // Rounding of the end of the slip zone, which lies √m over the force from the trailing
        // edge.
        let tolerance = ROUNDING + 1e-14 / (-xi).sqrt();
        assert!(xi < -1e-16 || run.integral("traction") >= 0.0);
        if tolerance < 1e-4 {
            assert_close(run.integral("traction"), force, tolerance);
        }
    }
}

#[test]
fn close_to_the_friction_limit_and_at_it() {
    let limit = carter::prefactor_by_pressure(FRICTION, 1352e6, STEEL);
    for (share, fraction) in [(0.999, 1.0 - 0.001f64.sqrt()), (1.0, 1.0)] {
        let case = driven(paper_table_2(), "traction_coefficient", share * FRICTION);
        let run = run(&case);
        // The subtraction 1 − 0.999 magnifies rounding a thousandfold; the square root halves it.
        assert_close(run.number("slip_area_ratio"), fraction, 1e-12);
        assert_close(-run.number("creepage_xi"), limit * fraction, 1e-12);
        assert_close(run.number("max_traction_pa"), FRICTION * 1352e6, ROUNDING);
        let fastest = SPEED * limit * 2.0 * fraction.sqrt();
        assert_close(run.number("max_slip_velocity_m_per_s"), fastest, 1e-12);
    }
}

/// Full slip: zero at the leading edge, twice the mean at the trailing edge, plus s − A everywhere
/// if the creep exceeds the limit A.
#[test]
fn full_slip_profile() {
    let limit = carter::prefactor_by_pressure(FRICTION, 1352e6, STEEL);
    for creep in [limit, 1.5 * limit] {
        let run = run(&driven(paper_table_2(), "creepage", -creep));
        let grid = *run.grid().as_structured().unwrap();
        let row = grid.nj / 2 * grid.ni;
        let slip = run.longitudinal("slip_velocity");
        assert_close(-slip[row + grid.ni / 2], SPEED * creep, 1e-12);
        // Mean over a row of the slope x/a_y, whose half length varies by (Δy/b)²/24.
        let behind = -slip[row + 5] / SPEED - creep;
        assert_close(behind, limit * 0.75, 2e-4);
        assert_close(run.number("max_slip_velocity_m_per_s"), SPEED * (creep + limit), ROUNDING);
    }
}

/// The whole contact slides without `partial_slip`, with one slip velocity, and carries f N.
#[test]
fn without_partial_slip_everything_slides() {
    let with_stick = run(&paper());
    let sliding = run(&without(paper(), "partial_slip"));
    assert_eq!(sliding.number("creepage_xi"), with_stick.number("creepage_xi"));
    assert_close(sliding.number("traction_coefficient"), FRICTION, ROUNDING);
    assert_close(sliding.integral("traction"), FRICTION * 134e3, ROUNDING);
    let velocity = SPEED * sliding.number("creepage_xi");
    let grid = *sliding.grid().as_structured().unwrap();
    let centre = sliding.longitudinal("slip_velocity")[grid.points() / 2];
    assert_close(centre, velocity, 1e-12);
    // Area of the ellipse: the quadrature is not exact for the length of a strip.
    assert_close(sliding.integral("slip_velocity"), velocity * sliding.number("area_m2"), 1e-6);
    let remark = |run: &Run| run.layout.remarks.iter().any(|r| r.contains("effects.partial_slip"));
    assert!(remark(&sliding) && !remark(&with_stick));
    assert!(!remark(&run(&driven(without(paper(), "partial_slip"), "creepage", -0.01))));
}

#[test]
fn a_given_ellipse_replaces_hertz() {
    let run = run(&paper_table_2());
    let force = 2.0 / 3.0 * PI * 7.98e-3 * 6.01e-3 * 1352e6;
    assert_close(run.number("normal_force_n"), force, ROUNDING);
    assert_close(run.integral("pressure"), force, ROUNDING);
    assert_close(run.number("creep_force_x_n"), 0.58 * force, ROUNDING);
    assert!(run.contact.get("approach_m").is_none());
    assert!(run.layout.remarks.iter().any(|remark| remark.contains("load.normal_force")));
    let mut same = paper_table_2();
    same["load"]["normal_force"] = json!(force);
    let same = crate::common::run(&same);
    assert!(!same.layout.remarks.iter().any(|remark| remark.contains("load.normal_force")));
}

#[test]
fn what_the_model_does_not_know_is_absent() {
    let run = run(&paper());
    assert!(run.contact.get("spin_moment_nm").is_none());
    for key in ["creepage_eta", "creepage_phi_per_m", "creep_force_y_n"] {
        assert_eq!(run.number(key), 0.0);
    }
}

/// Switching `friction_heat` off removes its field, memory and time, and changes nothing else.
#[test]
fn friction_heat_off_means_off() {
    let on = run(&paper());
    let off = run(&without(paper(), "friction_heat"));
    for field in ["pressure", "traction", "slip_velocity"] {
        assert_eq!(on.fields[field], off.fields[field]);
    }
    assert_eq!(on.contact, off.contact);
    let points = on.grid().points() as u64;
    assert_eq!(off.layout.memory_bytes, 8 * 5 * points);
    assert_eq!(on.layout.memory_bytes, 8 * (6 * points + 2));
    assert!(off.layout.solve_seconds < on.layout.solve_seconds);
    assert!(off.layout.grid_of("friction_power").is_none());
    assert_eq!(off.layout.grids.len(), 1);
    let mut asked = configuration(&without(paper(), "friction_heat"));
    asked.outputs.push("friction_power".to_owned());
    assert_eq!(refusal(&asked).key, "effects.friction_heat");
}

#[test]
fn grid_covers_the_ellipse_centre_on_centre() {
    for (resolution, b) in [(1, 6e-3), (7, 6e-3), (40, 8e-3), (10, 1e-4)] {
        let mut case = paper_table_2();
        case["mech"]["resolution"] = json!(resolution);
        case["contact"]["semi_axis_a"] = json!(8e-3);
        case["contact"]["semi_axis_b"] = json!(b);
        let run = run(&case);
        let grid = run.grid().as_structured().unwrap();
        assert_eq!((grid.ni % 2, grid.nj % 2), (1, 1));
        assert_eq!(grid.dx(), 8e-3 / f64::from(resolution));
        assert_eq!(grid.dx(), grid.dy());
        assert_eq!(grid.centre(grid.ni / 2, grid.nj / 2), [0.0; 3]);
        let reach = -grid.y(0) + 0.5 * grid.dy();
        // Rounding if the ellipse ends on the edge of an element.
        assert!(reach > b * (1.0 - 1e-12) && reach < b.max(grid.dy()) + grid.dy(), "{reach} {b}");
        assert_eq!(run.report.work, grid.points() as u64);
    }
}

/// A transient run gives the steady answer in every window, without any state to save.
#[test]
fn every_window_has_the_same_answer_and_no_state() {
    let case = paper();
    let mut run = run(&case);
    let mut store = Store::for_layout(&run.layout, &fields_of(&case));
    for window in 0..3 {
        let start = window as f64 * 1e-3;
        let step = Step { window, iteration: 1, start, end: start + 1e-3 };
        let report = run.model.solve(&step, &NoInputs, &mut store).unwrap();
        run.model.accept();
        assert_eq!(report, run.report);
        assert_eq!(report.substeps, 1);
        assert_eq!(store.0, run.fields);
    }
    let mut first = Store::for_layout(&run.layout, &fields_of(&case));
    run.model.first_outputs(&mut first);
    assert_eq!(first.0, run.fields);
    let mut observed = Store::for_layout(&run.layout, &["pressure".to_owned()]);
    run.model.observe(&mut observed);
    assert_eq!(observed.0["pressure"], run.fields["pressure"]);

    let mut state = Vec::new();
    run.model.save(&mut state).unwrap();
    assert!(state.is_empty() && run.model.restore(&mut state.as_slice()).is_ok());
}

/// Hollow tread, very long ellipses in both directions, one row of elements: the sums stay exact.
#[test]
fn extreme_ellipses() {
    for (crown, tread) in [(0.3, -0.301), (1e-6, 0.3), (0.3, 1e-5), (0.46, 1e9)] {
        let mut case = driven(paper(), "traction_coefficient", 0.4);
        case["bodies"]["rail"]["radius_y"] = json!(crown);
        case["bodies"]["wheel"]["radius_y"] = json!(tread);
        case["mech"]["resolution"] = json!(4);
        let run = run(&case);
        let power = SPEED * -run.number("creepage_xi") * 0.4 * 134e3;
        assert_close(run.integral("pressure"), 134e3, ROUNDING);
        assert_close(run.integral("friction_power"), power, ROUNDING);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Force to creep and back to force. Tolerance: rounding of √(1 − r), whose slope near the
    /// limit is limited by the range.
    #[test]
    fn force_to_creep_to_force(mu in 1e-9..0.59f64, sign in prop::bool::ANY) {
        let mu = if sign { mu } else { -mu };
        let first = run(&driven(paper(), "traction_coefficient", mu));
        let again = run(&driven(paper(), "creepage", first.number("creepage_xi")));
        assert_close(again.number("traction_coefficient"), mu, 1e-13);
        let force = first.number("creep_force_x_n");
        let by_force = run(&driven(paper(), "tangential_force", force));
        assert_close(by_force.number("creepage_xi"), first.number("creepage_xi"), 1e-13);
    }

    /// Changing the units of length, force and time changes figures by powers of the factors only.
    /// Tolerance: rounding.
    #[test]
    fn independent_of_the_units(
        length in 1e-3..1e3f64, force in 1e-3..1e3f64, time in 1e-3..1e3f64, mu in 0.01..0.59f64,
    ) {
        let case = driven(paper(), "traction_coefficient", mu);
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
            ("approach_m", length),
            ("max_pressure_pa", pressure),
            ("creepage_xi", 1.0),
            ("friction_power_w", force * length / time),
        ] {
            assert_close(other.number(key), factor * one.number(key), 1e-12);
        }
        let largest = one.fields["friction_power"].iter().copied().fold(0.0, f64::max);
        for (a, b) in one.fields["friction_power"].iter().zip(&other.fields["friction_power"]) {
            // Rounding at the very edge, where u = 1 + x/a_y loses digits.
            prop_assert!((b / (pressure * length / time) - a).abs() < 1e-10 * largest);
        }
    }
}
