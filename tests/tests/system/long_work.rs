//! Long work: progress extends deadlines, is displayed, and appears in error messages. Models that
//! cannot rewind.

use crate::harness::python::interpreter;
use crate::harness::{Ended, Place, case, root, sets, toy};

/// Runs the smallest case with [`tests::long`] as `right`.
fn run(settings: &[&str]) -> (Place, Ended) {
    let place = Place::new();
    let long = [
        r#"right={command=["toy", "long"], model="patient"}"#,
        "right.steps=60",
        "time.end=2",
        "coupling.solve_deadline=1",
        "coupling.build_deadline=1",
    ];
    let more = sets(&[&long, settings].concat());
    let ended = place.run(&case("exchange.toml"), &more);
    place.assert_nothing_left();
    (place, ended)
}

fn assert_refused(ended: &Ended, parts: &[&str]) {
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    for part in parts {
        assert!(ended.stderr.contains(part), "`{part}` is missing in: {}", ended.stderr);
    }
}

/// Work three times as long as the deadline, while building and in a window. `LONG_WORK=60` makes
/// it a minute.
#[test]
fn work_that_makes_progress_is_waited_for() {
    let seconds = std::env::var("LONG_WORK").unwrap_or_else(|_| "3".to_owned());
    let times = ["build_time", "solve_time"].map(|name| format!("right.{name}={seconds}"));
    let (place, ended) = run(&[&times[0], &times[1], "right.steps=600", "time.end=1"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(place.read_summary()["right"]["solves"], 1);
}

/// While building and in a solve.
#[test]
fn progress_that_stops_ends_the_run_and_says_how_far_it_came() {
    for (time, when, what) in [
        ("build_time", "while building its model", "factorising"),
        ("solve_time", "in window 0, iteration 1", "sweeping"),
    ] {
        let since = std::time::Instant::now();
        let (_, ended) = run(&[&format!("right.{time}=1.2"), "right.stop_at=37"]);
        assert_eq!(ended.code, Some(1), "{}", ended.stderr);
        let error = format!(
            "right (toy) failed {when}: it stopped at 37 of 60 {what}: no progress for 1.0 s; \
             its heartbeat is still received; raise coupling."
        );
        assert!(ended.stderr.contains(&error), "{}", ended.stderr);
        assert!(since.elapsed().as_secs_f64() > 1.7, "two thirds of the work, and the deadline");
    }
}

/// The heartbeat process of a Python participant also reports progress.
#[test]
fn progress_from_python() {
    let script = root().join("tests/tests/system/python/long_work.py");
    let command = [interpreter(), &script].map(|path| path.display().to_string());
    let command = format!("right={{command={command:?}, model=\"relay\"}}");
    let place = Place::new();
    let deadlines = ["coupling.build_deadline=1", "coupling.solve_deadline=1", "time.end=2"];
    let settings = [&[command.as_str()], &deadlines[..]].concat();
    let ended = place.run(&case("exchange.toml"), &sets(&settings));
    place.assert_nothing_left();
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    let error = "in window 0, iteration 1: it stopped at 7 sweeping: no progress for 1.0 s";
    assert!(ended.stderr.contains(error), "{}", ended.stderr);
}

/// A plain line appears after ten seconds.
#[test]
fn long_work_is_shown_in_plain_lines() {
    let (_, ended) = run(&["right.build_time=13"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let lines: Vec<&str> = ended.stderr.lines().filter(|line| line.contains(" left")).collect();
    let [line] = lines[..] else { panic!("{}", ended.stderr) };
    assert!(line.starts_with("right building: factorising 4"), "{line}");
    assert!(line.contains("/60, 0:0"), "{line}");
}

#[test]
fn a_model_that_cannot_go_back_runs_where_windows_are_solved_once() {
    let once = r#"right={command=["toy", "long"], model="once"}"#;
    let (place, ended) = run(&[once]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(place.read_summary()["right"]["solves"], 2);
    let reason = "right.model: `once` can solve a window only once, and";
    let (_, ended) = run(&[once, "coupling.scheme=serial-implicit"]);
    assert_refused(&ended, &[reason, "until it has converged", "choose a model that can go back"]);
}

/// Adaptive windows are rejected for a model that cannot rewind.
#[test]
fn a_model_that_cannot_go_back_is_refused_adaptive_windows() {
    let script = format!(
        "PYTHONPATH={} exec {} {} \"$@\"",
        root().join("proto/python/examples").display(),
        interpreter().display(),
        root().join("tests/tests/system/python/once.py").display()
    );
    let command = toml::Value::try_from(["sh", "-c", &script, "sh"]).unwrap();
    let command = format!("thermal.command={command}");
    let cold_start = case("cold-start.toml");
    let more = ["--set", &command, "--set", "time.control=adaptive"];
    let plan = |more: &[&str]| {
        let place = Place::new();
        place.start(&[&["plan", &cold_start], more].concat()).wait()
    };
    let ended = plan(&more[..2]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_refused(&plan(&more), &["adaptive windows are repeated", "remove time.control"]);
}

/// The model conforms, and no check repeats a window.
#[test]
fn a_model_that_cannot_go_back_conforms() {
    let place = Place::new();
    let [program, name] = toy("long");
    let exchange = case("exchange.toml");
    let mut arguments = vec!["conform", "--role", "right", "--case", &exchange, "--json"];
    let settings = [r#"right={model="patient"}"#, "time.window=1", "time.end=1000"];
    let settings = sets(&settings);
    arguments.extend(&settings);
    arguments.extend(["--", &program, &name]);
    let ended = place.start(&arguments).wait();
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
}
