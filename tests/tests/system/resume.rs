//! Restart: a run that is killed and resumed gives the same results as an uninterrupted run, bit
//! for bit.

use crate::harness::{Ended, Place, Table, case, field_files, sets, wait_until};
use rustix::process::Signal;
use serde_json::Value;
use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;

/// Results of a run that do not depend on the speed of the machine.
#[derive(Debug, PartialEq)]
struct Results {
    /// Content of every field file.
    fields: Vec<(String, Vec<u8>)>,
    /// Table of iterations without run times.
    table: Table,
    /// Figures of every window.
    history: Table,
    /// Summary, with the cost reduced to the bytes exchanged.
    summary: Value,
}

fn results(place: &Place) -> Results {
    let timeless = |head: &str| !head.ends_with("_s") || head == "start_s" || head == "end_s";
    let mut summary = place.read_summary();
    let cost = summary.as_object_mut().unwrap().remove("cost").unwrap();
    summary["bytes_exchanged"] = cost["bytes_exchanged"].clone();
    let table = place.table("iterations.csv").of(timeless);
    let history = place.table("history.csv");
    Results { fields: field_files(&place.out()), table, history, summary }
}

fn resume(place: &Place) -> Ended {
    place.start(&["run", "--resume", &place.out().display().to_string()]).wait()
}

/// Names of the checkpoints, oldest first.
fn checkpoints(out: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(out.join("checkpoints")).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries
        .filter_map(|e| e.file_name().into_string().ok())
        .filter(|name| !name.ends_with(".new"))
        .collect();
    names.sort();
    names
}

/// Kills a run after this many checkpoints; true if it was still running.
fn kill_at(place: &Place, case: &str, more: &[&str], written: u64) -> bool {
    let running = place.start_run(case, more);
    let count = || {
        let log = place.log();
        let is = |event: &&Value| event["fields"]["message"] == "checkpoint written";
        log.iter().filter(is).count() as u64
    };
    wait_until("a checkpoint", || count() >= written || place.out().join("summary.json").exists());
    running.signal(Signal::KILL);
    let ended = running.wait();
    place.assert_nothing_left();
    ended.code.is_none()
}

/// splitmix64: random windows, the same in every run of the tests.
fn random(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// Runs a case without interruption, and another time killed after a random number of checkpoints
/// and resumed; asserts equal results.
pub(crate) fn killed_and_resumed(case: &str, settings: &[&str], most: u64, seed: &mut u64) {
    let more = sets(settings);
    let undisturbed = Place::new();
    undisturbed.summary(case, &more);
    let expected = results(&undisturbed);
    let place = Place::new();
    // On a fast machine the run may end before it is killed.
    let killed = (0..20).any(|_| kill_at(&place, case, &more, 1 + random(seed) % most));
    assert!(killed, "{settings:?}: never killed in time");
    let ended = resume(&place);
    assert_eq!(ended.code, Some(0), "{settings:?}: {}", ended.stderr);
    place.assert_nothing_left();
    let found = results(&place);
    assert_eq!(found.summary, expected.summary, "{settings:?}");
    assert_eq!(found.table, expected.table, "{settings:?}");
    assert_eq!(found.history, expected.history, "{settings:?}");
    assert!(found.fields == expected.fields, "{settings:?}: a field file differs");
    assert!(
        found.summary["coupling"]["windows"].as_u64()
            > place.read_summary()["cost"]["resumed_at_window"].as_u64()
    );
}

/// History of an accelerator, with fields and tables.
#[test]
fn a_loop_with_memory_survives_a_kill() {
    let settings = [
        "coupling.acceleration=iqn-ils",
        "coupling.predictor=linear",
        "linear.problem=P4",
        "linear.size=500",
        "coupling.relative=1e-9",
        "time.end=60",
        "output.fields=all",
        "output.every=7",
        "output.checkpoint_every=5",
    ];
    killed_and_resumed(&case("linear.toml"), &settings, 10, &mut 4);
}

/// The real solvers: mechanics without memory, a thermal solver with memory of all windows.
#[test]
fn a_transient_of_the_real_solvers_survives_a_kill() {
    let settings = ["mech.resolution=16", "output.every=5", "output.checkpoint_every=3"];
    killed_and_resumed(&case("cold-start.toml"), &settings, 8, &mut 3);
}

/// Long run that was killed after at least two checkpoints.
fn killed(settings: &[&str]) -> Place {
    let place = Place::new();
    let all =
        [&["time.end=400", "left.delay=1 ms", "output.checkpoint_every=10"], settings].concat();
    assert!(kill_at(&place, &case("exchange.toml"), &sets(&all), 4));
    assert_eq!(checkpoints(&place.out()).len(), 2, "the last two are kept");
    place
}

fn torn_checkpoint(file: &str) {
    let undisturbed = Place::new();
    let settings = ["time.end=400", "left.delay=1 ms", "output.checkpoint_every=10"];
    undisturbed.summary(&case("exchange.toml"), &sets(&settings));
    let place = killed(&[]);
    let names = checkpoints(&place.out());
    let path = place.out().join("checkpoints").join(&names[1]).join(file);
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() - 3]).unwrap();
    let ended = resume(&place);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let told = format!("checkpoint {} is not used: {file} is corrupt", names[1]);
    assert!(ended.stderr.contains(&told), "{}", ended.stderr);
    assert!(ended.stderr.contains("using the previous one"), "{}", ended.stderr);
    let at: u64 = names[0].parse().unwrap();
    assert_eq!(place.read_summary()["cost"]["resumed_at_window"], at);
    assert_eq!(results(&place), results(&undisturbed));
}

table_of_tests! { torn_checkpoint:
    a_torn_checkpoint_of_a_participant_is_named_and_the_one_before_used("left.state");
    a_torn_checkpoint_of_a_field_is_named_and_the_one_before_used("right_value.values");
    a_torn_checkpoint_of_the_coordinator_is_named_and_the_one_before_used("coordinator.state");
}

#[test]
fn without_a_whole_checkpoint_nothing_is_resumed() {
    let place = killed(&[]);
    for name in checkpoints(&place.out()) {
        std::fs::write(place.out().join("checkpoints").join(name).join("left.state"), "x").unwrap();
    }
    let ended = resume(&place);
    assert_eq!(ended.code, Some(2));
    assert!(ended.stderr.contains("no intact checkpoint"), "{}", ended.stderr);
    let none = Place::new();
    let fails = ["--set", "time.end=3", "--set", "left.fault=exit"];
    assert_eq!(none.run(&case("exchange.toml"), &fails).code, Some(1));
    let ended = resume(&none);
    assert_eq!(ended.code, Some(2));
    assert!(ended.stderr.contains("output.checkpoint_every"), "{}", ended.stderr);
}

#[test]
fn another_case_is_refused_and_a_run_that_has_ended_stays() {
    let place = killed(&[]);
    let file = place.out().join("case.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.replace("end = 400", "end = 500")).unwrap();
    let ended = resume(&place);
    assert_eq!(ended.code, Some(2));
    assert!(ended.stderr.contains("case.toml is not the case"), "{}", ended.stderr);
    std::fs::write(&file, text).unwrap();
    assert_eq!(resume(&place).code, Some(0));
    let before = std::fs::read(place.out().join("summary.json")).unwrap();
    let ended = resume(&place);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.contains("has already finished"), "{}", ended.stdout);
    assert_eq!(std::fs::read(place.out().join("summary.json")).unwrap(), before);
    let both = ["run", "x.toml", "--resume", "y"];
    assert_eq!(place.start(&both).wait().code, Some(2), "either a case or a run");
}

/// A participant that dies does not destroy earlier results.
#[test]
fn a_run_that_failed_can_be_resumed_and_ends_alike() {
    let place = Place::new();
    let settings = ["time.end=400", "left.delay=1 ms", "output.checkpoint_every=10"];
    let running = place.start_run(&case("exchange.toml"), &sets(&settings));
    wait_until("a checkpoint", || !checkpoints(&place.out()).is_empty());
    rustix::process::kill_process(place.pid_of("right"), Signal::KILL).unwrap();
    assert_eq!(running.wait().code, Some(1));
    assert_eq!(place.read_summary()["status"], "failed");
    assert_eq!(resume(&place).code, Some(0));
    assert_eq!(place.read_summary()["left"]["solves"], 400);
    place.assert_nothing_left();
}

/// A stopped run reports this in its summary and by its exit code, and can be resumed.
#[test]
fn an_interrupted_run_is_resumed() {
    for (signal, code) in [(Signal::INT, 130), (Signal::TERM, 143)] {
        let place = Place::new();
        let settings = ["time.end=400", "left.delay=1 ms", "output.checkpoint_every=10"];
        let running = place.start_run(&case("exchange.toml"), &sets(&settings));
        wait_until("a checkpoint", || !checkpoints(&place.out()).is_empty());
        running.signal(signal);
        let ended = running.wait();
        assert_eq!(ended.code, Some(code), "{}", ended.stderr);
        assert_eq!(place.read_summary()["status"], "interrupted");
        assert_eq!(resume(&place).code, Some(0));
        assert_eq!(place.read_summary()["left"]["solves"], 400);
        place.assert_nothing_left();
    }
}

/// The path of a state is sent to participants in JSON, which is UTF-8. The result folder and the
/// folder of the case may have names that are not.
#[test]
fn a_folder_whose_name_is_no_text_holds_checkpoints() {
    let place = Place::new();
    let odd = place.out().join(OsStr::from_bytes(b"odd \xff"));
    std::fs::create_dir_all(&odd).unwrap();
    std::fs::copy(case("exchange.toml"), odd.join("exchange.toml")).unwrap();
    let settings = ["time.end=400", "left.delay=1 ms", "output.checkpoint_every=10"];
    let mut run = place.command(&["run", "exchange.toml"]);
    run.args(sets(&settings)).arg("--out").arg(odd.join("out")).current_dir(&odd);
    let running = place.launch(run);
    wait_until("a checkpoint", || !checkpoints(&odd.join("out")).is_empty());
    running.signal(Signal::KILL);
    running.wait();
    let mut resume = place.command(&["run", "--resume"]);
    resume.arg(odd.join("out"));
    let ended = place.launch(resume).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let summary = std::fs::read(odd.join("out/summary.json")).unwrap();
    let summary: Value = serde_json::from_slice(&summary).unwrap();
    assert_eq!(summary["left"]["solves"], 400);
    assert!(summary["cost"]["resumed_at_window"].as_u64() > Some(0));
}

/// Relative file names refer to the folder of the case file, even if the run is resumed from a
/// different folder.
#[test]
fn files_of_the_case_are_found_again() {
    let place = Place::new();
    let settings = [
        "mech.resolution=10",
        "time.mode=transient",
        "time.window=20 us",
        "time.end=1 ms",
        "output.checkpoint_every=1",
    ];
    assert!(kill_at(&place, &case("measured-profile.toml"), &sets(&settings), 2));
    let ended = resume(&place);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(place.read_summary()["coupling"]["windows"], 50);
}
