//! Externally driven runs: values set window by window, states, and invalid requests.

use crate::harness::python::interpreter;
use crate::harness::{Ended, Place, case, sets, wait_until};
use serde_json::{Value, json};
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::Stdio;

/// Drives a coordinator with these lines to the end; returns its answers, line by line.
fn drive(place: &Place, name: &str, settings: &[&str], lines: &[Value]) -> (Ended, Vec<Value>) {
    let text: String = lines.iter().map(|line| format!("{line}\n")).collect();
    drive_by(place, name, settings, text.as_bytes())
}

fn drive_by(place: &Place, name: &str, settings: &[&str], text: &[u8]) -> (Ended, Vec<Value>) {
    let mut file = tempfile::tempfile().unwrap();
    file.write_all(text).unwrap();
    std::io::Seek::rewind(&mut file).unwrap();
    let (out, case) = (place.out().display().to_string(), case(name));
    let settings = sets(settings);
    let mut arguments = vec!["drive", &case, "--out", &out, "--replace"];
    arguments.extend(&settings);
    let mut command = place.command(&arguments);
    command.stdin(Stdio::from(file));
    let ended = place.launch(command).wait();
    let said = ended.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    place.assert_nothing_left();
    (ended, said)
}

/// Steps with these values of a key.
fn steps(key: &str, values: &[f64]) -> Vec<Value> {
    values.iter().map(|value| json!({"do": "step", "set": {key: value}})).collect()
}

fn history(place: &Place) -> String {
    fs::read_to_string(place.out().join("history.csv")).unwrap()
}

/// Table of values at these times, and the setting that makes a key a column of it.
fn table(folder: &Path, key: &str, rows: &[(f64, f64)]) -> [String; 2] {
    let rows: String = rows.iter().map(|(time, value)| format!("{time:?},{value:?}\n")).collect();
    let path = folder.join("run.csv");
    fs::write(&path, format!("t,value\n{rows}")).unwrap();
    let column = |key: &str, name: &str| format!("{key}={{file={path:?},column=\"{name}\"}}");
    [column(key, "value"), column("time.history", "t")]
}

const LOAD: &str = "load.normal_force";
const LIVE: &str = "load.normal_force={at=\"134 kN\",from=\"60 kN\",to=\"140 kN\"}";

/// Values set window by window give the same results as a table with those values, bit for bit.
fn the_rows_of_a_table(name: &str, common: &[&str], key: &str, limits: [f64; 2], values: &[f64]) {
    let (table_place, place) = (Place::new(), Place::new());
    let folder = tempfile::tempdir().unwrap();
    let rows: Vec<(f64, f64)> = values.iter().map(|value| (0.0, *value)).collect();
    let [column, _] = table(folder.path(), key, &rows);
    let mut set = common.to_vec();
    set.extend(["time.mode=sequence", &column]);
    table_place.summary(&case(name), &sets(&set));
    let live = format!("{key}={{at={:?},from={:?},to={:?}}}", values[0], limits[0], limits[1]);
    let mut set = common.to_vec();
    set.push(&live);
    let mut lines = steps(key, values);
    lines.push(json!({"do": "finish"}));
    let (ended, said) = drive(&place, name, &set, &lines);
    assert_eq!(ended.code, Some(0), "{} {said:?}", ended.stderr);
    assert_eq!(said.len(), values.len() + 2, "{said:?}");
    assert_eq!(history(&place), history(&table_place));
    // The answer to a step equals the row of the table.
    let keys = said[0]["figures"].as_array().unwrap();
    let written = place.table("history.csv");
    for (window, answer) in said[1..=values.len()].iter().enumerate() {
        for (figure, value) in keys.iter().zip(answer["figures"].as_array().unwrap()) {
            // A figure that never has a value has no column in a complete table.
            let key = figure.as_str().unwrap();
            let known = written.head.iter().any(|name| name == key);
            let text = if known { written.texts(key)[window] } else { "" };
            assert_eq!(value.as_f64(), text.parse().ok(), "{figure}");
        }
    }
}

const LOADS: &[f64] = &[134e3, 60e3, 140e3, 100e3];

table_of_tests! { the_rows_of_a_table:
    hertz_carter("wheel-rail.toml", &["mech.model=hertz-carter"], LOAD, [60e3, 140e3], LOADS);
    fastsim("wheel-rail.toml", &["mech.model=fastsim", "mech.resolution=10"], LOAD, [60e3, 140e3], LOADS);
    half_space("wheel-rail.toml", &["mech.resolution=10"], LOAD, [60e3, 140e3], LOADS);
    traction("wheel-rail.toml", &["mech.resolution=10"], "motion.traction_coefficient", [0.2, 0.58], &[0.58, 0.2, 0.4]);
    a_loop("falling-friction.toml", &["mech.model=half-space", "mech.resolution=8", "effects.temperature_friction.decay_temperature=300"], LOAD, [60e3, 140e3], LOADS);
    wheel_on_track("wheel-on-track.toml", &["mech.resolution=10"], "wheelset.y", [0.0, 0.004], &[0.003, 0.0, 0.004, 0.002]);
}

const TRANSIENT: [&str; 5] = [
    "mech.resolution=10",
    "time.mode=transient",
    "time.window=1e-4",
    "time.end=4e-4",
    "motion.traction_coefficient=0.4",
];

/// Middle of a window.
fn middle(window: usize) -> f64 {
    0.5 * (window as f64 * 1e-4 + (window + 1) as f64 * 1e-4)
}

/// Values of a transient case are constant over their windows. This equals a table with the values
/// at the middles of the windows.
#[test]
fn windows_in_time_have_the_values_that_are_given() {
    for rolling in ["steady", "transient"] {
        let rolling = format!("mech.rolling={rolling}");
        let folder = tempfile::tempdir().unwrap();
        let rows: Vec<_> = LOADS.iter().enumerate().map(|(k, load)| (middle(k), *load)).collect();
        let [column, time] = table(folder.path(), LOAD, &rows);
        let mut set = TRANSIENT.to_vec();
        set.push(&rolling);
        let live: Vec<&str> = set.iter().copied().chain([LIVE]).collect();
        set.extend([column.as_str(), &time]);
        let (table_place, place) = (Place::new(), Place::new());
        table_place.summary(&case("wheel-rail.toml"), &sets(&set));
        let (ended, said) = drive(&place, "wheel-rail.toml", &live, &steps(LOAD, LOADS));
        assert_eq!(ended.code, Some(0), "{} {said:?}", ended.stderr);
        assert_eq!(history(&place), history(&table_place), "{rolling}");
        // If no values are set, the first one holds, in the windows of the case.
        let alone = Place::new();
        alone.summary(&case("wheel-rail.toml"), &sets(&live));
        let constant = Place::new();
        drive(&constant, "wheel-rail.toml", &live, &steps(LOAD, &[134e3; 4]));
        assert_eq!(history(&constant), history(&alone));
    }
}

/// After a reset the same processes give the same answers again.
#[test]
fn a_reset_begins_the_run_again() {
    let place = Place::new();
    let run = steps(LOAD, &[7e4, 1.2e5]);
    let again = [&run[..], &[json!({"do": "reset"})], &run, &[json!({"do": "finish"})]].concat();
    let (ended, said) = drive(&place, "wheel-rail.toml", &["mech.resolution=8", LIVE], &again);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(said.len(), 7);
    assert!(said[0]["ready"] == 1 && said[..3] == said[3..6], "{said:#?}");
    assert_eq!(said[6], json!({"done": true}));
    let rows = history(&place).lines().count();
    assert_eq!(rows, 3, "a head, and the windows of the last run");
}

/// After a state is restored, the same windows give identical results, bit for bit. Several states
/// can be saved. A window without solution keeps the state before it.
#[test]
fn states_are_returned_to() {
    let cases: [(&str, &[&str]); 3] = [
        ("wheel-rail.toml", &TRANSIENT),
        ("wheel-rail.toml", &["mech.resolution=10"]),
        (
            "falling-friction.toml",
            &[
                "mech.model=half-space",
                "mech.resolution=8",
                "time.mode=transient",
                "time.window=1e-4",
                "time.end=1e-3",
            ],
        ),
    ];
    for (name, common) in cases {
        let mut set = common.to_vec();
        set.push(LIVE);
        let place = Place::new();
        let mut straight = steps(LOAD, LOADS);
        straight.push(json!({"do": "finish"}));
        let (_, expected) = drive(&place, name, &set, &straight);
        let expected_history = history(&place);
        let step = |k: usize| json!({"do": "step", "set": {LOAD: LOADS[k]}});
        let other = json!({"do": "step", "set": {LOAD: 70e3}});
        let back = |state: u64| json!({"do": "restore", "state": state});
        let lines = [
            step(0),
            json!({"do": "save"}),
            step(1),
            json!({"do": "save"}),
            other.clone(),
            other,
            back(1),
            back(2),
            back(1),
            step(1),
            step(2),
            back(2),
            step(2),
            json!({"do": "free", "state": 1}),
            json!({"do": "restore", "state": 1}),
            step(3),
            json!({"do": "finish"}),
        ];
        let (ended, said) = drive(&place, name, &set, &lines);
        assert_eq!(ended.code, Some(0), "{} {said:?}", ended.stderr);
        let same = [(1, 1), (3, 2), (10, 2), (11, 3), (13, 3), (16, 4)];
        for (found, one) in same {
            assert_eq!(said[found], expected[one], "{name}: line {found}");
        }
        assert_eq!(said[15]["kind"], "refused", "{:?}", said[15]);
        assert_eq!(history(&place), expected_history, "{name}");
    }
}

/// An invalid request is rejected with the reason and changes nothing. The end of the input ends
/// the run.
#[test]
fn what_cannot_be_done_is_refused() {
    let place = Place::new();
    let set = ["mech.model=hertz-carter", "mech.resolution=10", LIVE];
    let text = concat!(
        "{\"do\":\"save\"}\n",
        "{\"do\":\"step\",\"set\":{\"load.normal_force\":150000.0}}\n",
        "{\"do\":\"step\",\"set\":{\"load.weight\":1.0}}\n",
        "nonsense\n",
        "\u{0}\n",
        "{\"do\":\"step\",\"end\":-1.0}\n",
        "{\"do\":\"restore\",\"state\":7}\n",
        "{\"do\":\"step\",\"end\":2.5}\n",
    );
    let (ended, said) = drive_by(&place, "wheel-rail.toml", &set, text.as_bytes());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let parts = [
        "no state before the first window",
        "window 0: 150000 of `load.normal_force` is not between 60000 and 140000",
        "`load.weight` is not a live value of this run; known: load.normal_force",
        "no request",
        "no request",
        "window 0 begins at 0 s and cannot end at -1 s",
        "there is no state 7",
    ];
    for (answer, part) in said[1..].iter().zip(parts) {
        assert_eq!(answer["kind"], "refused", "{answer}");
        assert!(answer["error"].as_str().unwrap().contains(part), "{answer} {part}");
    }
    assert_eq!((&said[8]["window"], &said[8]["end"]), (&json!(0), &json!(2.5)));
    assert_eq!(said.len(), 9);
    let history = place.table("history.csv");
    assert_eq!(history.numbers("contact.normal_force_n"), [134e3]);
}

/// A window without solution reports the reason, and the run continues from the state before it.
#[test]
fn a_window_without_an_answer_leaves_the_state() {
    let place = Place::new();
    let live = "motion.traction_coefficient={at=0.4,from=0.1,to=0.7}";
    let set = ["mech.resolution=10", live];
    let values = [0.4, 0.65, 0.4];
    let lines = steps("motion.traction_coefficient", &values);
    let (ended, said) = drive(&place, "wheel-rail.toml", &set, &lines);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(said[2]["kind"], "no-answer", "{:?}", said[2]);
    assert!(said[2]["error"].as_str().unwrap().contains("window 1"), "{:?}", said[2]);
    assert_eq!(said[3]["window"], 1, "{:?}", said[3]);
}

/// Cases that cannot be driven are rejected with key and fix, also on standard output.
#[test]
fn cases_that_cannot_be_driven() {
    let rows: [(&[&str], &str); 6] = [
        (
            &["load.normal_force={at=1e3,from=2e3,to=3e3}"],
            "1000 N is not between 2000 N and 3000 N",
        ),
        (&["load.normal_force={at=1e3,from=1e2}"], "`to` is missing"),
        (&["load.normal_force={at=1e3,from=-5,to=2e3}"], "`from` -5 N is not"),
        (&["mech.resolution={at=10,from=5,to=20}"], "accepts only a number"),
        (&[LIVE, "time.mode=sequence"], "a sequence has the rows of a table"),
        (
            &[
                LIVE,
                "time.mode=transient",
                "time.window=1e-4",
                "time.end=1e-3",
                "time.control=adaptive",
            ],
            "adaptive windows are chosen by the run",
        ),
    ];
    for (set, part) in rows {
        let place = Place::new();
        let (ended, said) = drive(&place, "wheel-rail.toml", set, &[]);
        assert_eq!(ended.code, Some(2), "{part}: {said:?}");
        let error = said[0]["error"].as_str().unwrap();
        assert!(error.contains(part), "{part}: {error}");
        assert_eq!(said[0]["kind"], "ended");
    }
    let ended = Place::new().start(&["drive", "-"]).wait();
    assert_eq!(ended.code, Some(2), "{}", ended.stdout);
    assert!(ended.stderr.contains("standard input has the lines"), "{}", ended.stderr);
}

/// Several live values at once; the plan describes them.
#[test]
fn a_plan_names_the_live_values() {
    let place = Place::new();
    let speed = "motion.speed={at=38.889,from=10,to=60}";
    let set = sets(&["mech.model=hertz-carter", LIVE, speed]);
    let case = case("wheel-rail.toml");
    let mut arguments = vec!["plan", &case];
    arguments.extend(&set);
    let text = crate::harness::flat(&place.start(&arguments).wait().stdout);
    let load = "load.normal_force coordinator -> mech; from 60000 N to 140000 N, 134000 N unless the run is driven";
    assert!(text.contains(load), "{text}");
    assert!(
        text.contains("motion.speed coordinator -> mech, thermal; from 10 m/s to 60 m/s"),
        "{text}"
    );
}

/// A participant that describes a field with the name of a live key sets the key in every window. A
/// value outside the limits ends the run.
#[test]
fn a_participant_gives_a_live_value() {
    let folder = tempfile::tempdir().unwrap();
    let loads: Vec<f64> = (0..4).map(|k| 100e3 + 10e3 * f64::from(k)).collect();
    let mut rows: Vec<_> = loads.iter().enumerate().map(|(k, load)| (middle(k), *load)).collect();
    // Extends the table to the limits of the live value, so that the grids are the same.
    rows.extend([(1.0, 90e3), (2.0, 130e3)]);
    let [column, time] = table(folder.path(), LOAD, &rows);
    let program = "tests/tests/system/python/vehicle.py";
    let command =
        format!("vehicle.command=[{:?}, {program:?}]", interpreter().display().to_string());
    for model in ["hertz-carter", "half-space"] {
        let model = format!("mech.model={model}");
        let mut common = TRANSIENT.to_vec();
        common.push(&model);
        let mut set = common.clone();
        set.extend([column.as_str(), &time]);
        let by_table = Place::new();
        by_table.summary(&case("wheel-rail.toml"), &sets(&set));
        let given = |limits: &str| {
            let live = format!("load.normal_force={{at=1e5,{limits}}}");
            let mut set = common.clone();
            set.extend([command.as_str(), "vehicle.model=law", &live]);
            let place = Place::new();
            let ended = place.run(&case("wheel-rail.toml"), &sets(&set));
            place.assert_nothing_left();
            (place, ended)
        };
        let (place, ended) = given("from=9e4,to=1.3e5");
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert_eq!(history(&place), history(&by_table), "{model}");
        let (_, ended) = given("from=9e4,to=1.15e5");
        assert_eq!(ended.code, Some(1), "{}", ended.stderr);
        let part =
            "sent the value 120000 of `load.normal_force`, which is not between 90000 and 115000";
        assert!(
            ended.stderr.contains(part) && ended.stderr.contains("window 2"),
            "{}",
            ended.stderr
        );
    }
}

/// The recording of a run with live values replays identically, bit for bit.
#[test]
fn live_values_are_recorded_and_replayed() {
    let mut set = TRANSIENT.to_vec();
    set.extend(["mech.model=hertz-carter", LIVE]);
    let place = Place::new();
    let mut more = sets(&set);
    more.push("--record");
    place.summary(&case("wheel-rail.toml"), &more);
    let recording = place.out().join("recording.mcap").display().to_string();
    let replayed = place.start(&["replay", &recording, "--only", "mech"]).wait();
    assert_eq!(replayed.code, Some(0), "{}{}", replayed.stdout, replayed.stderr);
    place.assert_nothing_left();
}

/// A rejected request changes nothing: either all values of a request are set or none, also before
/// a step.
#[test]
fn a_refused_request_changes_nothing() {
    let place = Place::new();
    let traction = "motion.traction_coefficient";
    let live = format!("{traction}={{at=0.4,from=0.1,to=0.58}}");
    let set = ["mech.resolution=10", LIVE, &live];
    let refused = [
        json!({"do": "set", "values": {LOAD: 70e3, traction: 5}}),
        json!({"do": "step", "set": {LOAD: 80e3, "zz": 1}, "end": 3}),
        json!({"do": "step", "set": {LOAD: 90e3}, "end": -5}),
    ];
    let step = json!({"do": "step"});
    let lines: Vec<Value> = refused.iter().flat_map(|line| [line.clone(), step.clone()]).collect();
    let (ended, said) = drive(&place, "wheel-rail.toml", &set, &lines);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    for answer in said[1..].iter().step_by(2) {
        assert_eq!(answer["kind"], "refused", "{answer}");
    }
    let loads = place.table("history.csv").numbers("contact.normal_force_n");
    // Sum of the pressures, to rounding.
    assert!(
        loads.len() == 3 && loads.iter().all(|load| (load / 134e3 - 1.0).abs() < 1e-12),
        "{loads:?}"
    );
}

/// Saved states take memory: their number is limited, and freeing one makes room.
#[test]
fn states_have_a_limit() {
    let place = Place::new();
    let save = json!({"do": "save"});
    let mut lines = vec![json!({"do": "step"})];
    lines.extend(std::iter::repeat_n(save.clone(), 4097));
    lines.extend([json!({"do": "free", "state": 7}), save]);
    let set = ["left.points=2", "right.points=2"];
    let (ended, said) = drive(&place, "exchange.toml", &set, &lines);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(said[4097]["state"], 4096, "{}", said[4097]);
    let refused = &said[4098];
    assert_eq!(refused["kind"], "refused", "{refused}");
    assert!(refused["error"].as_str().unwrap().contains("limit of 4096 saved states"), "{refused}");
    assert_eq!(said[4100]["state"], 4097, "{}", said[4100]);
}

/// A signal ends the run even if the driver does not read the answers.
#[test]
fn a_signal_ends_a_run_whose_answers_are_not_read() {
    let place = Place::new();
    let mut file = tempfile::tempfile().unwrap();
    file.write_all("{\"do\":\"set\",\"values\":{}}\n".repeat(20_000).as_bytes()).unwrap();
    std::io::Seek::rewind(&mut file).unwrap();
    let mut command = place.command(&["drive", &case("exchange.toml")]);
    let mut child = command.stdin(Stdio::from(file)).spawn().unwrap();
    let answers = child.stdout.take().unwrap();
    // Capacity of a pipe.
    wait_until("a full pipe", || rustix::io::ioctl_fionread(&answers).unwrap() > 65_000);
    let pid = rustix::process::Pid::from_child(&child);
    rustix::process::kill_process(pid, rustix::process::Signal::TERM).unwrap();
    let mut ended = None;
    wait_until("the end of the run", || {
        ended = child.try_wait().unwrap();
        ended.is_some()
    });
    assert_eq!(ended.unwrap().code(), Some(143));
    drop(answers);
    place.assert_nothing_left();
}
