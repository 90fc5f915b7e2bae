//! Every command of the protocol, with every fault of the participant that receives it: the error
//! names participant, phase and fault, and nothing is left.

use crate::harness::{Place, case, sets};

/// Faults of any command, and the words of each in the message.
const FAULTS: [(&str, &str); 9] = [
    ("exit", "its process ended with exit code 3"),
    ("busy", "its heartbeat is still received; raise coupling."),
    ("silent", "no heartbeat for 1."),
    ("lost-reply", "its reply did not arrive"),
    ("failed", "on purpose"),
    ("refused", "on purpose"),
    ("status", "it replied with the unknown status 9"),
    ("protocol", "it speaks protocol 0"),
    ("sequence", "it answered command"),
];

table_of_tests! {
    fault_named_at:
    describe_fails("Describe", "while being configured");
    configure_fails("Configure", "while being configured");
    connect_fails("Connect", "while connecting");
    initialise_fails("Initialise", "while building its model");
    solve_fails("Solve", "in window 0, iteration 1");
    accept_fails("Accept", "while accepting window 0");
    save_fails("Save", "while saving its state after window 0");
    finish_fails("Finish", "while finishing");
}

fn fault_named_at(kind: &str, phase: &str) {
    for (fault, words) in FAULTS {
        assert_named(kind, phase, fault, words);
    }
}

/// The rogue writes no state.
#[test]
fn a_state_that_is_not_written_is_named() {
    let phase = "while saving its state after window 0";
    assert_named("Save", phase, "none", "it replied to Save without a file of its state");
}

/// Bodies of replies are data of another program.
#[test]
fn a_body_that_cannot_be_read_is_named() {
    assert_named("Describe", "while being configured", "body", "its description is not valid");
    assert_named("Configure", "while being configured", "body", "its layout is not valid");
    assert_named("Finish", "while finishing", "body", "its summary is not valid");
}

/// Runs three windows with a participant that has this fault at each command of this kind.
fn assert_named(kind: &str, phase: &str, fault: &str, words: &str) {
    let place = Place::new();
    let command = format!("left.command=[\"toy\", \"rogue\", \"at={kind}:{fault}\"]");
    let mut settings = vec!["time.end=3", "left.points=10", &command];
    settings.extend((kind == "Save").then_some("output.checkpoint_every=1"));
    settings.extend(match (fault, kind) {
        ("silent", _) => Some("coupling.heartbeat_deadline=1.5"),
        ("busy", "Describe" | "Configure" | "Connect") => Some("coupling.start_deadline=3"),
        ("busy", "Initialise") => Some("coupling.build_deadline=1"),
        ("busy", _) => Some("coupling.solve_deadline=1"),
        _ => None,
    });
    let ended = place.run(&case("exchange.toml"), &sets(&settings));
    let (told, code) = (&ended.stderr, if fault == "refused" { 2 } else { 1 });
    assert_eq!(ended.code, Some(code), "{kind}:{fault}: {told}");
    let mut parts = vec![words];
    if fault != "refused" {
        parts.extend(["left (toy) failed", phase]);
    }
    for part in parts {
        assert!(told.contains(part), "{kind}:{fault}: `{part}` is missing in: {told}");
    }
    place.assert_nothing_left();
}
