//! What is hardly so is told, and an error with `--strict`.

use crate::harness::{Place, case, sets};

/// A wheel of 420 m is told before it runs, in the summary and on the page; with `--strict` nothing runs.
#[test]
fn a_mistyped_radius_is_told() {
    let file = case("wheel-rail.toml");
    let set = ["--set", "bodies.wheel.radius_x=420", "--set", "mech.model=hertz-carter"];
    let words = "bodies.wheel.radius_x is 420 m, at most 50 m is expected";
    let place = Place::new();
    let checked = place.start(&[&["check", &file][..], &set].concat()).wait();
    assert_eq!(checked.code, Some(0), "{}", checked.stderr);
    assert!(checked.stdout.contains(words), "{}", checked.stdout);
    let out = place.out().display().to_string();
    let run = |more: &[&str]| {
        place.start(&[&["run", &file, "--report", "--out", &out][..], &set, more].concat()).wait()
    };
    let strict = run(&["--strict"]);
    assert_eq!(strict.code, Some(2), "{}", strict.stdout);
    assert!(strict.stderr.contains(words) && !place.out().exists(), "{}", strict.stderr);
    let told = run(&[]);
    assert_eq!(told.code, Some(0), "{}", told.stderr);
    assert!(told.stdout.contains(words), "{}", told.stdout);
    let summary: serde_json::Value =
        serde_json::from_slice(&std::fs::read(place.out().join("summary.json")).unwrap()).unwrap();
    assert_eq!(summary["warnings"][0]["key"], "bodies.wheel.radius_x");
    let page = std::fs::read_to_string(place.out().join("report.html")).unwrap();
    assert!(page.contains(words));
}

/// What the material and the elements bear is told: a rail of 500 MPa under the paper's traction flows in every passage, as p₀/k is 1/0.58
/// of the limit at most; three elements in a semi-axis are a guess.
#[test]
fn what_a_material_or_a_grid_does_not_bear_is_told() {
    let of = |settings: &[&str]| Place::new().summary(&case("wheel-rail.toml"), &sets(settings));
    let summary = of(&["materials.steel.yield_stress=500 MPa", "mech.resolution=3"]);
    let keys: Vec<_> =
        summary["warnings"].as_array().unwrap().iter().map(|one| &one["key"]).collect();
    assert_eq!(keys, ["contact.shakedown_ratio", "contact.elements_across"]);
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

/// An answer beyond what is expected is told at the end, and with `--strict` an error; a usual one is not.
#[test]
fn a_hot_answer_is_told() {
    let run = |name: &str| {
        let place = Place::new();
        let out = place.out().display().to_string();
        place.start(&["run", &case(name), "--strict", "--out", &out]).wait()
    };
    let hot = run("locked-wheel.toml");
    assert_eq!(hot.code, Some(2), "{}", hot.stdout);
    assert!(hot.stderr.contains("max_rise_k is 711.4"), "{}", hot.stderr);
    assert_eq!(run("wheel-rail.toml").code, Some(0));
}
