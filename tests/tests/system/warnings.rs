//! What is hardly so is told, and an error with `--strict`.

use crate::harness::{Place, case};

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
