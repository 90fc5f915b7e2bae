//! Warnings about unintended settings and implausible values. The target `system` tests that they
//! reach every command.

use crate::harness::{Place, case, flat, fleet, planned, sets};
use run::warnings::Warning;

/// Warnings of a plan.
fn warnings(name: &str, settings: &[&str]) -> Vec<Warning> {
    let planned = planned(&case(name), &sets(settings), &mut fleet());
    planned.unwrap_or_else(|error| panic!("{error}")).plan.warnings
}

/// The same, as text on one line.
fn told(name: &str, settings: &[&str]) -> Vec<String> {
    warnings(name, settings).iter().map(|warning| flat(&warning.to_string())).collect()
}

/// Warnings about material and grid: a rail of 500 MPa flows in every passage under the paper's
/// traction, because its limit p₀/k is at most 1/0.58; three elements per semi-axis are too coarse,
/// for the contact and for its slip zone.
#[test]
fn what_a_material_or_a_grid_does_not_bear_is_told() {
    let of = |settings: &[&str]| Place::new().summary(&case("wheel-rail.toml"), &sets(settings));
    let summary = of(&["materials.steel.yield_stress=500 MPa", "mech.resolution=3"]);
    let keys: Vec<_> =
        summary["warnings"].as_array().unwrap().iter().map(|one| &one["key"]).collect();
    let coarse = ["contact.elements_across", "contact.slip_zone_elements"];
    assert_eq!(keys, ["contact.shakedown_ratio", coarse[0], coarse[1]]);
    let figure = |name: &str| summary["contact"][name].as_f64().unwrap();
    let expected = figure("max_pressure_pa") / (500e6 / 3.0_f64.sqrt());
    let (ratio, limit) = (figure("pressure_over_shear_strength"), 1.0 / 0.58);
    assert!((ratio / expected - 1.0).abs() < 1e-12, "{ratio} {expected}");
    assert!((figure("shakedown_ratio") * limit / ratio - 1.0).abs() < 1e-6);
    let usual = of(&[
        "mech.model=hertz-carter",
        "materials.steel.yield_stress=1200 MPa",
        "motion.traction_coefficient=0.1",
    ]);
    assert_eq!(usual.get("warnings"), None, "{}", usual["warnings"]);
    assert!(usual["contact"]["shakedown_ratio"].as_f64().unwrap() < 1.0);
}

#[test]
fn keys_that_an_option_replaces_are_told() {
    let settings = ["mech.model=hertz-carter", "motion.creepage.xi=-0.002"];
    let words = "motion.traction_coefficient: --set motion.creepage.xi=-0.002 replaces it";
    assert!(told("wheel-rail.toml", &settings).iter().any(|warning| warning.contains(words)));
}

/// A single warning names all keys without effect, and the models or effects that would read them.
#[test]
fn keys_that_nothing_reads_are_told() {
    let settings = ["mech.resolution=10", "load.normal_force=5e4", "mech.slope_factor=0.3"];
    let told = told("wheel-on-track.toml", &settings);
    let [warning] = told.as_slice() else { panic!("{told:?}") };
    let words = "load.normal_force, mech.slope_factor: nothing in this case reads them: they have \
                 no effect";
    assert!(warning.contains(words), "{warning}");
    assert!(warning.contains("mech.model = \"half-space\""), "{warning}");
}

/// A load of 300 kN for a millisecond, between the middles of two windows, gives a warning. The
/// advised window sees it.
#[test]
fn a_peak_between_two_windows_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("load.csv");
    std::fs::write(&table, "t [s],Q [kN]\n0,100\n0.0115,100\n0.012,300\n0.0125,100\n0.04,100\n")
        .unwrap();
    let column =
        |name: &str| format!("{{ file = {:?}, column = {name:?} }}", table.display().to_string());
    let settings = [
        format!("load.normal_force={}", column("Q")),
        format!("time.history={}", column("t")),
        "time.end=40 ms".to_owned(),
    ];
    let warned = |window: &str| {
        let window = format!("time.window={window}");
        let words: Vec<&str> = settings.iter().map(String::as_str).chain([&*window]).collect();
        warnings("cold-start.toml", &words)
    };
    let told = warned("4 ms");
    let [Warning::Remark(warning)] = told.as_slice() else { panic!("{told:?}") };
    assert_eq!(warning.key, "load.normal_force");
    let reason = &warning.reason;
    assert!(
        reason.contains("reaches 300000 N at 0.012 s") && reason.contains("100000 N"),
        "{reason}"
    );
    let advised = warning.fix.split('"').nth(1).unwrap();
    assert_eq!(warned(advised), [], "{advised}");
}
