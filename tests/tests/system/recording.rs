//! Recordings: all exchanged data are recorded, a participant replays identically, bit for bit, and
//! differences are reported.

use crate::harness::compiled::Compiled;
use crate::harness::{Ended, Place, Table, case, programs, root, sets, toy, wait_until};
use rustix::process::{Pid, Resource, Rlimit, Signal, prlimit};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// Runs and records a case; returns the path of the recording.
fn record(place: &Place, name: &str, flag: &str, settings: &[&str]) -> PathBuf {
    let more: Vec<&str> = [flag].into_iter().chain(sets(settings)).collect();
    place.summary(&case(name), &more);
    place.out().join("recording.mcap")
}

/// `replay RECORDING --only ROLE --json` with more arguments.
fn replay(
    place: &Place,
    recording: &Path,
    role: &str,
    more: &[&str],
) -> (Option<i32>, Value, String) {
    let path = recording.display().to_string();
    let arguments: Vec<&str> = ["replay", &path, "--only", role, "--json"]
        .into_iter()
        .chain(more.iter().copied())
        .collect();
    let Ended { code, stdout, stderr } = place.start(&arguments).wait();
    (code, serde_json::from_str(&stdout).unwrap_or_default(), stderr)
}

fn assert_identical(place: &Place, recording: &Path, role: &str, more: &[&str]) -> Value {
    let (code, replay, stderr) = replay(place, recording, role, more);
    assert_eq!(code, Some(0), "{role}: {replay:#} {stderr}");
    assert_eq!(replay["comparison"]["unequal_samples"], 0, "{replay:#}");
    assert!(replay["comparison"]["samples"].as_u64().unwrap() > 0, "{replay:#}");
    replay
}

fn inspect(place: &Place, recording: &Path, more: &[&str]) -> Value {
    let path = recording.display().to_string();
    let arguments: Vec<&str> =
        ["inspect", &path, "--json"].into_iter().chain(more.iter().copied()).collect();
    let ended = place.start(&arguments).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    serde_json::from_str(&ended.stdout).unwrap()
}

#[test]
fn a_two_way_implicit_run_replays_to_the_bit_on_both_sides() {
    for flag in ["--record", "--record=lz4"] {
        let place = Place::new();
        let recording = record(&place, "falling-friction.toml", flag, &[]);
        let solves = ["mech", "thermal"].map(|role| {
            let replay = assert_identical(&place, &recording, role, &[]);
            replay["solves"].as_u64().unwrap()
        });
        let seen = inspect(&place, &recording, &[]);
        assert_eq!(seen["complete"], true);
        assert_eq!(solves, [seen["iterations"].as_u64().unwrap(); 2]);
        assert_eq!(seen["iterations"], place.read_summary()["coupling"]["iterations"]);
        place.assert_nothing_left();
    }
}

/// Two recordings of a case are equal. With another conductivity, the comparison names the key.
#[test]
fn two_recordings_are_compared() {
    let places = [Place::new(), Place::new(), Place::new()];
    let conductivities = ["50", "50", "51"];
    let recordings = [0, 1, 2].map(|n| {
        let set = format!("materials.steel.conductivity={}", conductivities[n]);
        let set = [set.as_str(), "mech.resolution=10", "time.end=100 us"];
        record(&places[n], "cold-start.toml", "--record", &set).display().to_string()
    });
    let [one, again, other] = &recordings;
    let against = |new: &str| places[0].start(&["inspect", new, "--against", one]).wait();
    let equal = against(again);
    assert_eq!(equal.code, Some(0), "{}", equal.stderr);
    assert!(equal.stdout.contains("bit-identical"), "{}", equal.stdout);
    let differs = against(other);
    assert_eq!(differs.code, Some(4), "{}", differs.stderr);
    let cause = "its configuration: case.materials.steel.conductivity is 51.0, recorded 50.0";
    assert!(differs.stdout.contains(cause), "{}", differs.stdout);
    assert!(differs.stderr.contains("the recordings differ: window 0"), "{}", differs.stderr);
}

/// A replay asks before the first solve of a window, and stops there if told so.
#[test]
fn a_replay_stops_before_a_window() {
    let place = Place::new();
    let set = ["mech.resolution=10", "time.end=100 us"];
    let recording = record(&place, "cold-start.toml", "--record", &set).display().to_string();
    let mut command = place.command(&["replay", &recording, "--only", "thermal", "--step=3"]);
    command.stdin(Stdio::piped());
    let mut running = place.launch(command);
    running.type_text("q\n");
    let ended = running.wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let asked: Vec<&str> = ended.stdout.lines().filter(|line| line.contains(" > ")).collect();
    assert_eq!(asked.len(), 1, "{}", ended.stdout);
    assert!(asked[0].contains("thermal: Solve window 3, iteration 1, "), "{}", ended.stdout);
    assert!(ended.stdout.contains("3 solves"), "{}", ended.stdout);
}

/// Ten windows of the linear pair, with all secant columns of an accelerator.
#[test]
fn a_loop_over_many_windows_replays_to_the_bit() {
    let place = Place::new();
    let recording = record(&place, "linear.toml", "--record", &["linear.problem=P5"]);
    for role in ["relay", "operator"] {
        let program = toy(role).join(" ");
        assert_identical(&place, &recording, role, &["--command", &program]);
    }
}

/// Windows repeated with a different end, linear interpolation of inputs, and substeps of a
/// participant.
#[test]
fn adaptive_windows_and_subcycles_replay_to_the_bit() {
    let place = Place::new();
    let settings = ["time.control=adaptive", "time.tolerance=1e-2", "source.substeps=3"];
    let settings = [&settings[..], &["coupling.interpolation=linear", "time.end=10"]].concat();
    let recording = record(&place, "lumped.toml", "--record", &settings);
    let seen = inspect(&place, &recording, &[]);
    assert!(seen["repeated_windows"].as_u64().unwrap() > 0, "{seen:#}");
    for role in ["source", "body"] {
        let program = toy(role).join(" ");
        assert_identical(&place, &recording, role, &["--command", &program]);
    }
}

#[test]
fn what_was_mapped_replays_to_the_bit() {
    let place = Place::new();
    let recording = record(&place, "cold-start.toml", "--record", &["thermal.resolution=31"]);
    for role in ["mech", "thermal"] {
        assert_identical(&place, &recording, role, &[]);
    }
}

/// A moving grid, from the start and from a state in the middle.
#[test]
fn grids_that_move_replay_to_the_bit() {
    let place = Place::new();
    let recording = record(&place, "moving.toml", "--record", &["output.checkpoint_every=4"]);
    let seen = inspect(&place, &recording, &[]);
    let topics = seen["fields"].as_array().unwrap().iter();
    assert!(topics.clone().any(|f| f["topic"].as_str().unwrap().starts_with("geometry/")));
    for role in ["mover", "plate"] {
        let program = toy(role).join(" ");
        assert_identical(&place, &recording, role, &["--command", &program]);
        assert_identical(&place, &recording, role, &["--from", "6", "--command", &program]);
    }
}

/// One participant only observes: all its results, in each window, are available for comparison.
/// The run writes the same files as one without recording.
#[test]
fn a_one_way_transient_is_compared_in_every_window() {
    let place = Place::new();
    let last_only = ["output.every=1000"];
    let recording = record(&place, "cold-start.toml", "--record", &last_only);
    let windows = place.read_summary()["coupling"]["windows"].as_u64().unwrap();
    let seen = inspect(&place, &recording, &[]);
    let of_thermal = |field: &&Value| field["topic"].as_str().unwrap().contains("/thermal/");
    let fields: Vec<&Value> =
        seen["fields"].as_array().unwrap().iter().filter(of_thermal).collect();
    assert!(windows > 40 && fields.len() > 1, "{seen:#}");
    assert!(fields.iter().all(|field| field["samples"] == windows), "{seen:#}");
    let replay = assert_identical(&place, &recording, "thermal", &[]);
    assert_eq!(replay["comparison"]["samples"], windows * fields.len() as u64, "{replay:#}");
    let written = |place: &Place| {
        let files = std::fs::read_dir(place.out().join("fields")).unwrap().flatten();
        let mut names: Vec<_> = files.map(|file| file.file_name()).collect();
        names.sort();
        names
    };
    let plain = Place::new();
    plain.summary(&case("cold-start.toml"), &sets(&last_only));
    assert_eq!(written(&place), written(&plain));
    for name in written(&plain) {
        let read = |place: &Place| std::fs::read(place.out().join("fields").join(&name)).unwrap();
        assert!(read(&place) == read(&plain), "{name:?} differs in a recorded run");
    }
}

/// A program with different models gets a message that says which model to choose, and how.
#[test]
fn a_program_that_does_not_know_the_recorded_model_is_told_what_to_do() {
    let place = Place::new();
    let recording = record(&place, "wheel-rail.toml", "--record", &["mech.model=hertz-carter"]);
    let compiled = Compiled::from("proto/c/examples/closed_form.c");
    let program = compiled.path();
    let (code, _, stderr) = replay(&place, &recording, "thermal", &["--command", &program]);
    assert_eq!(code, Some(2), "{stderr}");
    for words in [
        "`closed-form` has no model `columns`, which is in the recorded configuration of thermal",
        "--set thermal.model=NAME (ertz-knothe)",
        "replay with the program that was recorded, `thermal-solver`",
    ] {
        assert!(stderr.contains(words), "{stderr}");
    }
    let chosen = ["--set", "thermal.model=ertz-knothe", "--tolerance", "1", "--command", &program];
    let (code, replay, stderr) = self::replay(&place, &recording, "thermal", &chosen);
    // The fields are on different grids: this is a difference at any tolerance.
    assert_eq!(code, Some(4), "{stderr}");
    assert!(stderr.contains("its grids, or the places of its fields"), "{stderr}");
    assert_eq!(replay["program"], "closed-form 1.0", "{stderr}");
    let remark = "`lower_section_temperature` is not compared: the program does not provide it";
    assert!(replay["remarks"].as_array().unwrap().iter().any(|one| one == remark), "{replay:#}");
    assert!(replay["comparison"]["samples"].as_u64().unwrap() > 0, "{replay:#}");
    let (left, right) = (toy("left").join(" "), toy("right").join(" "));
    for program in [left, right] {
        let (code, _, stderr) =
            self::replay(&place, &recording, "thermal", &["--command", &program]);
        assert_eq!(code, Some(2), "{stderr}");
        assert!(stderr.contains("not `thermal`; give a program that does"), "{stderr}");
    }
    place.assert_nothing_left();
}

#[test]
fn a_changed_material_is_named_where_it_first_shows() {
    let place = Place::new();
    let recording = record(&place, "falling-friction.toml", "--record", &["output.fields=none"]);
    let changed = ["--set", "materials.steel.specific_heat=420"];
    let (code, replay, stderr) = replay(&place, &recording, "thermal", &changed);
    assert_eq!(code, Some(4), "{stderr}");
    let comparison = &replay["comparison"];
    let first = &comparison["first"];
    assert_eq!((&first["window"], &first["iteration"]), (&0.into(), &1.into()), "{replay:#}");
    assert!(first["field"].as_str().unwrap().ends_with("_temperature"));
    // The rise is proportional to one over the root of the specific heat.
    let ratio = first["now"].as_f64().unwrap() / first["recorded"].as_f64().unwrap();
    assert!((ratio - (419.5_f64 / 420.0).sqrt()).abs() < 1e-4, "{ratio}");
    assert!(!comparison["growth"]["steps"].as_array().unwrap().is_empty());
    let line = stderr.lines().find(|line| line.starts_with("error: the replay differs")).unwrap();
    assert!(line.contains("window 0, iteration 1: ") && line.contains("recorded"), "{line}");
    // A sufficiently large tolerance accepts the difference.
    let loose = [&changed[..], &["--tolerance", "1e-3"]].concat();
    let (code, replay, stderr) = self::replay(&place, &recording, "thermal", &loose);
    assert_eq!(code, Some(0), "{replay:#} {stderr}");
    assert!(replay["comparison"]["largest"].as_f64().unwrap() > 1e-4);
}

/// Only the coordinator and the replayed program are available, and no file of the case.
#[test]
fn the_partner_need_not_be_there() {
    let place = Place::new();
    let recording = record(&place, "falling-friction.toml", "--record", &[]);
    let lonely = tempfile::tempdir().unwrap();
    for name in ["coordinator", "thermal-solver"] {
        std::fs::copy(programs().join(name), lonely.path().join(name)).unwrap();
    }
    std::fs::copy(&recording, lonely.path().join("r.mcap")).unwrap();
    let runtime = tempfile::Builder::new().prefix("ct-").tempdir_in("/dev/shm").unwrap();
    let ended = std::process::Command::new(lonely.path().join("coordinator"))
        .args(["replay", "r.mcap", "--only", "thermal"])
        .env("COSIM_RUNTIME_DIR", runtime.path().join("r"))
        .env("PATH", "")
        .current_dir(lonely.path())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&ended.stdout);
    assert!(ended.status.success() && text.contains("bit-identical"), "{text}");
}

/// Replays from a state in the middle, up to a window, and with the recordings of a killed and
/// resumed run.
#[test]
fn a_replay_begins_at_a_recorded_state() {
    let place = Place::new();
    let settings = ["output.checkpoint_every=10", "output.every=1"];
    let recording = record(&place, "cold-start.toml", "--record", &settings);
    for role in ["mech", "thermal"] {
        let replay = assert_identical(&place, &recording, role, &["--from", "35", "--until", "42"]);
        assert_eq!(replay["from_window"], 30, "{replay:#}");
        assert_eq!(replay["solves"], 13, "{replay:#}");
    }
    // If no state is early enough, a remark says so and all windows are solved.
    let early = assert_identical(&place, &recording, "thermal", &["--from", "4"]);
    assert!(early["remarks"][0].as_str().unwrap().contains("no state before window 4"));
}

#[test]
fn a_killed_and_resumed_run_is_recorded_in_two_files_that_replay() {
    let place = Place::new();
    let slow = ["output.checkpoint_every=3", "time.window=2e-6", "output.every=10"];
    let slow = [&slow[..], &["mech.resolution=10"]].concat();
    let more: Vec<&str> = ["--record"].into_iter().chain(sets(&slow)).collect();
    let running = place.start_run(&case("cold-start.toml"), &more);
    let first = place.out().join("recording.mcap");
    let length = || std::fs::metadata(&first).map_or(0, |file| file.len());
    wait_until("a recording of some length", || length() > 400_000);
    running.signal(Signal::KILL);
    let killed = running.wait().code.is_none();
    place.assert_nothing_left();
    assert!(killed, "the run was over before it could be killed");
    let seen = inspect(&place, &first, &[]);
    assert_eq!(seen["complete"], false, "{seen:#}");
    assert_identical(&place, &first, "mech", &[]);
    let out = place.out().display().to_string();
    // A recorded run is recorded on, without being asked to.
    let ended = place.start(&["run", "--resume", &out]).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let names = std::fs::read_dir(place.out()).unwrap().flatten();
    let second = names
        .filter_map(|entry| entry.file_name().into_string().ok())
        .find(|name| name.starts_with("recording-0") && name.ends_with(".mcap"))
        .unwrap();
    for role in ["mech", "thermal"] {
        assert_identical(&place, &place.out().join(&second), role, &[]);
    }
}

/// The run fails, and the recording shows where; a replay of the failed participant fails again.
#[test]
fn a_failed_run_leaves_a_recording_that_reads() {
    let place = Place::new();
    let faulty = ["right.fault=not-finite", "right.fault_window=3"];
    let more: Vec<&str> = ["--record"].into_iter().chain(sets(&faulty)).collect();
    let ended = place.run(&case("exchange.toml"), &more);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    place.assert_nothing_left();
    let recording = place.out().join("recording.mcap");
    let seen = inspect(&place, &recording, &[]);
    assert_eq!(seen["complete"], true);
    let error = seen["error"].as_str().unwrap();
    assert!(error.contains("right") && error.contains("window 3"), "{error}");
    let broken = seen["fields"].as_array().unwrap().iter().find(|f| !f["non_finite_at"].is_null());
    assert!(broken.is_some(), "{seen:#}");
    let shown = place.start(&["inspect", &recording.display().to_string()]).wait();
    assert!(shown.stdout.contains("FAILED") && shown.stdout.contains("NOT FINITE"));
}

/// Fields have the names of the case's bodies, in a listing and as an option.
#[test]
fn fields_are_inspected_by_the_names_of_the_case() {
    let place = Place::new();
    let more = ["--record", "--set", "mech.resolution=8"];
    assert_eq!(place.run(&case("falling-friction.toml"), &more).code, Some(0));
    let recording = place.out().join("recording.mcap").display().to_string();
    let shown =
        |more: &[&str]| place.start(&[&["inspect", &recording], more].concat()).wait().stdout;
    let listed = shown(&[]);
    assert!(listed.contains("thermal/rail_temperature"), "{listed}");
    assert!(!listed.contains("lower_") && !listed.contains("upper_"), "{listed}");
    let samples = shown(&["--field", "rail_temperature"]);
    assert!(samples.contains("  thermal/rail_temperature "), "{samples}");
    assert_eq!(samples, shown(&["--field", "lower_temperature"]));
}

/// A full disk ends the run in order, and the part written before is readable.
#[test]
fn a_full_disk_ends_the_run_in_order() {
    let place = Place::new();
    let (program, case) = (programs().join("coordinator"), case("cold-start.toml"));
    let runtime = tempfile::Builder::new().prefix("ct-").tempdir_in("/dev/shm").unwrap();
    let mut child = std::process::Command::new("bash")
        // A limit on the file size simulates a full disk; its signal is ignored.
        .args(["-c", "trap '' XFSZ; exec \"$@\"", "bash"])
        .arg(program)
        .args(["run", &case, "--record"])
        .args(["--set", "time.window=1e-7", "--set", "output.every=100000", "--out"])
        .arg(place.out())
        .env("COSIM_RUNTIME_DIR", runtime.path().join("r"))
        .current_dir(root())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    place.wait_for_log("every participant is ready");
    let pid = Pid::from_raw(child.id() as i32).unwrap();
    let limit = Rlimit { current: Some(1 << 20), maximum: Some(1 << 20) };
    prlimit(Some(pid), Resource::Fsize, limit).unwrap();
    wait_until("the end of the run", || child.try_wait().unwrap().is_some());
    let ended = child.wait_with_output().unwrap();
    let stderr = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("the recording failed at"), "{stderr}");
    place.assert_nothing_left();
    let seen = inspect(&place, &place.out().join("recording.mcap"), &[]);
    assert_eq!(seen["complete"], false);
}

/// The recording contains no names of folders, of the user or of the machine. Files named by the
/// case are included.
#[test]
fn a_recording_carries_no_path_and_replays_without_the_files_of_the_case() {
    let place = Place::new();
    let secret = tempfile::Builder::new().prefix("secret-folder-").tempdir().unwrap();
    for name in ["rail-worn.csv", "wheel-hollow.csv"] {
        std::fs::copy(root().join("cases/profiles").join(name), secret.path().join(name)).unwrap();
    }
    let file = |key: &str, name: &str| format!("{key}={:?}", secret.path().join(name));
    let rail = file("bodies.rail.profile", "rail-worn.csv");
    let wheel = file("bodies.wheel.profile", "wheel-hollow.csv");
    let command = format!("thermal.command=[{:?}]", programs().join("thermal-solver"));
    let settings = [rail.as_str(), &wheel, &command, "mech.resolution=10"];
    let recording = record(&place, "measured-profile.toml", "--record", &settings);
    let bytes = std::fs::read(&recording).unwrap();
    let holds = |text: &str| bytes.windows(text.len()).any(|part| part == text.as_bytes());
    assert!(
        holds("rail-worn.csv") && holds("bodies.rail.profile"),
        "the search finds what is there"
    );
    let user = std::env::var("USER").ok().filter(|user| user.len() > 4);
    let home = std::env::var("HOME").ok();
    let manifest = root().display().to_string();
    let folders = ["secret-folder", "/dev/shm", "cosim_", manifest.as_str()].map(str::to_owned);
    for word in folders.into_iter().chain(user).chain(home) {
        assert!(!holds(&word), "the recording holds {word}");
    }
    drop(secret);
    assert_identical(&place, &recording, "mech", &[]);
}

/// Export equals the files written by the run.
#[test]
fn an_export_holds_what_the_run_wrote() {
    let place = Place::new();
    let recording = record(&place, "wheel-rail.toml", "--record", &[]);
    let (vtk, csv) = (place.out().join("vtk"), place.out().join("csv"));
    let paths = [&recording, &vtk, &csv].map(|path| path.display().to_string());
    let ended = place.start(&["export", &paths[0], "--vtk", &paths[1], "--csv", &paths[2]]).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    for (file, head) in
        [("mech_contact", "pressure [Pa]"), ("mech_passage", "friction_power [W/m2]")]
    {
        let file = format!("{file}_000000.csv");
        let [ours, exported] =
            [&place.out().join("fields"), &vtk].map(|folder| Table::read(&folder.join(&file)));
        assert_eq!(ours.texts("x [m]"), exported.texts("x [m]"));
        assert_eq!(ours.texts(head), exported.texts(head), "{head}");
    }
    assert!(
        vtk.join("thermal_contact_000000.vti").is_file() && vtk.join("mech_contact.pvd").is_file()
    );
    let power = Table::read(&csv.join("mech_friction_power_000000.csv"));
    let largest = power.numbers("friction_power [W/m2]").into_iter().fold(0.0, f64::max);
    let seen = inspect(&place, &recording, &["--field", "friction_power", "--window", "0"]);
    let fields = seen["fields"].as_array().unwrap();
    let of = fields.iter().find(|f| f["topic"] == "field/mech/friction_power").unwrap();
    assert_eq!(of["max"].as_f64(), Some(largest));
    let samples = seen["details"]["samples"].as_array().unwrap();
    assert!(samples.iter().all(|s| s["topic"] == "field/mech/friction_power"));
    assert_eq!(samples.len(), 2, "before the solve and after it");
}

/// The recording plays the partner of a solver that is started by hand.
#[test]
fn a_solver_started_by_hand_is_served() {
    let place = Place::new();
    let recording = record(&place, "falling-friction.toml", "--record", &[]);
    let path = recording.display().to_string();
    let serving = place.start(&["replay", &path, "--only", "thermal", "--serve"]);
    let runs = place.runtime();
    // A folder whose name starts with a dot is incomplete; it is renamed when complete.
    let folder = || {
        let complete = |p: &std::path::Path| {
            let name = p.file_name().and_then(|n| n.to_str());
            name.is_some_and(|n| !n.starts_with('.')) && p.join("run.json").is_file()
        };
        std::fs::read_dir(&runs).ok()?.flatten().map(|e| e.path()).find(|p| complete(p))
    };
    wait_until("the run's folder", || folder().is_some());
    let solver = std::process::Command::new(programs().join("thermal-solver"))
        .arg("--join")
        .arg(folder().unwrap())
        .args(["--role", "thermal"])
        .status()
        .unwrap();
    assert!(solver.success());
    let ended = serving.wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.contains("bit-identical"), "{}", ended.stdout);
    assert!(ended.stderr.contains("--join"), "{}", ended.stderr);
    place.assert_nothing_left();
}

#[test]
fn what_cannot_be_replayed_is_told() {
    let place = Place::new();
    let recording = record(&place, "exchange.toml", "--record", &["time.end=5"]);
    let told = |arguments: &[&str], code: i32, text: &str| {
        let ended = place.start(arguments).wait();
        assert_eq!(ended.code, Some(code), "{arguments:?}: {}", ended.stderr);
        assert!(ended.stderr.contains(text), "{arguments:?}: {}", ended.stderr);
    };
    let path = recording.display().to_string();
    told(&["replay", &path, "--only", "middle"], 2, "give --only one of: left, right");
    told(&["replay", "nowhere.mcap", "--only", "left"], 2, "there is no recording nowhere.mcap");
    told(&["inspect", &case("linear.toml")], 1, "damaged");
    let (left, right) = (toy("left").join(" "), toy("right").join(" "));
    let other = ["replay", &path, "--only", "left", "--command", &right];
    let ended = place.start(&other).wait();
    assert_ne!(ended.code, Some(0), "another program passes for the recorded one");
    let tolerance = ["replay", &path, "--only", "left", "--command", &left, "--tolerance=-1"];
    told(&tolerance, 2, "--tolerance must be a number of at least 0");
    let set = ["replay", &path, "--only", "left", "--command", &left, "--set", "no.key=1"];
    told(&set, 2, "the recorded configuration of left has no `no.key`");
    place.assert_nothing_left();
}

/// A recording truncated at any place is compared up to the cut, and the result says so.
#[test]
fn a_cut_recording_is_compared_up_to_the_cut() {
    let place = Place::new();
    let settings = ["time.end=40", "left.points=50", "right.points=50"];
    let whole = std::fs::read(record(&place, "exchange.toml", "--record", &settings)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.mcap");
    let (mut compared, program) = (0, toy("left").join(" "));
    for part in 10..39 {
        std::fs::write(&path, &whole[..whole.len() * part / 40]).unwrap();
        let (code, replay, stderr) = replay(&place, &path, "left", &["--command", &program]);
        // If the cut is before the first window, there is nothing to compare.
        assert!(matches!(code, Some(0 | 2)), "part {part}: {code:?} {replay:#} {stderr}");
        compared += u64::from(code == Some(0) && replay["cut"] == true);
    }
    assert!(compared > 10, "{compared}");
}
