//! Start of a run: connections, building of models, limits of the machine, and frozen processes.

use crate::harness::{Place, case, programs, sets};
use rustix::process::{Pid, Signal, kill_process};
use std::time::{Duration, Instant};

fn exchange(settings: &[&str]) -> (Place, crate::harness::Ended) {
    let place = Place::new();
    let more = sets(settings);
    let ended = place.run(&case("exchange.toml"), &more);
    place.assert_nothing_left();
    (place, ended)
}

/// An earlier version sent samples before every subscriber was reachable, which ended one start in
/// a thousand. `STARTS=20000 cargo test --release --workspace --test system start::many --
/// --nocapture` tests more.
#[test]
fn many_starts() {
    let count = std::env::var("STARTS").map_or(40, |count| count.parse().unwrap());
    let (place, begun) = (Place::new(), Instant::now());
    for number in 0..count {
        let ended = place.run(&case("exchange.toml"), &["--set", "time.end=1", "--quiet"]);
        assert_eq!(ended.code, Some(0), "start {number}: {}", ended.stderr);
    }
    place.assert_nothing_left();
    let each = begun.elapsed().as_secs_f64() / f64::from(count) * 1e3;
    println!("{count} starts, {each:.1} ms each");
}

/// Ports are open before models are built, so that building may take longer than the deadline for
/// the start.
#[test]
fn building_may_take_longer_than_starting() {
    let settings = ["time.end=2", "coupling.start_deadline=3", "left.build_delay=4"];
    let (_, ended) = exchange(&settings);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
}

#[test]
fn who_is_still_building_is_named_with_the_key() {
    let (_, ended) = exchange(&["coupling.build_deadline=1", "right.build_delay=600"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    let what = "right (toy) failed while building its model: it is still building its model \
                after 1.0 s; its heartbeat is still received; raise coupling.build_deadline";
    assert!(ended.stderr.contains(what), "{}", ended.stderr);
}

/// The deadline for building extends with the expected time that a participant reports.
#[test]
fn the_deadline_of_building_follows_what_is_expected() {
    let expected = ["left.build_expected=1", "left.build_delay=3"];
    let (_, ended) = exchange(&[["time.end=2", "coupling.build_deadline=1"], expected].concat());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
}

/// The refusal does not wait for the partner, which builds for ten minutes.
#[test]
fn a_refusal_in_build_is_reported_at_once_in_its_own_words() {
    let (_, ended) = exchange(&["left.build_delay=600", "right.fault=refuse-build"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    for part in ["right.points", "cannot be built", "choose other ones"] {
        assert!(ended.stderr.contains(part), "`{part}` is missing in: {}", ended.stderr);
    }
}

/// Runs the smallest case in a shell with limits.
fn limited(limits: &str) -> (Place, crate::harness::Ended) {
    let place = Place::new();
    let mut shell = std::process::Command::new("sh");
    let line = format!("{limits} && exec {} \"$@\"", programs().join("coordinator").display());
    shell.args(["-c", &line, "sh"]);
    let (case, out) = (case("exchange.toml"), place.out().display().to_string());
    let arguments = ["run", &case, "--out", &out, "--set", "time.end=2"];
    let ended = place.launch(place.becoming(shell, &arguments)).wait();
    place.assert_nothing_left();
    (place, ended)
}

#[test]
fn a_low_limit_of_open_files_is_raised_as_far_as_it_may_be() {
    let (_, ended) = limited("ulimit -Sn 40");
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
}

#[test]
fn too_few_open_files_are_refused_before_anything_starts() {
    for most in [40, 64, 90] {
        let (place, ended) = limited(&format!("ulimit -n {most}"));
        let told = ended.stderr;
        assert_eq!(ended.code, Some(1), "{told}");
        let allowed = format!("files: {most} are allowed");
        for part in ["before anything was started", &allowed, "ulimit -Hn"] {
            assert!(told.contains(part), "`{part}` is missing in: {told}");
        }
        let log = place.log();
        assert!(log.iter().all(|e| e["fields"]["message"] != "participant started"), "{log:?}");
    }
}

/// A container that is paused and continued: silence during the pause does not count as a failure.
#[test]
fn a_run_that_was_frozen_as_a_whole_goes_on() {
    let place = Place::new();
    let more = ["time.end=2", "left.delay=1.5", "coupling.heartbeat_deadline=3"];
    let more = [more.as_slice(), &["coupling.solve_deadline=5"]].concat();
    let more = sets(&more);
    let running = place.start_run(&case("exchange.toml"), &more);
    place.wait_for_log("every participant is ready");
    let all = [running.pid(), place.pid_of("left"), place.pid_of("right")];
    let signal = |all: &[Pid], signal| all.iter().for_each(|p| kill_process(*p, signal).unwrap());
    signal(&all, Signal::STOP);
    std::thread::sleep(Duration::from_secs(6));
    // The coordinator continues first, and checks before new heartbeats arrive.
    signal(&all[..1], Signal::CONT);
    std::thread::sleep(Duration::from_millis(50));
    signal(&all[1..], Signal::CONT);
    let ended = running.wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    place.assert_nothing_left();
}
