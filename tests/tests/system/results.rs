//! Result folder, as read by other programs.

use crate::harness::{Ended, Place, case, sets, wait_until};
use rustix::process::Signal;
use std::path::Path;

#[test]
fn the_files_of_a_steady_run() {
    let place = Place::new();
    place.summary(&case("wheel-rail.toml"), &[]);
    let out = place.out();
    for name in ["summary.json", "iterations.csv", "case.toml", "log.jsonl"] {
        assert!(out.join(name).is_file(), "{name}");
    }
    let as_run = std::fs::read_to_string(out.join("case.toml")).unwrap();
    assert_eq!(as_run, std::fs::read_to_string(case("wheel-rail.toml")).unwrap());
    let mut fields: Vec<String> = std::fs::read_dir(out.join("fields"))
        .unwrap()
        .flatten()
        .map(|e| e.file_name().into_string().unwrap())
        .collect();
    fields.sort();
    let grids = [
        "mech_contact",
        "mech_passage",
        "thermal_contact",
        "thermal_rail_section",
        "thermal_wheel_section",
    ];
    let files = |grid| [".pvd", "_000000.csv", "_000000.vti"].map(|end| format!("{grid}{end}"));
    let mut expected = grids.map(files).concat();
    expected.extend(["last.bin", "open.py"].map(str::to_owned));
    expected.sort();
    assert_eq!(fields, expected);
}

#[test]
fn quiet_prints_nothing() {
    let place = Place::new();
    let ended = place.run(&case("wheel-rail.toml"), &["--quiet"]);
    assert_eq!((ended.stdout.as_str(), ended.stderr.as_str()), ("", ""));
}

#[test]
fn solvers_lists_every_model_with_its_source() {
    let listed = |more: &[&str]| Place::new().start(&[&["solvers"], more].concat()).wait().stdout;
    let text = listed(&[]);
    for word in ["hertz-carter", "columns", "ertz-knothe", "friction_heat"] {
        assert!(text.contains(word), "`{word}` is missing in:\n{text}");
    }
    let one = listed(&["ertz-knothe"]);
    assert!(one.contains("source: ") && !one.contains("hertz-carter"), "{one}");
}

fn assert_refused(ended: &Ended, part: &str) {
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains(part), "`{part}` is missing in: {}", ended.stderr);
}

/// Starts `run CASE --out OUT` and waits for its end.
fn run_into(place: &Place, case: &Path, out: &Path) -> Ended {
    let (case, out) = (case.display().to_string(), out.display().to_string());
    place.start(&["run", &case, "--out", &out, "--set", "time.end=3"]).wait()
}

#[test]
fn a_run_does_not_touch_the_users_files() {
    let (place, user) = (Place::new(), tempfile::tempdir().unwrap());
    let at = |name: &str| user.path().join(name);
    let text = std::fs::read_to_string(case("exchange.toml")).unwrap();
    std::fs::create_dir(at("fields")).unwrap();
    std::fs::write(at("fields/mine.dat"), "x").unwrap();
    std::fs::write(at("case.toml"), &text).unwrap();
    std::fs::write(at("other.toml"), &text).unwrap();
    let before = || {
        assert_eq!(std::fs::read_to_string(at("case.toml")).unwrap(), text);
        assert_eq!(std::fs::read_to_string(at("fields/mine.dat")).unwrap(), "x");
        assert!(!at("log.jsonl").exists() && !at("summary.json").exists());
    };
    let refused = run_into(&place, &at("case.toml"), user.path());
    assert_refused(&refused, "would replace its own case file");
    before();
    let refused = run_into(&place, &at("other.toml"), user.path());
    assert_refused(&refused, "holds files but no results of a run");
    before();
    let refused = run_into(&place, &at("case.toml"), &at("other.toml"));
    assert_refused(&refused, "is not a directory; give one with --out");
    assert_eq!(std::fs::read_to_string(at("other.toml")).unwrap(), text);
    place.assert_nothing_left();
}

#[test]
fn two_runs_do_not_share_a_folder() {
    let place = Place::new();
    let first = place.start_run(&case("exchange.toml"), &["--set", "left.delay=600"]);
    place.wait_for_log("every participant is ready");
    assert_refused(&place.run(&case("exchange.toml"), &[]), "is used by another run");
    assert!(place.out().join("case.toml").exists(), "the first run's files stay");
    first.signal(Signal::INT);
    assert_eq!(first.wait().code, Some(130));
    place.summary(&case("exchange.toml"), &["--set", "time.end=3"]);
}

/// All files of a killed coordinator are readable, and the next run replaces them.
#[test]
fn a_killed_run_can_be_read() {
    let place = Place::new();
    let more = ["output.fields=all", "output.every=2", "left.delay=0.02"];
    let more = sets(&more);
    let running = place.start_run(&case("exchange.toml"), &more);
    let series = place.out().join("fields/left_numbers.pvd");
    let entries = || -> Vec<String> {
        let text = std::fs::read_to_string(&series).unwrap_or_default();
        let files = text.split("file=\"").skip(1);
        files.filter_map(|rest| Some(rest.split_once('"')?.0.to_owned())).collect()
    };
    wait_until("some output", || entries().len() > 3);
    running.signal(Signal::KILL);
    running.wait();
    let text = std::fs::read_to_string(&series).unwrap();
    assert!(text.ends_with("</VTKFile>\n"), "{text}");
    for file in entries() {
        let image = std::fs::read(place.out().join("fields").join(&file)).unwrap();
        assert!(image.ends_with(b"</VTKFile>\n"), "{file}");
    }
    let table = std::fs::read_to_string(place.out().join("iterations.csv")).unwrap();
    assert!(table.lines().count() > 6, "{table}");
    place.summary(&case("exchange.toml"), &["--set", "time.end=3"]);
    assert!(!place.out().join("fields").exists(), "nothing of the killed run is left");
}

#[test]
fn the_log_level_is_one_of_five_words() {
    let place = Place::new();
    let ended = place.run(&case("exchange.toml"), &["--log", "banana"]);
    assert_refused(&ended, "possible values: error, warn, info, debug, trace");
    assert!(!place.out().exists());
}

#[test]
fn no_colour_reaches_a_file() {
    let place = Place::new();
    let more = ["--log", "info", "--set", "time.end=3"];
    let ended = place.run(&case("exchange.toml"), &more);
    assert!(ended.stderr.contains("INFO"), "{}", ended.stderr);
    assert!(!ended.stderr.contains('\u{1b}'), "{:?}", ended.stderr);
}

#[test]
fn quiet_prints_errors_only() {
    let place = Place::new();
    let more = ["--quiet", "--log", "trace", "--set", "left.command=[\"toy\", \"rogue\"]"];
    let ended = place.run(&case("exchange.toml"), &[&more[..], &["--set", "time.end=3"]].concat());
    assert_eq!((ended.stdout.as_str(), ended.stderr.as_str()), ("", ""));
}
