//! Advice of warnings, applied: the problem it is given for is gone.

use super::common::{Run, STEEL, assert_close, configuration, driven, fitted, paper, run};
use super::half_space_model::InTime;
use elastic::hertz::elliptic_contact;
use mech_solver::MechSolver;
use proto::figure::value;
use proto::model::Solver;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;

/// Keys of the figures of a contact that are not as expected.
fn unexpected(run: &Run) -> Vec<String> {
    let summary = json!({ "contact": run.contact });
    let figures = MechSolver.description().figures.into_iter();
    let passed = figures.filter(|figure| {
        let found = figure.plausible.as_ref().zip(value(&summary, &figure.key));
        found.is_some_and(|(expected, value)| expected.bound_passed(value).is_some())
    });
    passed.map(|figure| figure.key).collect()
}

/// The paper's case by a model, on elements of a/`resolution`.
fn of_model(model: &str, resolution: usize) -> Value {
    let mut case = fitted(paper(), model);
    case["mech"]["resolution"] = json!(resolution);
    case
}

/// A slip zone of few elements gives a warning. The advised resolution resolves it. A contact of
/// which most slides has no such warning, and one that slides everywhere has no such figure.
#[test]
fn a_narrow_slip_zone_is_resolved_by_the_advised_resolution() {
    let key = "contact.slip_zone_elements";
    for (model, traction, resolutions) in [
        ("half-space", 0.2, [7, 20]),
        ("half-space", 0.1, [7, 20]),
        ("hertz-carter", 0.1, [20, 80]),
        ("fastsim", 0.1, [20, 80]),
    ] {
        let of = |resolution: usize| {
            run(&driven(of_model(model, resolution), "traction_coefficient", traction))
        };
        let [coarse, fine] = resolutions.map(of);
        assert_eq!(unexpected(&coarse), [key], "{model} {traction}");
        assert!(unexpected(&fine).is_empty(), "{model} {traction}: {}", fine.contact);
        // The width follows the elements. The tolerance covers half an element at either edge.
        let [few, many] = [&coarse, &fine].map(|run| run.number("slip_zone_elements"));
        let ratio = resolutions[1] as f64 / resolutions[0] as f64;
        assert!((many - ratio * few).abs() < ratio, "{model} {traction}: {few} {many}");
    }
    assert!(unexpected(&run(&of_model("half-space", 20))).is_empty());
    for model in ["half-space", "hertz-carter", "fastsim"] {
        let sliding = run(&driven(of_model(model, 20), "creepage", -0.04));
        assert_eq!(sliding.contact.get("slip_zone_elements"), None, "{}", sliding.contact);
    }
}

/// Half-spaces have n elements per semi-axis, n/2 or more across the slip zone of a longitudinal
/// creepage, and n or more across that of lateral creepage and spin. The bounds are the errors of
/// the estimate by strips, and half an element at either edge.
#[test]
fn elements_follow_the_slip_zone() {
    let creepage = |xi: f64, eta: f64, phi: f64| json!({"xi": xi, "eta": eta, "phi": phi});
    let [half, whole] = [5.0..9.0, 10.5..16.5];
    let motions = [
        ("traction_coefficient", json!(0.05), &half),
        ("traction_coefficient", json!(-0.2), &half),
        ("creepage", creepage(-5e-4, 0.0, 0.0), &half),
        ("creepage", creepage(0.0, 1e-3, 0.0), &whole),
        ("creepage", creepage(0.0, 0.0, 0.3), &whole),
        ("creepage", creepage(5e-4, -5e-4, -0.1), &whole),
    ];
    for crown in [0.06, 0.3, 1.5] {
        for (key, motion, bounds) in &motions {
            let mut case = of_model("half-space", 12);
            case["motion"] = json!({"speed": 38.889, *key: motion});
            case["bodies"]["rail"]["radius_y"] = json!(crown);
            let elements = run(&case).number("slip_zone_elements");
            assert!(bounds.contains(&elements), "{crown} {motion}: {elements}");
        }
    }
}

/// A zone too narrow for the grid gives a warning: an element slips, or none does and the width is
/// estimated. Elements do not follow the zone: with the upwind difference, for bodies of different
/// constants, and in transient rolling.
#[test]
fn a_zone_below_an_element_is_not_passed_over() {
    let key = "contact.slip_zone_elements";
    let mut upwind = of_model("half-space", 8);
    upwind["mech"]["difference"] = json!("upwind");
    let mut unlike = of_model("half-space", 8);
    unlike["materials"]["other"] = json!({"youngs_modulus": 205e9, "poisson_ratio": 0.29});
    unlike["bodies"]["rail"]["material"] = json!("other");
    for (name, case) in [("upwind", upwind), ("unlike", unlike)] {
        let stuck = run(&driven(case, "traction_coefficient", 0.005));
        assert_eq!(unexpected(&stuck), [key], "{name}: {}", stuck.contact);
        assert!(stuck.number("slip_zone_elements") <= 1.0, "{name}: {}", stuck.contact);
    }
    let mut case = driven(of_model("half-space", 8), "traction_coefficient", 0.005);
    case["mech"]["rolling"] = json!("transient");
    let mut transient = InTime::new(&case, 1e-4);
    transient.next();
    assert!(transient.number("slip_zone_elements") < 1.0);
}

/// A rough surface and a bound of the pressure have a regular grid, whose elements follow the slip
/// zone like displaced rows.
#[test]
fn elements_of_regular_grids_follow_the_slip_zone() {
    let mut case = driven(of_model("half-space", 12), "traction_coefficient", 0.05);
    case["effects"]["pressure_limit"] = json!({"hardness": 3e9});
    let elements = run(&case).number("slip_zone_elements");
    assert!((5.0..9.0).contains(&elements), "{elements}");
}

/// A grid that is coarse along the motion is refined by one key, one that is coarse across it by
/// the other.
#[test]
fn few_elements_are_refined_by_the_advised_key() {
    let key = "contact.elements_across";
    let of = |changes: &[(&str, usize)]| {
        let mut case = driven(of_model("half-space", 20), "creepage", -0.04);
        changes.iter().for_each(|(key, value)| case["mech"][*key] = json!(value));
        unexpected(&run(&case))
    };
    assert_eq!(of(&[("resolution", 3)]), [key]);
    assert_eq!(of(&[("resolution", 10)]), [""; 0]);
    assert_eq!(of(&[("lateral_resolution", 2)]), [key]);
    assert_eq!(of(&[("lateral_resolution", 6)]), [""; 0]);
}

/// A wheel of 1 m on a rail with a radius of 1 mm: without a key the rows resolve the narrow
/// contact. The tolerance is the error of the pressure on ten rows.
#[test]
fn a_narrow_contact_has_narrow_rows() {
    for crown in [1e-3, 10e-3] {
        let mut case = driven(of_model("half-space", 20), "creepage", -0.04);
        case["bodies"]["wheel"]["radius_x"] = json!(1.0);
        case["bodies"]["rail"]["radius_y"] = json!(crown);
        case["load"]["normal_force"] = json!(100.0);
        let run = run(&case);
        let hertz = elliptic_contact(0.5, 0.5 / crown, 100.0, STEEL);
        assert_close(run.number("max_pressure_pa"), hertz.max_pressure, 1e-2);
        assert!(run.number("elements_across") > 8.0, "{crown} {}", run.contact);
    }
}

/// A file in a temporary folder, removed on drop.
struct File(PathBuf);

impl Drop for File {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// Points of a shipped profile every 0.15 mm along its length, with normal noise of this standard
/// deviation in height [mm].
fn noisy(name: &str, noise: f64, seed: u64) -> File {
    let path = format!("{}/../cases/profiles/{name}.csv", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("a shipped profile");
    let point = |line: &str| {
        let (y, z) = line.split_once(',')?;
        Some([y.trim().parse::<f64>().ok()?, z.trim().parse::<f64>().ok()?])
    };
    let points: Vec<[f64; 2]> = text.lines().filter_map(point).collect();
    let mut state = seed;
    let mut uniform = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut lines = "y [mm], z [mm]\n".to_owned();
    let mut left = 0.0;
    for pair in points.windows(2) {
        let [dy, dz] = [0, 1].map(|axis| pair[1][axis] - pair[0][axis]);
        let length = dy.hypot(dz);
        while left < length {
            let share = left / length;
            let normal = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
            let z = pair[0][1] + share * dz + noise * normal;
            writeln!(lines, "{:.6}, {z:.6}", pair[0][0] + share * dy).expect("a text");
            left += 0.15;
        }
        left -= length;
    }
    let name = format!("noisy-{}-{name}-{seed}-{noise}.csv", std::process::id());
    let file = File(std::env::temp_dir().join(name));
    std::fs::write(&file.0, lines).expect("a writable folder");
    file
}

/// Instruments scatter by micrometres, which doubles the pressure. The advised tolerance, applied
/// once, removes the warning and the noise. The tolerance of 5 % covers noise whose waves are as
/// long as the contact. The tolerance of 12 % is that of the shape: the radii of the rail jump in
/// the contact, which a smoothing by 5 and 10 µm rounds by 7 and 10 %.
#[test]
fn the_advised_smoothing_removes_the_noise() {
    let mut clean = fitted(paper(), "wheel-on-track");
    clean["wheelset"]["yaw"] = json!(0.0);
    clean["mech"]["resolution"] = json!(50);
    clean["effects"] = json!({"friction_heat": {}});
    let pressure = |case: &Value| run(case).number("max_pressure_pa");
    let expected = pressure(&clean);
    for (noise, seed) in [(1e-3, 1), (2e-3, 2)] {
        let files =
            |noise: f64| [noisy("wheel-s1002", noise, seed), noisy("rail-60e1", noise, seed + 10)];
        let (rough, even) = (files(noise), files(0.0));
        let with = |case: &Value, files: &[File; 2]| {
            let mut case = case.clone();
            for (body, file) in ["wheel", "rail"].into_iter().zip(files) {
                case["bodies"][body]["profile"] = json!(file.0);
            }
            case
        };
        let warnings = |case: &Value| {
            MechSolver.configure(&configuration(case)).expect("a case").layout().warnings.clone()
        };
        let raw = pressure(&with(&clean, &rough));
        assert!(raw > 1.5 * expected, "{noise}: {raw} {expected}");
        let told = warnings(&with(&clean, &rough));
        assert_eq!(told.len(), 2, "{told:?}");
        let mut smoothed = clean.clone();
        for (body, warning) in ["wheel", "rail"].into_iter().zip(&told) {
            let advised = warning.fix.split('"').nth(1).expect("a value");
            let (number, unit) = advised.split_once(' ').expect("a unit");
            let key = format!("bodies.{body}.profile_tolerance");
            assert!(warning.fix.contains(&key) && unit == "um", "{warning}");
            let tolerance: f64 = number.parse().expect("a number");
            smoothed["bodies"][body]["profile_tolerance"] = json!(1e-6 * tolerance);
        }
        let rough = with(&smoothed, &rough);
        assert!(warnings(&rough).is_empty(), "{:?}", warnings(&rough));
        assert_close(pressure(&rough), pressure(&with(&smoothed, &even)), 5e-2);
        assert_close(pressure(&rough), expected, 12e-2);
    }
}
