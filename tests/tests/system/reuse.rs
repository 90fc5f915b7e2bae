//! Participants reused by the runs of a study: number of processes, no influence of one run on the
//! next, and handling of failures.

use crate::conform::counted;
use crate::harness::python::interpreter;
use crate::harness::{Place, Table, case, root, wait_until};
use rustix::process::{Pid, Signal, kill_process, test_kill_process};
use std::fs::read_to_string;
use tests::harness::sweeps::points;

/// Runs a sweep on one thread; returns its table and the number of starts of the participant
/// `role`.
fn swept(name: &str, role: &str, program: &[String], more: &[&str]) -> (Table, usize) {
    let folder = tempfile::tempdir().unwrap();
    let place = Place::new();
    let (file, out) = (case(name), place.out().display().to_string());
    let command = format!("{role}.command={:?}", counted(folder.path(), program));
    let fixed = ["sweep", &file, "--jobs", "1", "--out", &out, "--set", &command];
    let ended = place.start(&[&fixed[..], more].concat()).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    place.assert_nothing_left();
    let starts = read_to_string(folder.path().join("count")).unwrap().lines().count();
    (Table::read(&place.out().join("sweep.csv")), starts)
}

/// A point gives the same results as in a process of its own, bit for bit: for every model, on
/// grids that change from point to point, and in transient runs.
#[test]
fn points_are_the_same_in_one_process_and_in_many() {
    let program = ["thermal-solver".to_owned()];
    let transient = r#"time={mode="transient", window="20 us", end="100 us"}"#;
    for (name, settings, points) in [
        (
            "wheel-rail.toml",
            &["--vary", "mech.resolution=5,30,9,6", "--vary", "motion.speed=20,30"][..],
            8,
        ),
        ("falling-friction.toml", &["--vary", "mech.resolution=6,8,6"], 3),
        (
            "full-slip.toml",
            &["--set", transient, "--vary", "thermal.model=columns,moving-source,fe,columns"],
            4,
        ),
        ("wheel-rail.toml", &["--vary", "mech.model=fastsim,half-space,hertz-carter,fastsim"], 4),
    ] {
        let (one, once) = swept(name, "thermal", &program, settings);
        let fresh = [settings, &["--fresh"]].concat();
        let (many, often) = swept(name, "thermal", &program, &fresh);
        assert_eq!((once, often), (1, points), "{name} {settings:?}");
        let answers = |table: Table| table.of(|name| name != "wall_s");
        let (one, many) = (answers(one), answers(many));
        assert_eq!(one, many, "{name} {settings:?}");
        assert_eq!(one.texts("failed").concat(), "");
    }
}

/// A Python program starts once, so that its imports run once.
#[test]
fn a_solver_in_python_stays() {
    let script = root().join("proto/python/examples/short_columns.py");
    let program = [interpreter().display().to_string(), script.display().to_string()];
    let model = ["--set", "thermal.model=short", "--set", "mech.model=hertz-carter"];
    let vary = [&model[..], &["--vary", "mech.resolution=5,9,6,5"]].concat();
    let (table, starts) = swept("wheel-rail.toml", "thermal", &program, &vary);
    assert_eq!(starts, 1);
    let rises = table.texts("temperature.rail.max_rise_k");
    assert_eq!(rises[0], rises[3]);
    assert!(rises[0] != rises[1] && rises[1] != rises[2], "{rises:?}");
}

/// A failed point does not affect others; its process ends.
#[test]
fn a_failed_point_takes_no_other_with_it() {
    let faults = "none,error,none,exit,none,panic,none,refuse-build,not-finite,none,none";
    let vary = format!("left.fault={faults}");
    let words = ["--set", "time.end=3", "--set", "left.fault_window=1", "--vary", &vary];
    let program = ["toy", "left"].map(str::to_owned);
    let (table, starts) = swept("exchange.toml", "left", &program, &words);
    let failed = table.texts("failed");
    for (fault, failed) in faults.split(',').zip(&failed) {
        assert_eq!(fault == "none", failed.is_empty(), "{fault}: {failed}");
    }
    // A new process follows each failure.
    assert_eq!(starts, 6);
}

/// A case rejected by a participant while planning does not end the process.
#[test]
fn a_refused_point_ends_no_process() {
    let vary = ["--set", "mech.model=half-space", "--set", "mech.resolution=6", "--vary"];
    let points = ["motion.traction_coefficient=0.3,0.7,0.4,0.9,0.3"];
    let program = ["mech-solver".to_owned()];
    let (table, starts) =
        swept("wheel-rail.toml", "mech", &program, &[&vary[..], &points].concat());
    let failed: Vec<bool> = table.texts("failed").iter().map(|failed| !failed.is_empty()).collect();
    assert_eq!(failed, [false, true, false, true, false]);
    assert_eq!(starts, 1);
    let rises = table.texts("temperature.rail.max_rise_k");
    assert_eq!(rises[0], rises[4]);
}

/// A point whose fields do not fit into shared memory is rejected; other points are not affected.
#[test]
fn a_point_without_room_takes_no_other_with_it() {
    let program = ["thermal-solver".to_owned()];
    let settings = ["--set", "limits.shared_memory=2 MB", "--vary", "mech.resolution=10,160,12,10"];
    let (table, starts) = swept("wheel-rail.toml", "thermal", &program, &settings);
    let failed = table.texts("failed");
    assert!(failed[1].contains("shared memory failed"), "{failed:?}");
    assert_eq!([0, 2, 3].map(|point: usize| failed[point].is_empty()), [true; 3], "{failed:?}");
    assert_eq!(starts, 1, "nothing had begun");
}

/// Killing or stopping a process in its second run loses one point at most.
fn loses_one_point(signal: Signal) {
    let place = Place::new();
    let (file, out) = (case("exchange.toml"), place.out().display().to_string());
    let settings = ["time.end=20", "left.delay=0.03", "coupling.heartbeat_deadline=1"];
    let settings: Vec<&str> = settings.iter().flat_map(|set| ["--set", set]).collect();
    let vary = ["--vary", "right.delay=0,1e-5,2e-5,3e-5", "--jobs", "1", "--out", &out];
    let running = place.start(&[&["sweep", &file][..], &settings, &vary].concat());
    wait_until("the first point", || points(&place.out()).len() == 1);
    let left = child(running.pid(), "left");
    kill_process(left, signal).unwrap();
    let ended = running.wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let table = Table::read(&place.out().join("sweep.csv"));
    let failed: Vec<&str> =
        table.texts("failed").into_iter().filter(|failed| !failed.is_empty()).collect();
    // No point is lost if the process was waiting for its next run.
    assert!(table.rows.len() == 4 && failed.len() <= 1, "{failed:?}");
    assert!(test_kill_process(left).is_err(), "it still runs");
    place.assert_nothing_left();
}

/// Child of a process with this argument.
fn child(of: Pid, argument: &str) -> Pid {
    let tasks = std::fs::read_dir(format!("/proc/{}/task", of.as_raw_nonzero())).unwrap();
    let children = tasks.flatten().map(|task| read_to_string(task.path().join("children")));
    let all: String = children.map(Result::unwrap_or_default).collect();
    let line = |pid: &&str| read_to_string(format!("/proc/{pid}/cmdline")).unwrap_or_default();
    let has = |pid: &&str| line(pid).split('\0').any(|word| word == argument);
    let found = all.split_whitespace().find(has).unwrap();
    Pid::from_raw(found.parse().unwrap()).unwrap()
}

#[test]
fn a_participant_that_is_killed_in_its_second_run_loses_one_point() {
    loses_one_point(Signal::KILL);
}

#[test]
fn a_participant_that_is_stopped_in_its_second_run_loses_one_point() {
    loses_one_point(Signal::STOP);
}
