//! Unintended settings and implausible values produce a warning in every command, and an error with
//! `--strict`.

use crate::harness::{Place, case, flat, sets};
use serde_json::Value;

/// A wheel of 420 m produces a warning before the run, in the summary and on the page; with
/// `--strict` nothing runs.
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

/// An implausible result produces a warning at the end, and an error with `--strict`; a usual one
/// does not.
#[test]
fn a_hot_answer_is_told() {
    let run = |name: &str, settings: &[&str]| {
        let place = Place::new();
        let out = place.out().display().to_string();
        let arguments = ["run", &case(name), "--strict", "--out", &out];
        place.start(&[&arguments[..], &sets(settings)].concat()).wait()
    };
    let hot = run("locked-wheel.toml", &["friction.coefficient=0.2"]);
    assert_eq!(hot.code, Some(5), "{}", hot.stdout);
    assert!(
        hot.stderr.contains("the run has finished, and its results are complete"),
        "{}",
        hot.stderr
    );
    assert!(hot.stderr.contains("max_rise_k is 12"), "{}", hot.stderr);
    assert_eq!(run("wheel-rail.toml", &[]).code, Some(0));
}

/// A run that is resumed is judged before it starts, like a new one.
#[test]
fn a_resumed_run_is_refused_for_the_warnings_of_its_case() {
    let place = Place::new();
    let fault = ["right.fault=not-finite", "right.fault_window=3"];
    let set = [&["coupling.relative=2", "output.checkpoint_every=1"], &fault[..]].concat();
    let failed = place.run(&case("exchange.toml"), &sets(&set));
    assert_eq!(failed.code, Some(1), "{}", failed.stderr);
    let out = place.out().display().to_string();
    let strict = place.start(&["run", "--resume", &out, "--strict"]).wait();
    assert_eq!(strict.code, Some(2), "{}", strict.stderr);
    assert!(strict.stderr.contains("coupling.relative is 2"), "{}", strict.stderr);
    let resumed = place.start(&["run", "--resume", &out]).wait();
    assert_eq!(resumed.code, Some(1), "{}", resumed.stderr);
    assert!(resumed.stderr.contains("coupling.relative is 2"), "{}", resumed.stderr);
}

/// A warning appears in every command: `check`, as text and as JSON, `plan`, `run`, the summary,
/// the page, the log, and with `--strict`.
fn reaches_everybody(name: &str, settings: &[&str], key: &str, words: &str) {
    let (file, set, place) = (case(name), sets(settings), Place::new());
    let out = place.out().display().to_string();
    let said = |before: &[&str], after: &[&str]| {
        place.start(&[before, &[&file], &set[..], after].concat()).wait()
    };
    let words_in = |text: &str| flat(text).contains(words);
    let checked = said(&["check"], &[]);
    assert_eq!(checked.code, Some(0), "{}", checked.stderr);
    assert!(words_in(&checked.stdout), "check: {}", checked.stdout);
    let json: Value = serde_json::from_str(&said(&["check"], &["--json"]).stdout).unwrap();
    let found = json["warnings"].as_array().unwrap().iter().find(|one| one["key"] == key);
    let found = found.unwrap_or_else(|| panic!("{json}"));
    assert!(words.contains(found["reason"].as_str().unwrap()), "{found}");
    assert!(found["place"] != "" && found["fix"] != "", "{found}");
    let planned = said(&["plan"], &[]).stdout;
    assert!(words_in(&planned), "plan: {planned}");
    let strict = said(&["run"], &["--strict", "--out", &out]);
    assert_eq!(strict.code, Some(2), "{}", strict.stdout);
    assert!(words_in(&strict.stderr) && !place.out().exists(), "strict: {}", strict.stderr);
    let run = said(&["run"], &["--report", "--out", &out]);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert!(words_in(&run.stdout) && words_in(&run.stderr), "{} {}", run.stdout, run.stderr);
    let summary = place.read_summary();
    assert!(summary["warnings"].as_array().unwrap().iter().any(|one| one["key"] == key));
    let told = |event: &Value| words_in(event["fields"]["message"].as_str().unwrap_or_default());
    assert!(place.log().iter().any(told), "log");
}

#[test]
fn a_mapping_that_does_not_bound_a_density_is_told() {
    let settings =
        ["mech.resolution=10", "thermal.resolution=29", "mapping.method=nearest-neighbour"];
    let words = "mapping.method: `friction_power` is mapped for thermal by nearest-neighbour, which \
                 conserves the integral but does not bound the density";
    reaches_everybody("wheel-rail.toml", &settings, "mapping.method", words);
}

/// A study that varies a key without effect would repeat the same run, and is rejected.
#[test]
fn a_study_does_not_vary_what_nothing_reads() {
    let refused = |arguments: &[&str], told: &str| {
        let place = Place::new();
        let out = place.out().display().to_string();
        let ended = place.start(&[arguments, &["--out", &out]].concat()).wait();
        assert_eq!(ended.code, Some(2), "{} {}", ended.stdout, ended.stderr);
        assert!(ended.stderr.contains(told), "{}", ended.stderr);
        assert!(!place.out().exists());
    };
    let told = "--start bodies.rail.start_rise: nothing in this case reads it";
    let falling = case("falling-friction.toml");
    refused(&["states", &falling, "--start", "bodies.rail.start_rise=0..330/4"], told);
    let told = "--vary mech.slope_factor: nothing in this case reads it";
    let track = case("wheel-on-track.toml");
    refused(&["sweep", &track, "--vary", "mech.slope_factor=0.1,0.2"], told);
    // Some of the models read the key.
    let place = Place::new();
    let out = place.out().display().to_string();
    let file = case("wheel-rail.toml");
    let vary = ["--vary", "mech.model=hertz-carter,fastsim", "--vary", "mech.slope_factor=0.5,1"];
    let sweep = [&["sweep", &file, "--set", "mech.resolution=8"], &vary[..], &["--out", &out]];
    let ended = place.start(&sweep.concat()).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
}
