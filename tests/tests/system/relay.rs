//! Participant behind the relay, on this machine through loopback sockets. The results equal those
//! of a local participant, bit for bit. A lost link, a wrong key or a dead participant ends the run
//! with a clear message, and leaves nothing at either end.

use crate::harness::{Ended, Place, Running, case, field_files, programs, sets, wait_until};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tempfile::TempDir;

/// Key in a folder of its own.
struct KeyFile(TempDir);

impl KeyFile {
    fn new() -> Self {
        let key = Self(tempfile::tempdir().unwrap());
        let path = key.path();
        let made = relay(&["--new-key", &path]).status().unwrap();
        assert!(made.success());
        key
    }

    fn path(&self) -> String {
        self.0.path().join("key").display().to_string()
    }
}

fn relay(arguments: &[&str]) -> Command {
    let mut command = Command::new(programs().join("cosim-relay"));
    command.args(arguments);
    command
}

fn free_port() -> u16 {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}

/// Setting for a participant behind the relay.
fn command_of(role: &str, port: u16, key: &str, more: &[&str]) -> String {
    let endpoint = format!("127.0.0.1:{port}");
    let mut words = vec!["cosim-relay", "--connect", &endpoint, "--key", key];
    words.extend(more);
    format!("{role}.command={words:?}")
}

/// Server that listens, with a runtime folder of its own.
struct Far<'a> {
    running: Running<'a>,
    port: u16,
}

impl<'a> Far<'a> {
    fn start(place: &'a Place, key: &str, program: &str, more: &[&str]) -> Self {
        let port = free_port();
        let endpoint = format!("127.0.0.1:{port}");
        let mut arguments = vec!["--listen", &endpoint, "--key", key];
        arguments.extend(more);
        arguments.push("--");
        arguments.extend(program.split(' '));
        let command = Command::new(programs().join("cosim-relay"));
        let running = place.launch(place.becoming(command, &arguments));
        wait_until("the far end to listen", || TcpStream::connect(("127.0.0.1", port)).is_ok());
        Self { running, port }
    }

    /// Ends the server with Ctrl-C; asserts that nothing is left.
    fn stop(self, place: &Place) -> String {
        self.running.signal(Signal::INT);
        let ended = self.running.wait();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        wait_until("the end of the far runtime folder", || !place.runtime().exists());
        ended.stderr
    }
}

/// Results of a run that do not depend on time: summary, iterations and all fields.
fn results(place: &Place) -> (Value, Vec<(String, Vec<u8>)>) {
    let mut summary = place.read_summary();
    summary.as_object_mut().unwrap().remove("cost");
    let timeless = |head: &str| !head.ends_with("_s") || head == "start_s" || head == "end_s";
    let table = place.table("iterations.csv").of(timeless);
    let rows = format!("{table:?}");
    summary["iterations"] = rows.into();
    (summary, field_files(&place.out()))
}

/// Asserts equal results with the participant local and behind the relay.
fn same_to_the_bit(name: &str, role: &str, program: &str, settings: &[&str], compress: &str) {
    let here = Place::new();
    let mut settings = settings.to_vec();
    settings.push("output.fields=all");
    let words: Vec<&str> = program.split(' ').collect();
    let command = format!("{role}.command={words:?}");
    settings.push(&command);
    here.summary(&case(name), &sets(&settings));
    settings.pop();
    let (key, there, place) = (KeyFile::new(), Place::new(), Place::new());
    let far = Far::start(&there, &key.path(), program, &[]);
    let command = command_of(role, far.port, &key.path(), &["--compress", compress]);
    settings.push(&command);
    place.summary(&case(name), &sets(&settings));
    let (expected, found) = (results(&here), results(&place));
    assert_eq!(found.0, expected.0, "{name}");
    assert!(found.1 == expected.1, "{name}: a field file differs");
    assert!(!expected.1.is_empty());
    let said = far.stop(&there);
    assert!(said.contains("the run is finished"), "{said}");
}

table_of_tests! { same_to_the_bit:
    wheel_rail("wheel-rail.toml", "thermal", "thermal-solver", &[], "none");
    a_loop_with_iterations("falling-friction.toml", "thermal", "thermal-solver", &[], "lz4");
    a_loop_with_the_mechanics_far("falling-friction.toml", "mech", "mech-solver", &[], "lz4");
    a_grid_that_moves("moving.toml", "mover", "toy mover", &["mover.motion=grow", "coupling.scheme=serial-explicit"], "lz4");
    a_grid_of_others_that_moves("moving.toml", "plate", "toy plate", &["mover.motion=stretch"], "none");
    a_volume("volume.toml", "volume", "toy volume", &["volume.swells=true"], "lz4");
    files_of_the_case("wheel-on-track.toml", "mech", "mech-solver", &[], "none");
}

/// Checkpoints are stored at the client; a run resumes with a remote participant that has no record
/// of them.
#[test]
fn a_killed_run_is_resumed_to_the_bit() {
    let settings =
        ["left.delay=0.03", "time.end=60", "output.checkpoint_every=5", "output.fields=all"];
    let undisturbed = Place::new();
    undisturbed.summary(&case("exchange.toml"), &sets(&settings));
    let (key, there, place) = (KeyFile::new(), Place::new(), Place::new());
    let far = Far::start(&there, &key.path(), "toy left", &[]);
    let command = command_of("left", far.port, &key.path(), &[]);
    let more: Vec<&str> = settings.iter().copied().chain([command.as_str()]).collect();
    let running = place.start_run(&case("exchange.toml"), &sets(&more));
    place.wait_for_log("checkpoint written");
    running.signal(Signal::KILL);
    assert_eq!(running.wait().code, None);
    place.assert_nothing_left();
    let out = place.out().display().to_string();
    let ended = place.start(&["run", "--resume", &out]).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let figures = |place: &Place| {
        let summary = place.read_summary();
        ["left", "right", "coupling"].map(|part| summary[part].clone())
    };
    assert_eq!(figures(&place), figures(&undisturbed));
    assert!(field_files(&place.out()) == field_files(&undisturbed.out()));
    far.stop(&there);
}

#[test]
fn a_participant_behind_the_relay_conforms() {
    let (key, there, place) = (KeyFile::new(), Place::new(), Place::new());
    let far = Far::start(&there, &key.path(), "thermal-solver", &[]);
    let endpoint = format!("127.0.0.1:{}", far.port);
    let (name, key) = (case("falling-friction.toml"), key.path());
    let program = programs().join("cosim-relay").display().to_string();
    let mut arguments = vec!["conform", "--role", "thermal", "--case", &name, "--quick", "--json"];
    // A small contact, whose growing grids need no larger messages than the runs above.
    arguments.extend(["--set", "mech.resolution=2", "--"]);
    arguments.extend([&program, "--connect", &endpoint, "--key", &key]);
    let ended = place.start(&arguments).wait();
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stderr, ended.stdout);
    place.assert_nothing_left();
    far.stop(&there);
}

/// Starts a run whose participant `left` is behind the relay and in a long solve.
fn in_mid_window<'a>(place: &'a Place, command: &str, more: &[&str]) -> Running<'a> {
    let mut settings = vec!["left.delay=600", command];
    settings.extend(more);
    let running = place.start_run(&case("exchange.toml"), &sets(&settings));
    place.wait_for_log("every participant is ready");
    std::thread::sleep(std::time::Duration::from_millis(300));
    running
}

fn assert_failed(place: &Place, ended: &Ended, parts: &[&str]) {
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    let line = ended.stderr.lines().find(|line| line.starts_with("error: "));
    let line = line.unwrap_or_else(|| panic!("no error line in: {}", ended.stderr));
    for part in parts {
        assert!(line.contains(part), "`{part}` is missing in: {line}");
    }
    place.assert_nothing_left();
}

const WHEN: &str = "left (cosim-relay) failed in window 0, iteration 1";

#[test]
fn a_far_end_that_is_killed_is_named_with_the_window() {
    let (key, there, place) = (KeyFile::new(), Place::new(), Place::new());
    let far = Far::start(&there, &key.path(), "toy left", &[]);
    let running = in_mid_window(&place, &command_of("left", far.port, &key.path(), &[]), &[]);
    far.running.signal(Signal::KILL);
    assert_eq!(far.running.wait().code, None);
    let lost = format!("the link to 127.0.0.1:{} is lost", far.port);
    assert_failed(&place, &running.wait(), &[WHEN, &lost]);
    wait_until("the far participant to leave", || !there.runtime().exists());
}

/// Proxy that forwards data until told to drop it silently.
fn proxy(to: u16) -> (u16, Arc<AtomicBool>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let (port, swallows) =
        (listener.local_addr().unwrap().port(), Arc::new(AtomicBool::new(false)));
    let swallowing = Arc::clone(&swallows);
    let pass = move |mut from: TcpStream, mut to: TcpStream, swallowing: Arc<AtomicBool>| {
        std::thread::spawn(move || {
            let mut bytes = [0; 1 << 16];
            loop {
                match from.read(&mut bytes) {
                    Ok(0) | Err(_) => break,
                    Ok(_) if swallowing.load(Ordering::SeqCst) => {}
                    Ok(count) if to.write_all(&bytes[..count]).is_ok() => {}
                    Ok(_) => break,
                }
            }
            let _ = to.shutdown(Shutdown::Both);
        });
    };
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            let Ok(onward) = TcpStream::connect(("127.0.0.1", to)) else { continue };
            let (back, forth) = (onward.try_clone().unwrap(), stream.try_clone().unwrap());
            pass(stream, onward, Arc::clone(&swallowing));
            pass(back, forth, Arc::clone(&swallowing));
        }
    });
    (port, swallows)
}

#[test]
fn a_link_that_swallows_everything_is_noticed_at_both_ends() {
    let (key, there, place) = (KeyFile::new(), Place::new(), Place::new());
    let far = Far::start(&there, &key.path(), "toy left", &["--silence", "2"]);
    let (port, swallows) = proxy(far.port);
    let command = command_of("left", port, &key.path(), &["--silence", "2"]);
    let running = in_mid_window(&place, &command, &[]);
    swallows.store(true, Ordering::SeqCst);
    let ended = running.wait();
    assert_failed(&place, &ended, &[WHEN, "is lost: nothing was received for 2.0 s"]);
    wait_until("the far participant's end", || !there.runtime().exists());
    let said = far.stop(&there);
    let line = said.lines().find(|line| line.contains("the link is lost")).unwrap_or_default();
    assert!(line.contains("nothing was received for 2.0 s; in window 0, iteration 1"), "{said}");
}

/// The server waits for the next run.
#[test]
fn an_interrupt_at_home_ends_the_far_participant_and_the_next_run_goes() {
    let (key, there, place) = (KeyFile::new(), Place::new(), Place::new());
    let far = Far::start(&there, &key.path(), "toy left", &[]);
    let command = command_of("left", far.port, &key.path(), &[]);
    let running = in_mid_window(&place, &command, &[]);
    assert!(there.runtime().exists());
    running.signal(Signal::INT);
    assert_eq!(running.wait().code, Some(130));
    place.assert_nothing_left();
    wait_until("the far participant's end", || !there.runtime().exists());
    place.summary(&case("exchange.toml"), &sets(&["time.end=3", &command]));
    let said = far.stop(&there);
    assert!(said.contains("the run is over") && said.contains("the run is finished"), "{said}");
}

#[test]
fn once_is_one_run() {
    let (key, there, place) = (KeyFile::new(), Place::new(), Place::new());
    let far = Far::start(&there, &key.path(), "toy left", &["--once"]);
    let command = command_of("left", far.port, &key.path(), &[]);
    place.summary(&case("exchange.toml"), &sets(&["time.end=3", &command]));
    assert_eq!(far.running.wait().code, Some(0));
}

#[test]
fn a_far_participant_that_exits_is_reported_with_its_last_words() {
    let (key, there, place) = (KeyFile::new(), Place::new(), Place::new());
    let far = Far::start(&there, &key.path(), "toy left", &[]);
    let command = command_of("left", far.port, &key.path(), &[]);
    for (fault, how) in [
        ("exit", "ended with exit code 9"),
        ("panic", "exit code 101, saying: "),
        ("error", "told to fail"),
    ] {
        let fault = format!("left.fault={fault}");
        let ended =
            place.run(&case("exchange.toml"), &sets(&[&fault, "left.fault_window=2", &command]));
        assert_failed(&place, &ended, &["left (cosim-relay) failed in window 2, iteration 1", how]);
    }
    far.stop(&there);
}

#[test]
fn a_far_participant_that_is_killed_or_stopped_is_reported() {
    let (key, there, place) = (KeyFile::new(), Place::new(), Place::new());
    let far = Far::start(&there, &key.path(), "toy left", &[]);
    let command = command_of("left", far.port, &key.path(), &[]);
    let running = in_mid_window(&place, &command, &[]);
    kill_process(child_of(far.running.pid()), Signal::KILL).unwrap();
    assert_failed(&place, &running.wait(), &[WHEN, "at the server was killed by signal 9"]);
    let place = Place::new();
    let running = in_mid_window(&place, &command, &["coupling.heartbeat_deadline=1.5"]);
    kill_process(child_of(far.running.pid()), Signal::STOP).unwrap();
    assert_failed(&place, &running.wait(), &[WHEN, "no heartbeat for"]);
    far.stop(&there);
}

/// Only child of a process.
fn child_of(parent: Pid) -> Pid {
    let parent = parent.as_raw_nonzero().to_string();
    let is_child = |pid: &i32| {
        let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
        let after_name = stat.rsplit(") ").next().unwrap_or_default();
        after_name.split(' ').nth(1) == Some(&parent)
    };
    let entries = std::fs::read_dir("/proc").unwrap().flatten();
    let pids = entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    Pid::from_raw(pids.into_iter().find(is_child).expect("it has a child")).unwrap()
}

#[test]
fn another_key_is_refused_at_both_ends() {
    let (key, other, there, place) = (KeyFile::new(), KeyFile::new(), Place::new(), Place::new());
    let far = Far::start(&there, &key.path(), "toy left", &[]);
    let command = command_of("left", far.port, &other.path(), &[]);
    let ended = place.run(&case("exchange.toml"), &sets(&[&command]));
    assert_ne!(ended.code, Some(0));
    assert!(ended.stderr.contains("the server has another key"), "{}", ended.stderr);
    let said = far.stop(&there);
    assert!(said.contains("a call is refused: the client has another key"), "{said}");
}

#[test]
fn nobody_who_listens_is_named_within_the_patience() {
    let (key, place) = (KeyFile::new(), Place::new());
    let port = free_port();
    let command = command_of("left", port, &key.path(), &["--patience", "1"]);
    let ended = place.run(&case("exchange.toml"), &sets(&[&command]));
    assert_ne!(ended.code, Some(0));
    let words = format!("no server reached at 127.0.0.1:{port} within 1 s");
    assert!(ended.stderr.contains(&words), "{}", ended.stderr);
}

/// `coordinator relay` starts the relay with all its options.
#[test]
fn the_coordinator_becomes_the_relay() {
    let (key, there, place) = (KeyFile::new(), Place::new(), Place::new());
    let far = Far::start(&there, &key.path(), "toy left", &[]);
    let endpoint = format!("127.0.0.1:{}", far.port);
    let ended = place.start(&["relay", "--connect", &endpoint, "--key", &key.path()]).wait();
    assert_eq!(ended.code, Some(1), "{}", ended.stdout);
    assert!(ended.stderr.contains("the coordinator starts this end"), "{}", ended.stderr);
    let open = place.start(&["relay", "--help"]).wait();
    assert!(open.stdout.contains("--new-key"), "{}", open.stdout);
    far.stop(&there);
    let other = free_port();
    let endpoint = format!("127.0.0.1:{other}");
    let listens =
        ["relay", "--listen", &endpoint, "--key", &key.path(), "--once", "--", "toy", "left"];
    let running = there.start(&listens);
    wait_until("the far end to listen", || TcpStream::connect(("127.0.0.1", other)).is_ok());
    let command = command_of("left", other, &key.path(), &[]);
    place.summary(&case("exchange.toml"), &sets(&["time.end=3", &command]));
    assert_eq!(running.wait().code, Some(0));
}

/// Callers without the key do not disturb a run, and later clients are served.
fn goes_on_beside(attack: impl Fn(u16)) {
    let (key, there, place) = (KeyFile::new(), Place::new(), Place::new());
    let far = Far::start(&there, &key.path(), "toy left", &[]);
    let command = command_of("left", far.port, &key.path(), &["--silence", "2"]);
    let more = ["left.delay=0.05", "time.end=40", &command];
    let running = place.start_run(&case("exchange.toml"), &sets(&more));
    place.wait_for_log("every participant is ready");
    attack(far.port);
    let next = Place::new();
    next.summary(&case("exchange.toml"), &sets(&["time.end=3", &command]));
    let ended = running.wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    far.stop(&there);
}

/// Opens connections and sends the same bytes on each.
fn callers(port: u16, count: usize, said: &[u8]) -> Vec<TcpStream> {
    let call = |_| {
        let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
        // Writing to a connection that is already closed fails.
        let _ = stream.write_all(said);
        stream
    };
    (0..count).map(call).collect()
}

/// The connections stay open during the next run; each waits for five seconds at most.
#[test]
fn callers_that_are_silent_keep_nobody_out() {
    let open = std::sync::Mutex::new(Vec::new());
    goes_on_beside(|port| {
        open.lock().unwrap().extend(callers(port, 80, b""));
        open.lock().unwrap().extend(callers(port, 80, b"cosR"));
    });
    let mut first = open.into_inner().unwrap().remove(0);
    first.set_read_timeout(Some(std::time::Duration::from_secs(60))).unwrap();
    assert!(matches!(first.read(&mut [0]), Ok(0) | Err(_)), "its connection is closed");
}

#[test]
fn greetings_without_a_proof_keep_nobody_out() {
    let versions = [2_u32.to_le_bytes(), proto::PROTOCOL_VERSION.to_le_bytes()].concat();
    let greeting = [&b"cosR"[..], &versions, &[7; 48]].concat();
    let words = [&greeting[..], b"GET / HTTP/1.1\r\n\r\n", &[0xff; 1 << 20]];
    goes_on_beside(|port| {
        for said in words {
            drop(callers(port, 100, said));
        }
    });
}

/// An end that holds the key but does not read its data counts as lost, like a silent one.
#[test]
fn a_far_end_that_stops_is_lost_at_home() {
    let (key, there, place) = (KeyFile::new(), Place::new(), Place::new());
    let far = Far::start(&there, &key.path(), "toy left", &[]);
    let command = command_of("left", far.port, &key.path(), &["--silence", "1"]);
    let running = in_mid_window(&place, &command, &[]);
    far.running.signal(Signal::STOP);
    let ended = running.wait();
    far.running.signal(Signal::CONT);
    assert_failed(&place, &ended, &[WHEN, "is lost: nothing was received for 1.0 s"]);
    far.stop(&there);
}
