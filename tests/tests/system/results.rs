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

/// Figs. 5 to 7 of the paper: traction along the centre line, at the bound f p in the slip zone at
/// the trailing edge, and below it in the stick zone, where there is no slip.
#[test]
fn the_centre_line_shows_traction_and_slip() {
    let place = Place::new();
    place.summary(&case("wheel-rail.toml"), &["--set", "motion.traction_coefficient=0.4"]);
    let contact = place.table("fields/mech_contact_000000.csv");
    let [x, p, t] = ["x [m]", "pressure [Pa]", "traction_x [Pa]"].map(|name| contact.numbers(name));
    let slip = place.table("fields/mech_passage_000000.csv").numbers("slip_velocity_x [m/s]");
    assert_eq!(x.len(), 83);
    let touching: Vec<usize> = (0..x.len()).filter(|&i| p[i] > 0.0).collect();
    let slips = |i: usize| t[i] > 0.6 * p[i] * (1.0 - 1e-9);
    let border = touching.iter().position(|&i| !slips(i)).unwrap();
    assert!(border > 10 && border < 70, "{border}");
    // The bound of the leading element is so small that it may slip too.
    for (k, &i) in touching[..touching.len() - 1].iter().enumerate() {
        assert_eq!(slips(i), k < border, "{i}");
        // The slip in the stick zone is limited by the tolerance of the iteration.
        assert!(if k < border { slip[i] < 0.0 } else { slip[i].abs() < 1e-4 }, "{}", slip[i]);
    }
}

/// The stored case reproduces the results.
#[test]
fn the_case_as_run_can_be_run() {
    let (first, second) = (Place::new(), Place::new());
    let set = ["--set", "motion.traction_coefficient=0.4", "--set", "mech.resolution=10"];
    let one = first.summary(&case("wheel-rail.toml"), &set);
    let two = second.summary(&first.out().join("case.toml").display().to_string(), &[]);
    for part in ["contact", "temperature", "effects"] {
        assert_eq!(one[part], two[part]);
    }
}

#[test]
fn a_transient_run_writes_a_series() {
    let place = Place::new();
    place.summary(&case("cold-start.toml"), &[]);
    let series = std::fs::read_to_string(place.out().join("fields/thermal_contact.pvd")).unwrap();
    // Every tenth of 51 windows, and the last one.
    assert_eq!(series.matches("<DataSet").count(), 6, "{series}");
    assert!(series.contains("thermal_contact_000050.vti"));
    let table = std::fs::read_to_string(place.out().join("iterations.csv")).unwrap();
    assert_eq!(table.lines().count(), 52);
}

/// A row for every window; the last row equals the summary.
#[test]
fn every_window_leaves_its_figures() {
    let place = Place::new();
    let summary = place.summary(&case("cold-start.toml"), &[]);
    let history = place.table("history.csv");
    assert_eq!(history.rows.len(), 51);
    assert_eq!(history.head[..5], ["window", "start_s", "end_s", "status", "iterations"]);
    let last = history.rows.last().unwrap();
    assert_eq!(last[3], "completed");
    for (key, cell) in history.head.iter().zip(last).skip(5) {
        let found = summary.pointer(&format!("/{}", key.replace('.', "/")));
        let expected = found.map(|value| value.as_f64().unwrap());
        assert_eq!(cell.parse().ok(), expected, "{key}");
    }
    // No column is empty.
    for name in &history.head {
        assert!(history.texts(name).iter().any(|cell| !cell.is_empty()), "{name}");
    }
    let rise = history.numbers("temperature.rail.max_rise_k");
    // The rise increases until the field is steady; later changes are rounding.
    assert!(rise[..15].is_sorted() && rise[0] < 0.5 * rise[50], "{rise:?}");
}

/// A participant that describes no figures is not asked for any.
#[test]
fn a_run_without_figures_has_a_history_of_its_windows() {
    let place = Place::new();
    place.summary(&case("exchange.toml"), &["--set", "time.end=10"]);
    let history = place.table("history.csv");
    assert_eq!((history.head.len(), history.rows.len()), (5, 10));
}

/// A quantity that a model does not provide is absent, never 0.
#[test]
fn absent_is_not_zero() {
    let place = Place::new();
    let summary = place.summary(&case("full-slip.toml"), &[]);
    let contact = summary["contact"].as_object().unwrap();
    assert!(!contact.contains_key("approach_m"), "the patch is given: no approach is known");
    assert!(!contact.contains_key("spin_moment_nm"));
    assert!(contact.contains_key("slip_area_ratio"));
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
fn a_name_cannot_lead_out_of_the_results() {
    for name in ["../../evil", "/tmp/abs", "a/b", "", "x\\ny", ".hidden"] {
        let place = Place::new();
        let set = format!("case.name=\"{name}\"");
        let ended = place.start(&["run", &case("exchange.toml"), "--set", &set]).wait();
        assert_refused(&ended, "case.name: ");
    }
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
    let more = ["--quiet", "--log", "trace", "--set", "left.command=[\"rogue\"]"];
    let ended = place.run(&case("exchange.toml"), &[&more[..], &["--set", "time.end=3"]].concat());
    assert_eq!((ended.stdout.as_str(), ended.stderr.as_str()), ("", ""));
}

/// The cost accounts for the whole time of a run: all parts are present, and none exceeds the
/// total.
#[test]
fn the_cost_has_all_its_parts() {
    let place = Place::new();
    let summary = place.summary(&case("exchange.toml"), &["--set", "time.end=100"]);
    let cost = |key: &str| summary["cost"][key].as_f64().unwrap_or_else(|| panic!("no {key}"));
    let parts = ["plan_s", "start_s", "coupling_s", "output_s", "finish_s"].map(cost);
    assert!(parts.iter().all(|part| *part > 0.0), "{}", summary["cost"]);
    assert!(parts.iter().sum::<f64>() <= cost("wall_s"), "{}", summary["cost"]);
}
