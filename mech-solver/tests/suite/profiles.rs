//! Contacts of measured profiles: every touching place is found and resolved, corners are kept, and
//! mirrored shapes touch in mirrored places.

use super::common::{HEAVY, Run, STEEL, assert_close, configuration, paper, run};
use elastic::hertz::{EllipticContact, elliptic_contact};
use mech_solver::MechSolver;
use proto::model::Solver;
use serde_json::{Value, json};
use std::path::PathBuf;

/// A profile in a temporary file, removed on drop.
struct File(PathBuf);

impl File {
    /// Creates a profile with a point every `spacing` [m] over ± `end` [m].
    fn new(name: &str, end: f64, spacing: f64, height: impl Fn(f64) -> f64) -> Self {
        let count = (end / spacing).round() as i32;
        let points = (-count..=count).map(|k| f64::from(k) * spacing);
        let lines = points.map(|y| format!("{y:.9},{:.12}\n", height(y)));
        let text = format!("y [m], z [m]\n{}", lines.collect::<String>());
        let path = std::env::temp_dir().join(format!("profiles-{}-{name}.csv", std::process::id()));
        std::fs::write(&path, text).expect("a writable folder");
        Self(path)
    }
}

impl Drop for File {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// A straight wheel on this rail, without friction.
fn on_rail(rail: &File, force: f64, resolution: usize) -> Value {
    let mut case = paper();
    case["bodies"]["rail"] = json!({"position": "lower", "profile": rail.0, "material": "steel"});
    case["motion"] = json!({"speed": 38.889, "creepage": {"xi": 0.0}});
    case["load"]["normal_force"] = json!(force);
    case["mech"] = json!({"model": "half-space", "resolution": resolution});
    case["effects"] = json!({"friction_heat": {}});
    case
}

fn hertz(crown: f64, force: f64) -> EllipticContact {
    elliptic_contact(0.5 / 0.46, 0.5 / crown, force, STEEL)
}

fn patches(run: &Run) -> Vec<Value> {
    run.contact["each_patch"].as_array().cloned().unwrap_or_default()
}

fn of(patch: &Value, key: &str) -> f64 {
    patch[key].as_f64().unwrap_or_else(|| panic!("{key}: {patch}"))
}

/// Checks that the pressure equals its mirror image to `tolerance` of the maximum.
fn assert_symmetric(run: &Run, tolerance: f64) {
    let pressure = &run.fields["pressure"];
    let grid = run.grid().as_structured().expect("a plane contact");
    let largest = pressure.iter().copied().fold(0.0, f64::max);
    assert!((grid.y(0) + grid.y(grid.nj - 1)).abs() < 1e-6 * grid.dy(), "{grid:?}");
    for j in 0..grid.nj {
        for i in 0..grid.ni {
            let [one, other] = [j, grid.nj - 1 - j].map(|j| pressure[j * grid.ni + i]);
            assert!((one - other).abs() < tolerance * largest, "{i} {j}: {one:e} {other:e}");
        }
    }
}

/// Two crowns of 300 mm at ±20 mm carry half of the load each, with Hertz's pressure, even under
/// the lightest load. Tolerances: 1 % for the grid, whose elements lie differently on both crowns
/// and on a single one, and the displacement by the other patch.
#[test]
fn two_equal_crowns_carry_half_each() {
    let rail = File::new("crowns", 36e-3, 0.5e-3, |y| -0.5 * (y.abs() - 20e-3).powi(2) / 0.3);
    for force in [5.0, 50.0, 500.0] {
        let run = run(&on_rail(&rail, force, 10));
        assert_eq!(run.number("patches"), 2.0, "{force} N");
        let half = hertz(0.3, 0.5 * force);
        assert_close(run.number("max_pressure_pa"), half.max_pressure, 1e-2);
        assert_close(run.number("normal_force_n"), force, 1e-9);
        for (patch, place) in patches(&run).iter().zip([-20e-3, 20e-3]) {
            assert_close(of(patch, "normal_force_n"), 0.5 * force, 1e-6);
            assert_close(of(patch, "max_pressure_pa"), half.max_pressure, 1e-2);
            assert_close(of(patch, "semi_axis_a_m"), half.semi_axis_a, 1e-2);
            assert_close(of(patch, "semi_axis_b_m"), half.semi_axis_b, 1e-2);
            assert!((of(patch, "y_m") - place).abs() < 0.02 * half.semi_axis_b, "{patch}");
        }
        assert_symmetric(&run, 1e-6);
    }
}

/// Touching places too far apart for the coarse grid are refused, instead of losing one.
#[test]
fn crowns_too_far_apart_for_a_grid_are_refused() {
    let rail = File::new("far", 36e-3, 0.5e-3, |y| -0.5 * (y.abs() - 20e-3).powi(2) / 0.3);
    let refused = super::common::refusal(&configuration(&on_rail(&rail, 1e-4, 10)));
    assert_eq!(refused.key, "bodies.rail.profile");
    assert!(refused.reason.contains("also touch 20.0"), "{refused}");
}

/// A flat railhead of 40 mm with edges falling off at 1:20 carries a straight wheel over its whole
/// width. In the middle it is a line contact, minus the 7 % of the load carried by its ends. Both
/// sides are equal, and no bump of the interpolation carries load.
#[test]
fn a_flat_rail_with_edges_is_flat() {
    let rail = File::new("edges", 36e-3, 1e-3, |y| -0.05 * (y.abs() - 20e-3).max(0.0));
    let light = run(&on_rail(&rail, 50.0, 6));
    assert_eq!(light.number("patches"), 1.0, "bumps of the interpolation alone would be two");
    assert_symmetric(&light, 1e-6);
    let case = on_rail(&rail, 20e3, 6);
    let run = run(&case);
    assert_eq!(run.number("patches"), 1.0);
    let grid = *run.grid().as_structured().expect("a plane contact");
    let pressure = &run.fields["pressure"];
    let middle = pressure[grid.nj / 2 * grid.ni..][..grid.ni].iter().copied().fold(0.0, f64::max);
    // Johnson, eq. 4.45: p0² = P' E*/(π R), with the load P' per metre.
    let line = (20e3 / 40e-3 / (std::f64::consts::PI * 0.46 * STEEL)).sqrt();
    assert_close(middle, 0.93 * line, 0.02);
    assert_symmetric(&run, 1e-6);
    let kinks = run.contact["kinks_in_contact_y_m"].as_array().expect("both edges");
    let kinks: Vec<f64> = kinks.iter().filter_map(Value::as_f64).collect();
    assert!((kinks[0] + 20e-3).abs() < 1e-9 && (kinks[1] - 20e-3).abs() < 1e-9, "{kinks:?}");
    let remarks = MechSolver.configure(&configuration(&case)).expect("a good case");
    let remarks = remarks.layout().remarks.join("\n");
    assert!(remarks.contains("splines end at the kinks at y = -20.000, 20.000 mm"), "{remarks}");
    assert!(remarks.contains("the contact reaches kinks"), "{remarks}");
}

/// A crown of 2 mm radius beside one of 300 mm: each patch has Hertz's pressure for its load, and
/// the narrow one at least ten rows. Tolerance: that of a patch of a dozen rows.
#[test]
fn a_narrow_patch_is_resolved() {
    let heights = |y: f64| {
        let wide = -0.5 * (y + 15e-3).powi(2) / 0.3;
        let narrow = 10e-6 - 0.5 * (y - 15e-3).powi(2) / 2e-3;
        wide.max(narrow)
    };
    let rail = File::new("narrow", 30e-3, 0.1e-3, heights);
    let check = |case: &Value, least: f64| {
        let run = run(case);
        let patches = patches(&run);
        assert_eq!(patches.len(), 2, "{}", run.contact);
        for (patch, crown) in patches.iter().zip([0.3, 2e-3]) {
            let load = of(patch, "normal_force_n");
            assert_close(of(patch, "max_pressure_pa"), hertz(crown, load).max_pressure, 0.03);
            assert!(of(patch, "rows") >= least, "{patch}");
        }
    };
    let mut case = on_rail(&rail, 2e3, 10);
    check(&case, 10.0);
    case["mech"]["lateral_resolution"] = json!(10);
    check(&case, 20.0);
}

/// A smoothing tolerance requires a profile, and removes its noise.
#[test]
fn smoothing_by_a_stated_tolerance() {
    let mut case = paper();
    case["mech"] = json!({"model": "half-space"});
    case["bodies"]["wheel"]["profile_tolerance"] = json!(1e-6);
    assert_eq!(super::common::refusal(&configuration(&case)).key, "bodies.wheel.profile_tolerance");
    let noise = |y: f64| 1e-6 * (1e6 * y * y + 7e4 * y).sin();
    let rail = File::new("noisy", 30e-3, 0.25e-3, |y| -0.5 * y * y / 0.3 + noise(y));
    let mut case = on_rail(&rail, 20e3, 10);
    let rough = run(&case);
    case["bodies"]["rail"]["profile_tolerance"] = json!(1.5e-6);
    let smooth = run(&case);
    let exact = hertz(0.3, 20e3).max_pressure;
    let error = |run: &Run| (run.number("max_pressure_pa") / exact - 1.0).abs();
    assert!(error(&rough) > 0.1 && error(&smooth) < 0.03, "{} {}", error(&rough), error(&smooth));
    let remarks = MechSolver.configure(&configuration(&case)).expect("a good case");
    assert!(remarks.layout().remarks.iter().any(|remark| remark.contains("smoothed by at most")));
}

/// Subsurface sections lie below the patch with the highest pressure unless the case gives their
/// position, and the friction power is announced there.
#[test]
fn sections_go_through_the_highest_pressure() {
    let heights = |y: f64| -0.5 * (y.abs() - 15e-3).powi(2) / if y > 0.0 { 0.1 } else { 0.3 };
    let rail = File::new("sections", 30e-3, 0.5e-3, heights);
    let mut case = on_rail(&rail, 5e3, 10);
    case["effects"]["subsurface_stress"] = json!({});
    let section = |case: &Value| {
        let mut configuration = configuration(case);
        configuration.observed = vec!["lower_section_von_mises_stress".to_owned()];
        let layout = MechSolver.configure(&configuration).expect("a good case").layout().clone();
        let grid = layout.grid_of("lower_section_von_mises_stress").expect("it is asked for");
        (grid.as_structured().expect("a plane").origin[1], layout.peaks["friction_power"][1])
    };
    let run = run(&case);
    let steep = patches(&run)[1].clone();
    let (y, peak) = section(&case);
    assert!((y - of(&steep, "y_m")).abs() < 0.3 * of(&steep, "semi_axis_b_m"), "{y} {steep}");
    assert_eq!(y, peak);
    case["effects"]["subsurface_stress"]["y"] = json!(-1e-3);
    assert_eq!(section(&case).0, -1e-3);
}

/// Case of explicit elements with a creepage.
fn of_elements(rail: Value, resolution: usize) -> Value {
    let mut case = paper();
    case["bodies"]["rail"] = rail;
    case["motion"] = json!({"speed": 38.889, "creepage": {"xi": -3e-3}});
    case["mech"] = json!({"model": "explicit-fe", "resolution": resolution});
    case["materials"]["steel"]["density"] = json!(HEAVY);
    case
}

/// A measured crown gives the elements of a crown given by its radius. Tolerance: slightly
/// different mesh sizes, as the contact of a profile is located on a grid.
#[test]
fn elements_of_a_measured_crown() {
    let crown = File::new("crown", 0.15, 1e-3, |y| (0.3_f64 * 0.3 - y * y).sqrt() - 0.3);
    let measured = json!({"position": "lower", "profile": crown.0, "material": "steel"});
    let given = json!({"position": "lower", "radius_y": 0.3, "material": "steel"});
    let [measured, given] = [measured, given].map(|rail| run(&of_elements(rail, 3)));
    for (key, tolerance) in [
        ("max_pressure_pa", 0.01),
        ("approach_m", 0.02),
        ("creep_force_x_n", 0.01),
        ("friction_power_w", 0.03),
    ] {
        println!("{key}: {:.6e} {:.6e}", measured.number(key), given.number(key));
        assert_close(measured.number(key), given.number(key), tolerance);
    }
    assert!(measured.number("creep_force_y_n").abs() < 0.01 * given.number("creep_force_x_n"));
}

/// Two crowns at ±10 mm, one of them 10 µm lower: elements distribute the load between them like
/// half-spaces. Tolerance relative to the load: three elements per semi-axis.
#[test]
fn elements_share_a_load_between_two_patches() {
    let crowns = |y: f64| -0.5 * (y.abs() - 0.01).powi(2) / 0.1 - if y > 0.0 { 1e-5 } else { 0.0 };
    let rail = File::new("two-crowns", 0.06, 0.5e-3, crowns);
    let rail = json!({"position": "lower", "profile": rail.0, "material": "steel"});
    let elements = run(&of_elements(rail.clone(), 3));
    let mut case = of_elements(rail, 10);
    case["mech"]["model"] = json!("half-space");
    let exact = run(&case);
    let share = |run: &Run| {
        let patches = patches(run);
        assert_eq!(patches.len(), 2, "{:?}", run.contact);
        of(&patches[0], "normal_force_n") / run.number("normal_force_n")
    };
    let (one, other) = (share(&elements), share(&exact));
    println!("{one:.4} of the load, half-spaces {other:.4}");
    assert!((one - other).abs() < 0.02 && one > 0.52, "{one} {other}");
}
