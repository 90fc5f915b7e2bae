//! A Python participant replaces ours: the same results within the error of its method, and the
//! same behaviour on failure.

use crate::harness::python::interpreter;
use crate::harness::{Place, case, completed as run, number, root, sets};
use proto::description::KeyKind;
use rustix::process::Signal;
use serde_json::Value;
use std::process::Command;

/// Interpreter with the examples on its path.
fn python() -> Command {
    let mut command = Command::new(interpreter());
    command.env("PYTHONPATH", root().join("proto/python/examples"));
    command
}

fn strip_columns() -> String {
    let program = "proto/python/examples/strip_columns.py";
    format!("thermal.command=[{:?}, {program:?}]", interpreter().display().to_string())
}

/// Setting for a solver with a fault, started by a shell that sets the path of the examples.
fn faulty(fault: &str) -> String {
    let examples = root().join("proto/python/examples");
    let script = format!(
        "PYTHONPATH={} exec {} tests/tests/system/python/faulty.py {fault} \"$@\"",
        examples.display(),
        interpreter().display()
    );
    format!("thermal.command=[\"sh\", \"-c\", {script:?}, \"sh\"]")
}

const PEAK: &str = "/temperature/rail/max_rise_k";
const IMBALANCE: &str = "/coupling/energy_imbalance";

/// Largest difference of two fields, relative to the largest value of the second.
fn difference(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    largest(&mut found.iter().zip(expected).map(|(a, b)| (a - b).abs()))
        / largest(&mut expected.iter().copied())
}

/// Our solver is of order 2.5 and counts as exact here. A piecewise constant flux causes an error
/// of order 1.5 near the peak (0.23 % at a/20, 0.07 % at a/40). Where slip begins with a jump of
/// the flux inside an element, the error is of order 1 (2.0 %, 1.0 %). The bounds are these values
/// plus a quarter.
#[test]
fn strip_columns_give_what_ours_give() {
    let mut errors = Vec::new();
    for (resolution, of_peak, of_field) in [(20, 3.5e-3, 2.5e-2), (40, 1.0e-3, 1.3e-2)] {
        let resolution = format!("mech.resolution={resolution}");
        let (ours, expected) = run("wheel-rail.toml", &[&resolution]);
        let (theirs, found) = run("wheel-rail.toml", &[&resolution, &strip_columns()]);
        for body in ["rail", "wheel"] {
            let at = |name: &str| format!("/temperature/{body}/{name}");
            let ratio = |name: &str| number(&found, &at(name)) / number(&expected, &at(name));
            assert!((ratio("max_rise_k") - 1.0).abs() < of_peak, "{}", ratio("max_rise_k"));
            // The maximum is flat: its position changes with the square root of the error.
            let moved = number(&found, &at("x_over_a")) - number(&expected, &at("x_over_a"));
            assert!(moved.abs() < 0.01, "{moved}");
            assert_eq!(number(&found, &at("y_m")), number(&expected, &at("y_m")));
            assert!((ratio("penetration_depth_m") - 1.0).abs() < 5.0 * of_peak);
            let read = |place: &Place| {
                let name = format!("{body}_temperature");
                place.field("thermal_contact_000000.vti", &name)
            };
            let error = difference(&read(&theirs), &read(&ours));
            assert!(error < of_field, "{body}: {error:e}");
            errors.push(error);
            let read = |place: &Place| {
                let name = format!("{body}_section");
                let file = format!("thermal_{name}_000000.vti");
                place.field(&file, &format!("{name}_temperature"))
            };
            assert!(difference(&read(&theirs), &read(&ours)) < of_field);
        }
        assert!(number(&found, IMBALANCE) <= 1e-12);
    }
    // The differences decrease with the order of the method, so that they are its error.
    let order = (errors[0] / errors[2]).log2();
    assert!((0.8..1.8).contains(&order), "{errors:?}");
}

/// The solver of the README sums directly where the longer one transforms: the field of the rail is
/// the same, to rounding. The short solver does not define `observe`.
#[test]
fn the_short_solver_agrees_with_the_long_one() {
    let program = "proto/python/examples/short_columns.py";
    let short = format!("thermal.command=[{:?}, {program:?}]", interpreter().display().to_string());
    let settings = ["mech.model=hertz-carter", "mech.resolution=20"];
    let (long, _) = run("wheel-rail.toml", &[&settings[..], &[&strip_columns()]].concat());
    let (short, summary) =
        run("wheel-rail.toml", &[&settings[..], &[&short, "thermal.model=short"]].concat());
    assert!(number(&summary, IMBALANCE) <= 1e-12);
    let read = |place: &Place| place.field("thermal_contact_000000.vti", "rail_temperature");
    assert!(difference(&read(&short), &read(&long)) < 1e-14);
}

/// A key that only our solver reads is a warning with a simpler solver; a misspelt key is still an
/// error.
#[test]
fn keys_that_only_ours_reads_are_a_warning() {
    let program = "proto/python/examples/short_columns.py";
    let short = format!("thermal.command=[{:?}, {program:?}]", interpreter().display().to_string());
    let run = |key: &str| {
        let settings = ["mech.model=hertz-carter", "thermal.model=short", &short, key];
        let more = sets(&settings);
        Place::new().run(&case("wheel-rail.toml"), &more)
    };
    let ended = run("thermal.resolution=59");
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let told = "thermal.resolution: nothing in this case reads it: it has no effect";
    assert!(ended.stderr.contains(told), "{}", ended.stderr);
    assert!(ended.stderr.contains("thermal-solver as thermal"), "{}", ended.stderr);
    let ended = run("thermal.resolutoin=59");
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("thermal.resolutoin: unknown key"), "{}", ended.stderr);
}

/// A participant that fails while the other one is working leaves its row of a sequence without
/// result, and the run continues. Its reply is not mistaken for that of the other participant.
#[test]
fn a_failure_beside_one_at_work_is_a_row_without_an_answer() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows.csv");
    std::fs::write(&path, "mu\n0.2\n0.3\n0.4\n").unwrap();
    let column = format!("motion.traction_coefficient={{file={path:?},column=\"mu\"}}");
    let command = faulty("second-row");
    let settings = [
        "mech.resolution=80",
        "coupling.scheme=parallel-explicit",
        "time.mode=sequence",
        "time.on_failure=skip",
        &column,
        &command,
    ];
    let (place, summary) = run("wheel-rail.toml", &settings);
    assert_eq!(summary["coupling"]["rows_without_answer"], 1, "{summary}");
    let status = place.table("history.csv");
    assert_eq!(status.texts("status"), ["completed", "no-answer", "completed"]);
    let told = |event: &Value| {
        event["fields"]["message"]
            .as_str()
            .unwrap_or_default()
            .contains("told to fail in the second row")
    };
    assert!(place.log().iter().any(told), "its words are in the log");
}

/// The command describes the solver without joining a run; if there is no command, the description
/// is that of our solver.
#[test]
fn a_solver_started_by_hand_is_asked_by_its_command() {
    let script = root().join("proto/python/examples/strip_columns.py");
    for command in [vec![], vec!["--set".to_owned(), strip_columns()]] {
        let place = Place::new();
        let attach = ["--set", "mech.model=hertz-carter", "--set", "thermal.attach=true"];
        let more: Vec<&str> =
            attach.into_iter().chain(command.iter().map(String::as_str)).collect();
        let running = place.start_run(&case("wheel-rail.toml"), &more);
        let folder = place.waiting_for("thermal");
        let mut by_hand = python();
        by_hand.arg(&script).args(["--join", &folder, "--role", "thermal"]);
        by_hand.stderr(std::process::Stdio::null()).status().unwrap();
        let ended = running.wait();
        if command.is_empty() {
            assert_eq!(ended.code, Some(1), "{}", ended.stderr);
            let told = "name the program that you start by hand as thermal.command";
            assert!(ended.stderr.contains(told), "{}", ended.stderr);
        } else {
            assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        }
        place.assert_nothing_left();
    }
}

/// The Python solver accepts the same keys as ours, with the same descriptions.
#[test]
fn it_describes_what_ours_describe() {
    let program = root().join("proto/python/examples/strip_columns.py");
    let told = python().arg(program).arg("--describe").output().unwrap();
    let theirs: Value = serde_json::from_slice(&told.stdout).unwrap();
    let ours = proto::model::Solver::description(&thermal_solver::ThermalSolver);
    let ours = serde_json::to_value(ours).unwrap();
    assert_eq!(theirs["protocol"], proto::PROTOCOL_VERSION);
    let by_path = |keys: &Value| {
        let mut keys = keys.as_array().unwrap().clone();
        keys.sort_by_key(|key| key["path"].to_string());
        let specs = keys.into_iter().map(|key| {
            // Only our solver states the plausible range of a value.
            let key: proto::description::KeySpec = serde_json::from_value(key).unwrap();
            proto::description::KeySpec { plausible: None, ..key }
        });
        specs.collect::<Vec<_>>()
    };
    // The example does not offer sections, wakes and heat flow between the surfaces, and does not
    // refuse a locked wheel.
    let flows = |key: &proto::description::KeySpec| key.path.ends_with(".conductance");
    let sections = |key: &proto::description::KeySpec| key.path == "thermal.section_y";
    let wake = |key: &proto::description::KeySpec| key.path == "thermal.wake";
    let locked = |key: &proto::description::KeySpec| key.path == "motion.creepage.xi";
    let columns = |said: &Value| {
        let models = said["models"].as_array().unwrap().iter();
        models.into_iter().find(|model| model["name"] == "columns").unwrap().clone()
    };
    let mut own = by_path(&ours["keys"]);
    own.retain(|key| !locked(key));
    assert_eq!(by_path(&theirs["keys"]), own);
    for (found, expected) in [
        (columns(&theirs), columns(&ours)),
        (theirs["effects"][0].clone(), ours["effects"][0].clone()),
    ] {
        for part in ["name", "consumes", "provides", "steady", "transient"] {
            assert_eq!(found[part], expected[part], "{part}");
        }
        let mut expected = by_path(&expected["keys"]);
        expected.retain(|key| !sections(key) && !flows(key) && !wake(key));
        for key in &mut expected {
            if let KeyKind::Choice { of } = &mut key.kind {
                of.retain(|law| !["continuity", "conductance"].contains(&law.as_str()));
                // The fields required by these words are removed too.
                key.consumes.retain(|word, _| of.contains(word));
            }
        }
        assert_eq!(by_path(&found["keys"]), expected);
    }
}

/// The Python table of fields equals that of the protocol.
#[test]
fn the_tables_of_fields_are_the_same() {
    let script = "import json, cosim.fields as f; \
                  print(json.dumps([kind.to_json() for kind in f.TABLE.values()]))";
    let told = python().args(["-c", script]).output().unwrap();
    let mut theirs: Vec<Value> = serde_json::from_slice(&told.stdout).unwrap();
    let kinds = proto::field::TABLE.iter().map(proto::field::FieldSpec::kind);
    let mut ours: Vec<Value> = kinds.map(|kind| serde_json::to_value(kind).unwrap()).collect();
    for table in [&mut theirs, &mut ours] {
        table.sort_by_key(|kind| kind["name"].to_string());
    }
    assert_eq!(theirs, ours);
}

/// Each pass starts from the accepted state; otherwise the loop would not converge. Bound: as
/// above, times the response of the loop to a temperature error, which is below 1.
#[test]
fn a_loop_through_python_converges_to_the_same_state() {
    let (_, expected) = run("falling-friction.toml", &[]);
    let (_, found) = run("falling-friction.toml", &[&strip_columns()]);
    assert_eq!(found["status"], "converged");
    assert_eq!(found["coupling"]["iterations"], expected["coupling"]["iterations"]);
    for pointer in [PEAK, "/contact/friction_power_w"] {
        let ratio = number(&found, pointer) / number(&expected, pointer);
        assert!((ratio - 1.0).abs() < 1e-3, "{pointer}: {ratio}");
    }
    assert!(number(&found, IMBALANCE) <= 1e-12);
}

/// After five passages the transient field equals the steady one, to rounding: no heat is lost or
/// counted twice. `windows` is the expected range of the number of windows.
fn windows_add_up(settings: &[&str], windows: std::ops::Range<u64>) {
    let python = strip_columns();
    let (_, transient) = run("cold-start.toml", &[settings, &[&python]].concat());
    let count = transient["coupling"]["windows"].as_u64().unwrap();
    assert!(windows.contains(&count), "{count}");
    let of_space: Vec<&str> =
        settings.iter().copied().filter(|set| set.starts_with("mech.")).collect();
    let given = [&of_space[..], &["time.mode=steady", &python]].concat();
    let unset = ["--unset", "time.window", "--unset", "time.end", "--unset", "output.every"];
    let more = [&sets(&given)[..], &unset].concat();
    let steady = Place::new().summary(&case("cold-start.toml"), &more);
    let ratio = number(&transient, PEAK) / number(&steady, PEAK);
    assert!((ratio - 1.0).abs() < 1e-10, "{ratio}");
    assert!(number(&transient, IMBALANCE) <= 1e-12);
}

#[test]
fn windows_add_up_to_the_steady_field() {
    windows_add_up(&["mech.resolution=6"], 51..52);
}

/// Windows of a twentieth of an element's passage are merged, which changes nothing once the flux
/// is constant.
#[test]
fn merged_windows_add_up_to_the_steady_field() {
    windows_add_up(&["mech.resolution=1", "time.window=10 us", "output.every=1000"], 100..110);
}

/// Own grid, to which the coordinator maps the heat.
#[test]
fn a_wished_grid_gets_all_the_heat() {
    let settings = ["mech.resolution=20", "thermal.resolution=59", &strip_columns()];
    let (place, mapped) = run("wheel-rail.toml", &settings);
    assert!(number(&mapped, IMBALANCE) <= 1e-10);
    let values = place.field("thermal_contact_000000.vti", "rail_temperature");
    assert_eq!(values.len(), 59 * 46);
}

/// A run whose coordinator is killed leaves nothing, and the resumed run equals an uninterrupted
/// one bit for bit.
#[test]
fn a_killed_run_is_resumed() {
    let python = strip_columns();
    let settings =
        [python.as_str(), "mech.resolution=4", "time.end=0.6 ms", "output.checkpoint_every=7"];
    let more = sets(&settings);
    let (undisturbed, expected) = run("cold-start.toml", &settings);
    let place = Place::new();
    let running = place.start_run(&case("cold-start.toml"), &more);
    place.wait_for_log("checkpoint written");
    running.signal(Signal::KILL);
    assert_eq!(running.wait().code, None, "killed while it ran");
    place.assert_nothing_left();
    let resumed = place.start(&["run", "--resume", &place.out().display().to_string()]).wait();
    assert_eq!(resumed.code, Some(0), "{}", resumed.stderr);
    place.assert_nothing_left();
    assert_eq!(place.read_summary()["temperature"], expected["temperature"]);
    let last = format!("thermal_contact_{:06}.vti", 29);
    let read = |place: &Place| place.field(&last, "wheel_temperature");
    assert_eq!(read(&place), read(&undisturbed));
}

/// In one of 40 windows, a solver takes the value of the next element. The comparison with a
/// recording of the right solver names window, sender and cause. The command that it prints shows
/// the fault in the build at hand.
#[test]
fn a_wrong_index_is_found_from_two_recordings() {
    let time = ["time.mode=transient", "time.window=5 us", "time.end=200 us", "mech.resolution=5"];
    let record = |fault: &str| {
        let place = Place::new();
        let solver = faulty(fault);
        let more = [sets(&time), sets(&[&solver]), vec!["--record"]].concat();
        place.summary(&case("falling-friction.toml"), &more);
        let recording = place.out().join("recording.mcap").display().to_string();
        (place, recording)
    };
    let ((good, reference), (_other, recording)) = (record("none"), record("wrong-index"));
    let compared = good.start(&["inspect", &recording, "--against", &reference]).wait();
    assert_eq!(compared.code, Some(4), "{}", compared.stderr);
    let command = format!("coordinator replay {reference} --only thermal --until 20");
    for told in [
        "window 20, iteration 1: lower_temperature[30]",
        "sender    thermal (strip-columns 0.1.0)",
        "its build or its state",
        command.as_str(),
    ] {
        assert!(compared.stdout.contains(told), "{told}: {}", compared.stdout);
    }
    assert!(compared.stdout.contains("add --serve --step=20"), "{}", compared.stdout);
    for (fault, code) in [("none", 0), ("wrong-index", 4)] {
        let program = faulty(fault).split_once('=').unwrap().1.to_owned();
        let words: Vec<String> = serde_json::from_str(&program).unwrap();
        let program = words.iter().map(|word| format!("'{word}'")).collect::<Vec<_>>().join(" ");
        let typed: Vec<&str> = command.split(' ').skip(1).chain(["--command", &program]).collect();
        let ended = good.start(&typed).wait();
        assert_eq!(ended.code, Some(code), "{}", ended.stderr);
    }
}

/// A thread of the Python package watches the coordinator, even while the solver is busy.
fn leaves_nothing_in_mid_solve(fault: &str) {
    let place = Place::new();
    let running = place.start_run(&case("cold-start.toml"), &["--set", &faulty(fault)]);
    place.wait_for_log("every participant is ready");
    std::thread::sleep(std::time::Duration::from_millis(300));
    running.signal(Signal::KILL);
    assert_eq!(running.wait().code, None, "killed by a signal");
    place.assert_nothing_left();
}

table_of_tests! { leaves_nothing_in_mid_solve:
    a_killed_coordinator_leaves_nothing_that_sleeps("sleep");
    a_killed_coordinator_leaves_nothing_that_spins("spin");
    a_killed_coordinator_leaves_nothing_that_holds_the_lock("hold");
}

/// The heartbeat continues beside a loop that holds the interpreter almost all the time; the
/// deadline of the solve ends the run.
#[test]
fn a_busy_solve_keeps_its_heart() {
    let place = Place::new();
    let settings =
        [&faulty("spin"), "coupling.heartbeat_deadline=1.5", "coupling.solve_deadline=4"];
    let ended = place.run(&case("cold-start.toml"), &sets(&settings));
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("its heartbeat is still received"), "{}", ended.stderr);
    place.assert_nothing_left();
}

/// A call into a C library that holds the interpreter lock does not stop the heartbeat.
#[test]
fn a_solve_that_holds_the_interpreters_lock_keeps_its_heart() {
    let place = Place::new();
    let settings = [&faulty("hold"), "coupling.heartbeat_deadline=3", "time.end=2e-5"];
    let ended = place.run(&case("cold-start.toml"), &sets(&settings));
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    place.assert_nothing_left();
}

/// Command of `moving_parts.py` for a role of `cases/moving.toml`.
fn moving_part(role: &str) -> String {
    let script = root().join("tests/tests/system/python/moving_parts.py");
    format!("{role}.command=[{:?}, {:?}, {role:?}]", interpreter(), script)
}

/// Mover and plate in Python replace those in Rust, with the flux mapped or received on the moving
/// grid: each receives the other's values at the right positions, to rounding.
fn moves_as_in_rust(motion: &str, direct: bool) {
    let parts = ["mover", "plate"].map(moving_part);
    let motion = format!("mover.motion={motion}");
    let direct = format!("plate.direct={direct}");
    let settings = [&motion, &direct, "time.end=4", "mover.every=2", "output.fields=all"];
    let (_, ours) = run("moving.toml", &settings);
    let (_, theirs) = run("moving.toml", &[&settings[..], &[&parts[0], &parts[1]]].concat());
    for role in ["mover", "plate"] {
        let [a, b] = [&ours, &theirs].map(|summary| &summary[role]);
        assert_eq!(
            [&a["windows"], &a["grid_revision"]],
            [&b["windows"], &b["grid_revision"]],
            "{motion}"
        );
        let [a, b] = [a, b].map(|part| number(part, "/largest_error"));
        assert!((a - b).abs() <= 1e-12, "{motion}, {role}: {a} in Rust, {b} in Python");
    }
}

table_of_tests! { moves_as_in_rust:
    a_grid_that_moves_in_python_is_as_in_rust("translate", true);
    a_grid_that_grows_in_python_is_as_in_rust("grow", false);
    a_grid_that_stretches_in_python_is_as_in_rust("stretch", true);
}

/// Asserts that a fault in the first window is reported in the phase `when`, with the words `what`.
fn fault_is_told(fault: &str, when: &str, what: &str) {
    let place = Place::new();
    let name = if fault == "accept" { "cold-start.toml" } else { "falling-friction.toml" };
    let ended = place.run(&case(name), &["--set", &faulty(fault)]);
    assert_eq!(ended.code, Some(1), "{fault}: {}", ended.stderr);
    for part in ["thermal (sh) failed", when, what] {
        assert!(ended.stderr.contains(part), "`{part}` is missing in: {}", ended.stderr);
    }
    if fault == "raise" {
        let traced = |event: &Value| event.to_string().contains("faulty.py");
        assert!(place.log().iter().any(traced), "the traceback is in the log");
    }
    place.assert_nothing_left();
}

const FIRST: &str = "in window 0, iteration 1";

// `Accept` has no reply: the next command is answered with the error.
table_of_tests! { fault_is_told:
    an_exception_is_told("raise", FIRST, "ValueError: told to fail");
    an_input_that_is_kept_is_told("keep-input", FIRST, "an array of `friction_power` was kept");
    an_output_that_is_kept_is_told("keep-output", FIRST, "an array of `lower_temperature` was kept");
    writing_to_an_input_is_told("write-input", FIRST, "read-only");
    what_is_not_written_is_told("unwritten", FIRST, "`lower_temperature` is not finite at index 7");
    a_heat_that_is_no_number_is_told("heat", FIRST, "the model reports a received power of nan W");
    an_unknown_field_is_told("unknown", FIRST, "the description provides no `rail_temperatur`");
    an_exit_is_told("exit", FIRST, "ended with exit code 9");
    an_exception_in_accept_is_told("accept", "while accepting window 0", "ValueError: told to fail");
}

#[test]
fn what_python_refuses_is_an_error_of_the_case() {
    let refused = [
        (vec!["thermal.model=ertz-knothe".to_owned(), strip_columns()], 2, "thermal.model"),
        (vec![faulty("refuse")], 2, "told to refuse"),
        (vec!["thermal.resolution=1".to_owned(), strip_columns()], 2, "thermal.resolution"),
        (vec![faulty("layout")], 1, "its layout has no grid for `lower_temperature`"),
    ];
    for (settings, code, what) in refused {
        let place = Place::new();
        let settings: Vec<&str> = settings.iter().map(String::as_str).collect();
        let more = sets(&settings);
        let ended = place.run(&case("falling-friction.toml"), &more);
        assert_eq!(ended.code, Some(code), "{settings:?}: {}", ended.stderr);
        assert!(ended.stderr.contains(what), "`{what}` is missing in: {}", ended.stderr);
        place.assert_nothing_left();
    }
}
