//! Every way in which a process may die: the right exit code, one line that says who, when and what
//! to do, and no leftovers on the machine.

use crate::harness::failures::failures_keep_their_words;
use crate::harness::{Ended, Place, Running, case, sets, toy, wait_until};
use rustix::process::{Signal, kill_process};
use tests::toy::SOLVING;

/// Makes the rogue the participant `left`.
const ROGUE: &str = "left.command=[\"toy\", \"rogue\"]";

/// Starts a run in which participant `role` takes long over the first window, and waits until it is
/// in that window.
fn in_mid_window<'a>(place: &'a Place, role: &str, more: &[&str]) -> Running<'a> {
    let delay = format!("{role}.delay=600");
    let mut arguments = vec!["--set", &delay];
    arguments.extend(more);
    let running = place.start_run(&case("exchange.toml"), &arguments);
    place.wait_for_log(SOLVING);
    running
}

fn assert_failed(place: &Place, ended: &Ended, parts: &[&str]) {
    assert_ended(place, ended, (1, "failed"), parts);
}

/// Asserts that a program failed before there was a run.
fn assert_refused_early(place: &Place, ended: &Ended, parts: &[&str]) {
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    for part in parts {
        assert!(ended.stderr.contains(part), "`{part}` is missing in: {}", ended.stderr);
    }
    assert!(!place.out().exists(), "nothing is written");
    place.assert_nothing_left();
}

fn assert_ended(place: &Place, ended: &Ended, (code, status): (i32, &str), parts: &[&str]) {
    assert_eq!(ended.code, Some(code), "{}", ended.stderr);
    let line = ended.stderr.lines().find(|line| line.starts_with("error: "));
    let line = line.unwrap_or_else(|| panic!("no error line in: {}", ended.stderr));
    for part in parts {
        assert!(line.contains(part), "`{part}` is missing in: {line}");
    }
    let log = format!("  log: {}", place.out().join("log.jsonl").display());
    assert!(ended.stderr.lines().any(|line| line == log), "{}", ended.stderr);
    place.assert_nothing_left();
    let summary = place.read_summary();
    assert_eq!(summary["status"], status);
    assert!(summary["reason"].as_str().unwrap().contains(parts[0]));
    assert!(place.out().join("iterations.csv").exists());
}

#[test]
fn a_killed_participant_is_named() {
    for role in ["left", "right"] {
        let place = Place::new();
        let running = in_mid_window(&place, role, &[]);
        kill_process(place.pid_of(role), Signal::KILL).unwrap();
        let who = format!("{role} (toy) failed");
        let what = ["in window 0, iteration 1", "killed by signal 9", "see its messages"];
        assert_failed(&place, &running.wait(), &[&who, what[0], what[1], what[2]]);
    }
}

#[test]
fn a_stopped_participant_is_noticed_by_its_silence() {
    for role in ["left", "right"] {
        let place = Place::new();
        let deadline = ["--set", "coupling.heartbeat_deadline=1.5"];
        let running = in_mid_window(&place, role, &deadline);
        kill_process(place.pid_of(role), Signal::STOP).unwrap();
        let who = format!("{role} (toy) failed");
        let what = ["in window 0, iteration 1", "no heartbeat for", "coupling.heartbeat_deadline"];
        assert_failed(&place, &running.wait(), &[&who, what[0], what[1], what[2]]);
    }
}

#[test]
fn a_hanging_model_is_noticed_by_its_deadline() {
    let place = Place::new();
    let more = ["--set", "left.fault=hang", "--set", "coupling.solve_deadline=1"];
    let ended = place.run(&case("exchange.toml"), &more);
    let what =
        ["in window 0, iteration 1", "its heartbeat is still received", "coupling.solve_deadline"];
    assert_failed(&place, &ended, &["left (toy) failed", what[0], what[1], what[2]]);
}

#[test]
fn participants_of_a_killed_coordinator_leave_by_themselves() {
    let place = Place::new();
    let running = in_mid_window(&place, "right", &[]);
    running.signal(Signal::KILL);
    assert_eq!(running.wait().code, None, "killed by a signal");
    place.assert_nothing_left();
}

#[test]
fn what_a_run_left_whose_processes_were_all_killed_is_removed_by_the_next() {
    let place = Place::new();
    let running = in_mid_window(&place, "left", &[]);
    let pids = [place.pid_of("left"), place.pid_of("right")];
    for pid in pids {
        kill_process(pid, Signal::STOP).unwrap();
    }
    running.signal(Signal::KILL);
    running.wait();
    for pid in pids {
        kill_process(pid, Signal::KILL).unwrap();
    }
    // A process holds its files until the last of its threads has ended.
    let gone = |pid: rustix::process::Pid| {
        let place = format!("/proc/{}", pid.as_raw_nonzero());
        let threads = std::fs::read_dir(format!("{place}/task")).map_or(0, Iterator::count);
        let stat = std::fs::read_to_string(format!("{place}/stat"));
        threads <= 1 && stat.map_or(true, |stat| stat.contains(") Z "))
    };
    wait_until("the end of the participants", || pids.iter().all(|pid| gone(*pid)));
    let prefix = place.created("prefix");
    let next = place.run(&case("exchange.toml"), &["--set", "time.end=2"]);
    assert_eq!(next.code, Some(0), "{}", next.stderr);
    let left: Vec<_> = std::fs::read_dir("/dev/shm")
        .unwrap()
        .flatten()
        .filter(|entry| entry.file_name().to_string_lossy().starts_with(&prefix))
        .collect();
    assert!(left.is_empty(), "{left:?}");
    place.assert_nothing_left();
}

#[test]
fn interrupts_end_everything_in_order() {
    for (signal, name, code) in [(Signal::INT, "Ctrl-C", 130), (Signal::TERM, "SIGTERM", 143)] {
        let place = Place::new();
        let running = in_mid_window(&place, "left", &[]);
        running.signal(signal);
        let interrupted = format!("interrupted by {name}");
        let what = ["in window 0, iteration 1", "every participant was shut down"];
        let parts = [&interrupted, what[0], what[1]];
        assert_ended(&place, &running.wait(), (code, "interrupted"), &parts);
    }
}

#[test]
fn a_participant_that_exits_is_named_with_its_last_words() {
    let cases = [
        ("exit-at-start", "while building its model", "ended with exit code 9"),
        ("exit", "in window 2, iteration 1", "ended with exit code 9"),
        ("panic", "in window 2, iteration 1", "ended with exit code 101"),
        ("error", "in window 2, iteration 1", "told to fail"),
    ];
    for (fault, when, what) in cases {
        let place = Place::new();
        let fault = format!("left.fault={fault}");
        let more = ["--set", &fault, "--set", "left.fault_window=2"];
        let ended = place.run(&case("exchange.toml"), &more);
        assert_failed(&place, &ended, &["left (toy) failed", when, what]);
    }
}

/// One participant fails while the other one is working: the error is not mistaken for a lost
/// message.
#[test]
fn a_failure_beside_one_still_at_work_keeps_its_words() {
    for (failing, working) in [("right", "left"), ("left", "right")] {
        let place = Place::new();
        let (fault, delay) = (format!("{failing}.fault=error"), format!("{working}.delay=0.3"));
        let settings = ["coupling.scheme=parallel-explicit", &fault, &delay];
        let ended = place.run(&case("exchange.toml"), &sets(&settings));
        let who = format!("{failing} (toy) failed");
        assert_failed(&place, &ended, &[&who, "in window 0, iteration 1", "told to fail"]);
    }
}

/// The nightly tests repeat this many more times, on busy processors.
#[test]
fn a_failing_participant_keeps_its_words() {
    failures_keep_their_words(24, 0);
}

#[test]
fn values_that_are_not_finite_are_refused() {
    for role in ["left", "right"] {
        let place = Place::new();
        let (fault, window) =
            (format!("{role}.fault=not-finite"), format!("{role}.fault_window=3"));
        let more = ["--set", &fault, "--set", &window];
        let ended = place.run(&case("exchange.toml"), &more);
        let who = format!("{role} (toy) failed");
        let what = format!("field `{role}_value` holds NaN at index 500");
        assert_failed(&place, &ended, &[&who, "in window 3, iteration 1", &what]);
    }
}

/// Values not written by a model, and reported heat or window wishes that are not numbers, are
/// errors. Earlier versions sent the data of a previous window, or ignored the number.
#[test]
fn what_a_model_leaves_out_is_noticed_in_every_build() {
    let faults = [
        ("unwritten", "output `left_value` was not written at index 0"),
        ("half-written", "output `left_value` was not written at index 507"),
        ("heat-is-no-number", "the model reports a received power of NaN W"),
        ("wish-is-no-number", "the model wants a window of NaN s"),
    ];
    for (fault, what) in faults {
        let place = Place::new();
        let fault = format!("left.fault={fault}");
        let more = ["--set", &fault, "--set", "left.fault_window=3"];
        let ended = place.run(&case("exchange.toml"), &more);
        assert_failed(&place, &ended, &["left (toy) failed", "window 3, iteration 1", what]);
    }
}

/// No participant follows the last solver of an explicit scheme in its window: its output is
/// checked before the window is saved. An earlier version saved that window.
#[test]
fn what_is_not_finite_enters_no_checkpoint() {
    let place = Place::new();
    let settings = ["right.fault=not-finite", "right.fault_window=3", "output.checkpoint_every=1"];
    let more = sets(&settings);
    let ended = place.run(&case("exchange.toml"), &more);
    let what = "field `right_value` holds NaN at index 500";
    assert_failed(&place, &ended, &["right (toy) failed", "window 3, iteration 1", what]);
    let kept = std::fs::read_dir(place.out().join("checkpoints")).unwrap().flatten();
    let mut kept: Vec<_> = kept.map(|entry| entry.file_name().into_string().unwrap()).collect();
    kept.sort();
    assert_eq!(kept, ["000002", "000003"], "windows 0 to 2 only");
}

#[test]
fn a_participant_that_breaks_the_contract_is_told_how() {
    let faults = [
        ("short", "field `left_value` has 999 values"),
        ("label", "is labelled \"pressure\""),
        ("sequence", "has sequence number 6, not 5"),
        ("silence", "it did not send `left_value`"),
        ("old-reply", "it speaks protocol 0"),
        ("wrong-answer", "it answered command"),
        ("lost-reply", "it has processed the last command, but its reply did not arrive"),
        ("time-is-no-number", "model_seconds is NaN s"),
        ("negative-time", "model_seconds is -0.000000001 s"),
        ("negative-wish", "wanted_window is -1 s"),
        ("endless-wish", "wanted_window is inf s"),
        ("infinite-power", "received_power is -inf W"),
    ];
    for (fault, what) in faults {
        let place = Place::new();
        let fault = format!("left.fault={fault}");
        let ended =
            place.run(&case("exchange.toml"), &sets(&[ROGUE, &fault, "left.fault_window=3"]));
        assert_failed(&place, &ended, &["left (toy) failed", "in window 3, iteration 1", what]);
    }
}

#[test]
fn a_participant_cannot_stop_reporting_power() {
    let place = Place::new();
    let settings = [ROGUE, "left.fault=power-once", "left.fault_window=3"];
    let ended = place.run(&case("exchange.toml"), &sets(&settings));
    let what = "it has stopped reporting the power it receives";
    assert_failed(&place, &ended, &["left (toy) failed", "in window 4, iteration 1", what]);
}

/// A grid that moves incorrectly in window 3, where its third revision holds; its fifth one
/// follows.
#[test]
fn a_grid_that_moves_wrongly_is_refused() {
    let (solving, accepting) = ("in window 3, iteration 1", "while accepting window 3");
    let after = "in window 4, iteration 1";
    let faults = [
        ("unannounced", solving, "`left_value` is on revision 2 of grid `numbers`, whose"),
        ("old-revision", solving, "on revision 3 of grid `numbers`, whose geometry is known in"),
        ("falling", accepting, "grid `numbers` has revision 1 after 4"),
        ("flat", accepting, "grid `numbers` has elements without an area, in revision 5"),
        ("fraction", accepting, "`numbers`, revision 5: its counts are (1000.5, 1, 1)"),
        ("truncated", accepting, "the geometry of grid `numbers` has 11 values"),
        ("other-grid", accepting, "the geometry of grid `numbers` is labelled"),
        ("repeated", accepting, "of grid `numbers` has sequence number 3, not 4"),
        ("grown", after, "has 1000 values (1 components, 1000 points), expected 1001"),
        (
            "unpublished",
            after,
            "revision 5 of grid `numbers`, whose geometry is known in revision 4",
        ),
    ];
    for (fault, when, what) in faults {
        let place = Place::new();
        let fault = format!("left.fault={fault}");
        let ended =
            place.run(&case("exchange.toml"), &sets(&[ROGUE, &fault, "left.fault_window=3"]));
        assert_failed(&place, &ended, &["left (toy) failed", when, what]);
    }
}

#[test]
fn a_wish_for_a_wrong_grid_is_refused() {
    let wishes = [
        ("wish-flat", "grid `own` has elements without an area"),
        ("wish-nowhere", "the input `right_value` is wanted on `own`, which is not a grid"),
        ("wish-unheard", "it requests a grid for `pressure`, which is not one of its inputs"),
    ];
    for (fault, what) in wishes {
        let place = Place::new();
        let fault = format!("left.fault={fault}");
        let more = ["--set", ROGUE, "--set", &fault];
        let ended = place.run(&case("exchange.toml"), &more);
        assert_refused_early(
            &place,
            &ended,
            &["left (toy) failed", "while being configured", what],
        );
    }
}

/// Killing a job signals every process. A program that dies before the coordinator handles its own
/// signal counts as interrupted, not as failed.
#[test]
fn a_signal_to_all_processes_is_an_interrupt_whichever_ends_first() {
    let place = Place::new();
    let command = format!("mech.command={:?}", ["sh", "-c", "kill -TERM $PPID $$"]);
    let ended = place.run(&case("wheel-rail.toml"), &["--set", &command]);
    assert_eq!(ended.code, Some(143), "{}", ended.stderr);
    assert!(ended.stderr.contains("interrupted by SIGTERM while starting"), "{}", ended.stderr);
}

#[test]
fn an_interrupt_at_any_moment_leaves_nothing() {
    for delay in [1, 3, 6, 10, 15, 20, 30] {
        let place = Place::new();
        let running = place.start_run(&case("exchange.toml"), &["--set", "left.delay=600"]);
        std::thread::sleep(std::time::Duration::from_millis(delay));
        running.signal(Signal::TERM);
        let ended = running.wait();
        // A signal before the handler is installed, in the first millisecond or so, leaves nothing
        // either.
        assert!(matches!(ended.code, Some(143) | None), "{:?}: {}", ended.code, ended.stderr);
        place.assert_nothing_left();
    }
}

#[test]
fn what_a_participant_starts_ends_with_it() {
    let place = Place::new();
    let mark = format!("{}", 700_000 + std::process::id());
    let script = format!("sleep {mark} >/dev/null 2>&1 & exec {} \"$@\"", toy("left").join(" "));
    let command = format!("left.command=[\"sh\", \"-c\", {script:?}, \"sh\"]");
    place.summary(&case("exchange.toml"), &["--set", &command, "--set", "time.end=2"]);
    wait_until("the end of the grandchildren", || {
        !std::fs::read_dir("/proc").unwrap().flatten().any(|entry| {
            let line = std::fs::read(entry.path().join("cmdline")).unwrap_or_default();
            line == format!("sleep\0{mark}\0").as_bytes()
        })
    });
}

#[test]
fn a_participant_started_by_hand_that_dies_is_noticed_by_its_lock() {
    let place = Place::new();
    let attach = ["--set", "left.attach=true", "--set", "left.delay=600"];
    let running = place.start_run(&case("exchange.toml"), &attach);
    let folder = place.waiting_for("left");
    let [program, name] = toy("left");
    let mut by_hand = std::process::Command::new(program)
        .args([&name, "--join", &folder, "--role", "left"])
        .spawn()
        .unwrap();
    place.wait_for_log("every participant is ready");
    by_hand.kill().unwrap();
    by_hand.wait().unwrap();
    let what = ["in window 0, iteration 1", "its process is gone"];
    assert_failed(&place, &running.wait(), &["left (toy) failed", what[0], what[1]]);
}

#[test]
fn an_honest_rogue_goes_through() {
    let place = Place::new();
    let more = ["--set", ROGUE, "--set", "time.end=5"];
    // A summary that is not an object neither replaces the summaries of others nor ends the run.
    let summary = place.summary(&case("exchange.toml"), &more);
    assert_eq!((&summary["schema"], &summary["status"]), (&1.into(), &"completed".into()));
    assert_eq!(summary["case"], "exchange");
    assert_eq!(summary["coupling"]["windows"], 5);
    assert_eq!(summary["right"]["solves"], 5);
    let told = |event: &serde_json::Value| {
        let text = event["fields"]["message"].as_str().unwrap_or_default();
        text.contains("left: its summary is not an object")
    };
    assert!(place.log().iter().any(told), "the log names the omitted summary");
}

#[test]
fn a_program_that_dies_when_asked_is_named() {
    let place = Place::new();
    let ended = place.run(&case("exchange.toml"), &["--set", "left.command=[\"false\"]"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    for part in ["left (false) failed", "while starting", "ended with exit code 1", "--log info"] {
        assert!(ended.stderr.contains(part), "`{part}` is missing in: {}", ended.stderr);
    }
    place.assert_nothing_left();
}

#[test]
fn a_program_that_does_not_exist_is_an_error_of_the_case() {
    let place = Place::new();
    let ended = place.run(&case("exchange.toml"), &["--set", "left.command=[\"no-such-thing\"]"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    for part in ["left.command", "there is no program `no-such-thing`", "fix: "] {
        assert!(ended.stderr.contains(part), "`{part}` is missing in: {}", ended.stderr);
    }
    place.assert_nothing_left();
}

#[test]
fn another_version_of_the_contract_is_refused() {
    let place = Place::new();
    let ended = place.run(&case("exchange.toml"), &["--set", "left.command=[\"toy\", \"future\"]"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("speaks protocol 999"), "{}", ended.stderr);
    place.assert_nothing_left();
}

#[test]
fn too_little_shared_memory_is_refused_with_the_figures() {
    let place = Place::new();
    let more = ["--set", "limits.shared_memory=4 MB", "--set", "left.points=1000000"];
    let ended = place.run(&case("exchange.toml"), &more);
    let what = ["before the fields were created", "the fields need", "3.8 MiB may be used"];
    assert_failed(&place, &ended, &["shared memory failed", what[0], what[1], what[2]]);
}

#[test]
fn a_participant_that_never_joins_is_waited_for_until_the_deadline() {
    let place = Place::new();
    // Describes itself, but does not join the run.
    let script = format!(
        "case \"$1\" in --join) sleep 600;; *) exec {} \"$@\";; esac",
        toy("left").join(" ")
    );
    let command = format!("left.command=[\"sh\", \"-c\", {script:?}, \"sh\"]");
    let more = ["--set", &command, "--set", "coupling.start_deadline=1"];
    let ended = place.run(&case("exchange.toml"), &more);
    let what = ["while starting", "it did not join within 1.0 s", "coupling.start_deadline"];
    assert_refused_early(&place, &ended, &["left (sh) failed", what[0], what[1], what[2]]);
}
