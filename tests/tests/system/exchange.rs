//! Exchange of fields: three processes, two fields, many windows.

use crate::harness::{Place, case, sets, toy};

#[test]
fn every_window_passes_through_both_participants() {
    let place = Place::new();
    let more = ["--set", "time.end=250", "--set", "output.fields=all"];
    let summary = place.summary(&case("exchange.toml"), &more);
    assert_eq!(summary["status"], "completed");
    assert_eq!(summary["coupling"]["windows"], 250);
    assert_eq!(summary["left"]["solves"], 250);
    assert_eq!(summary["right"]["solves"], 250);
    // 1000 doubles each way, for the first outputs and for every window.
    assert_eq!(summary["cost"]["bytes_exchanged"], 2 * 8 * 1000 * 251);
    let table = std::fs::read_to_string(place.out().join("iterations.csv")).unwrap();
    assert_eq!(table.lines().count(), 251);
    assert_eq!(last_value(&place, "left_numbers_000249.vti"), 499.0);
    assert_eq!(last_value(&place, "right_numbers_000249.vti"), 500.0);
}

/// Last double of the appended data.
fn last_value(place: &Place, file: &str) -> f64 {
    let bytes = std::fs::read(place.out().join("fields").join(file)).unwrap();
    let tail = b"\n  </AppendedData>\n</VTKFile>\n";
    let data = bytes.strip_suffix(tail.as_slice()).unwrap();
    f64::from_le_bytes(*data.last_chunk::<8>().unwrap())
}

#[test]
fn different_sizes_each_way() {
    let place = Place::new();
    let sizes = ["--set", "left.points=2", "--set", "right.points=30000", "--set", "time.end=3"];
    let summary = place.summary(&case("exchange.toml"), &sizes);
    assert_eq!(summary["cost"]["bytes_exchanged"], 4 * 8 * 30_002);
}

#[test]
fn a_participant_started_by_hand_is_waited_for() {
    let place = Place::new();
    let attach = ["--set", "left.attach=true", "--set", "time.end=5", "--log", "warn"];
    let running = place.start_run(&case("exchange.toml"), &attach);
    let folder = place.waiting_for("left");
    let [program, name] = toy("left");
    let by_hand = std::process::Command::new(program)
        .args([&name, "--join", &folder, "--role", "left"])
        .status();
    assert!(by_hand.unwrap().success());
    let ended = running.wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stderr.contains("--role left"), "the user is told what to start");
    place.assert_nothing_left();
}

/// Both participants add one: the loop has no fixed point, and the iteration chosen by `auto`
/// stops.
#[test]
fn a_loop_is_iterated_unless_the_user_wants_one_pass() {
    let place = Place::new();
    let auto = ["--set", "coupling.scheme=auto"];
    let plan = place.start(&[&["plan", &case("exchange.toml")], &auto[..]].concat()).wait().stdout;
    let reason = "serial-implicit: `right_value` from `right` closes a loop";
    assert!(plan.contains(reason), "{plan}");
    let ended = place.run(&case("exchange.toml"), &auto);
    assert_eq!(ended.code, Some(3), "{}", ended.stderr);
    assert!(ended.stderr.contains("in window 0, iteration 100"), "{}", ended.stderr);
    place.assert_nothing_left();
}

/// Each window of a parallel scheme adds one to the previous value of the other participant.
#[test]
fn a_parallel_pass_uses_what_was_there_before() {
    let place = Place::new();
    let more = ["coupling.scheme=parallel-explicit", "time.end=250", "output.fields=all"];
    let summary = place.summary(&case("exchange.toml"), &sets(&more));
    assert_eq!(summary["coupling"]["scheme"], "parallel-explicit");
    assert_eq!(last_value(&place, "left_numbers_000249.vti"), 250.0);
    assert_eq!(last_value(&place, "right_numbers_000249.vti"), 250.0);
}
