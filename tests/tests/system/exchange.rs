//! The exchange itself: three processes, two fields, many windows.

use crate::harness::{Place, case};

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

/// The last double of the appended data.
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
    place.wait_for_log("participant started");
    let created = place.log().into_iter().find(|e| e["fields"]["message"] == "run created");
    let folder = created.unwrap()["fields"]["folder"].as_str().unwrap().to_owned();
    let by_hand = std::process::Command::new(crate::harness::programs().join("toy-left"))
        .args(["--join", &folder, "--role", "left"])
        .status();
    assert!(by_hand.unwrap().success());
    let ended = running.wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stderr.contains("--role left"), "the user is told what to start");
    place.assert_nothing_left();
}

#[test]
fn a_loop_needs_an_implicit_scheme_or_the_users_word() {
    let place = Place::new();
    let ended = place.run(&case("exchange.toml"), &["--set", "coupling.scheme=auto"]);
    assert_eq!(ended.code, Some(2));
    assert!(ended.stderr.contains("closes a loop"), "{}", ended.stderr);
    assert!(ended.stderr.contains("--set coupling.scheme=auto"), "{}", ended.stderr);
    place.assert_nothing_left();
}
