//! Effects of the machine on a run and of a run on the machine: foreign folders, ignored signals,
//! orphaned processes, damaged shared memory.

use crate::harness::{Ended, Place, case, programs, sets, toy, wait_until};
use rustix::process::{Pid, Signal, kill_process};
use std::fs::File;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

fn run_in(place: &Place, root: &Path) -> Ended {
    let out = place.out().display().to_string();
    let run = ["run", &case("exchange.toml"), "--set", "time.end=2", "--out", &out, "--replace"];
    place.start_in(root, Command::new(programs().join("coordinator")), &run).wait()
}

/// Folders not created by a run are never removed, even if they resemble one.
#[test]
fn the_users_own_folders_stay() {
    let place = Place::new();
    let runs = place.runtime();
    let root = runs.parent().unwrap();
    place.summary(&case("exchange.toml"), &["--set", "time.end=2"]);
    assert!(root.exists() && !runs.exists());
    let mine = [runs.join("mine"), runs.join(".new-mine")];
    for folder in &mine {
        std::fs::create_dir_all(folder).unwrap();
        for name in ["coordinator.lock", "members.lock", "precious"] {
            std::fs::write(folder.join(name), b"").unwrap();
        }
    }
    Command::new("chmod").arg("700").arg(&runs).status().unwrap();
    Command::new("touch").args(["-d", "1 hour ago"]).arg(&mine[1]).status().unwrap();
    let ended = run_in(&place, root);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(mine.iter().all(|folder| folder.join("precious").exists()));
    std::fs::remove_dir_all(&runs).unwrap();
}

/// If other users can write to the folder, nothing in it is removed: a forged dead run there could
/// name our shared memory.
#[test]
fn a_folder_that_is_not_ours_alone_is_refused_before_anything_is_removed() {
    let place = Place::new();
    let runs = place.runtime();
    let root = runs.parent().unwrap();
    let link = root.join("link");
    std::os::unix::fs::symlink(root, &link).unwrap();
    let run = runs.join("0123abcd");
    std::fs::create_dir_all(&run).unwrap();
    for lock in ["coordinator.lock", "members.lock"] {
        std::fs::write(run.join(lock), b"").unwrap();
    }
    let ours = Path::new("/dev/shm/cosim_0123abcd_ours");
    std::fs::write(run.join("run.json"), r#"{"prefix": "cosim_0123abcd_"}"#).unwrap();
    std::fs::write(ours, b"").unwrap();
    let refused = |root: &Path, why: &str| {
        let ended = run_in(&place, root);
        assert_eq!(ended.code, Some(1), "{}", ended.stderr);
        let told = [why, "while preparing the run", "COSIM_RUNTIME_DIR"];
        assert!(told.iter().all(|part| ended.stderr.contains(part)), "{}", ended.stderr);
        assert!(ours.exists() && run.exists());
    };
    refused(&link, "is a symbolic link");
    refused(root, "is open to other users");
    // Only root can change the owner of a folder.
    if rustix::process::geteuid().is_root() {
        std::os::unix::fs::chown(&runs, Some(4321), None).unwrap();
        refused(root, "belongs to another user");
    }
    std::fs::remove_file(ours).unwrap();
    std::fs::remove_dir_all(&runs).unwrap();
}

/// Coordinator started by a shell after a command that sets up signals.
fn after(preparation: &str) -> Command {
    let mut shell = Command::new("bash");
    let script = format!("{preparation}; exec \"$@\"");
    shell.args(["-c", &script, "bash"]).arg(programs().join("coordinator"));
    shell
}

/// `nohup` starts a program like this, and so does a shell in the background.
#[test]
fn signals_that_are_ignored_at_the_start_stay_ignored() {
    let place = Place::new();
    let out = place.out().display().to_string();
    let run = ["run", &case("exchange.toml"), "--set", "left.delay=600", "--out", &out];
    let root = place.runtime();
    let running = place.start_in(root.parent().unwrap(), after("trap '' HUP INT"), &run);
    place.wait_for_log("every participant is ready");
    for signal in [Signal::HUP, Signal::INT] {
        running.signal(signal);
        std::thread::sleep(Duration::from_millis(200));
    }
    running.signal(Signal::TERM);
    let ended = running.wait();
    assert!(ended.stderr.contains("interrupted by SIGTERM in window 0"), "{}", ended.stderr);
    place.assert_nothing_left();
}

/// The pipe to read has no writer. A case may come through a pipe, as through standard input; a
/// recording or a result folder through a pipe is rejected at once.
#[test]
fn what_reads_ends_with_ctrl_c() {
    let place = Place::new();
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe").display().to_string();
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let csv = folder.path().join("csv").display().to_string();
    let refused: [&[&str]; 3] = [
        &["inspect", &pipe],
        &["export", &pipe, "--csv", &csv],
        &["replay", &pipe, "--only", "mech"],
    ];
    for command in refused {
        let ended = place.start(command).wait();
        assert_eq!(ended.code, Some(2), "{command:?}: {}", ended.stderr);
        let told = format!("error: {pipe} is a named pipe, where a regular file is expected\n");
        assert_eq!(ended.stderr, told, "{command:?}");
    }
    for command in ["plan", "check", "run"].map(|name| [name, &pipe]) {
        let running = place.start(&command);
        // The thread that handles signals has started.
        let tasks = format!("/proc/{}/task", running.pid().as_raw_nonzero());
        wait_until("two threads", || std::fs::read_dir(&tasks).unwrap().count() > 1);
        running.signal(Signal::INT);
        let ended = running.wait();
        assert_eq!(ended.code, Some(130), "{command:?}: {}", ended.stderr);
        assert_eq!(ended.stderr, "error: interrupted by Ctrl-C\n", "{command:?}");
    }
}

/// Waits where signals are not checked: while a study reads its case.
#[test]
fn a_second_signal_ends_anything() {
    let place = Place::new();
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe").display().to_string();
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let running = place.start(&["ablate", &pipe]);
    let tasks = format!("/proc/{}/task", running.pid().as_raw_nonzero());
    wait_until("two threads", || std::fs::read_dir(&tasks).unwrap().count() > 1);
    running.signal(Signal::INT);
    std::thread::sleep(Duration::from_millis(1200));
    running.signal(Signal::INT);
    let ended = running.wait();
    assert_eq!(ended.code, Some(130), "{}", ended.stderr);
}

/// Processes with these arguments.
fn processes(arguments: &[&str]) -> Vec<Pid> {
    let line: String = arguments.iter().map(|argument| format!("{argument}\0")).collect();
    let entries = std::fs::read_dir("/proc").unwrap().flatten();
    let with = |entry: &std::fs::DirEntry| {
        std::fs::read(entry.path().join("cmdline")).is_ok_and(|found| found == line.as_bytes())
    };
    let numbers = entries.filter(with).filter_map(|e| e.file_name().to_str()?.parse().ok());
    numbers.filter_map(Pid::from_raw).collect()
}

/// Participant that starts a process whenever it is started itself; the argument of `sleep`
/// identifies the process.
fn with_a_descendant(descendant: &str) -> String {
    let left = toy("left").join(" ");
    let script = format!("{descendant} & exec {left} \"$@\"");
    format!("left.command=[\"sh\", \"-c\", {script:?}, \"sh\"]")
}

/// The process has a session of its own, outside the process group that is ended. The pipe it keeps
/// open does not delay the reading of an answer.
#[test]
fn what_has_left_its_group_ends_with_the_run() {
    for (number, output) in ["", ">/dev/null 2>&1"].into_iter().enumerate() {
        let place = Place::new();
        let mark = format!("{}", 800_000 + 2 * std::process::id() as usize + number);
        let command = with_a_descendant(&format!("setsid sleep {mark} {output}"));
        place.summary(&case("exchange.toml"), &["--set", &command, "--set", "time.end=2"]);
        assert_eq!(processes(&["sleep", &mark]), []);
    }
}

/// A process that has dropped all inherited marks may belong to somebody else: it is only reported.
#[test]
fn an_orphan_without_a_mark_is_reported() {
    let place = Place::new();
    let mark = format!("{}", 900_000 + std::process::id());
    let command = with_a_descendant(&format!("setsid env -i sleep {mark}"));
    let ended = place.run(&case("exchange.toml"), &["--set", &command, "--set", "time.end=2"]);
    let left = processes(&["sleep", &mark]);
    for process in &left {
        kill_process(*process, Signal::KILL).unwrap();
        let told = format!("process {} (sleep) has lost its parent", process.as_raw_nonzero());
        assert!(ended.stderr.contains(&told), "{}", ended.stderr);
    }
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(!left.is_empty());
}

/// Accessing a truncated file kills the process; the process or its coordinator reports this.
#[test]
fn damaged_shared_memory_is_reported_and_removed_by_the_next_run() {
    let place = Place::new();
    let running = place.start_run(&case("exchange.toml"), &["--set", "left.delay=600"]);
    place.wait_for_log("every participant is ready");
    let prefix = place.created("prefix");
    let entries = std::fs::read_dir("/dev/shm").unwrap().flatten();
    let files: Vec<_> = entries
        .filter(|entry| entry.file_name().to_string_lossy().starts_with(&prefix))
        .map(|entry| entry.path())
        .collect();
    for file in &files {
        let _ = File::options().write(true).open(file).and_then(|file| file.set_len(0));
    }
    let ended = running.wait();
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("/dev/shm"), "{}", ended.stderr);
    for role in ["left", "right"] {
        let stat = format!("/proc/{}/stat", place.pid_of(role).as_raw_nonzero());
        wait_until("the end of the participants", || {
            std::fs::read_to_string(&stat).map_or(true, |stat| stat.contains(") Z "))
        });
    }
    let next = place.run(&case("exchange.toml"), &["--set", "time.end=2"]);
    assert_eq!(next.code, Some(0), "{}", next.stderr);
    assert!(files.iter().all(|file| !file.exists()), "{files:?}");
}

/// Sizes that follow from extreme values are rejected by key before memory is allocated: all runs
/// have an address space of 8 GB.
#[test]
fn extreme_values_do_not_take_all_memory() {
    let place = Place::new();
    let run = |name: &str, settings: &[&str]| {
        let mut limited = Command::new("sh");
        limited.args(["-c", "ulimit -v 8000000; exec \"$@\"", "sh"]);
        let (name, out) = (case(name), place.out().display().to_string());
        limited.arg(programs().join("coordinator"));
        let arguments = [&["run", &name, "--out", &out, "--replace"][..], &sets(settings)].concat();
        place.launch(place.becoming(limited, &arguments)).wait()
    };
    for (setting, key) in [
        ("thermal.wake=1e9", "thermal.wake"),
        ("thermal.first_layer=1e-300", "thermal.first_layer"),
        ("thermal.depth=1e300", "thermal.depth"),
        ("load.normal_force=1e-9", "thermal.wake"),
    ] {
        let ended = run("wake.toml", &[setting]);
        assert_eq!(ended.code, Some(2), "{setting}: {}", ended.stderr);
        for part in [key, "of elements", "fix: "] {
            assert!(ended.stderr.contains(part), "{setting}: {part}: {}", ended.stderr);
        }
    }
    // The number of ages follows from the grid, regardless of the surface speed.
    for speed in ["1e9", "1e30"] {
        let speed = format!("bodies.pin.surface_speed={speed}");
        let ended = run("pin-on-disc.toml", &[&speed, "mech.resolution=4", "time.end=0.3 ms"]);
        assert_eq!(ended.code, Some(0), "{speed}: {}", ended.stderr);
    }
    place.assert_nothing_left();
}

/// The kernel's table of open files is large enough from the start: extending it in a process with
/// threads takes 10 to 25 ms. The table starts with 64 entries unless a file with a higher number
/// is open.
#[test]
fn no_process_of_a_run_extends_its_table_of_open_files() {
    let place = Place::new();
    let running = place.start_run(&case("exchange.toml"), &["--set", "left.delay=600"]);
    place.wait_for_log("every participant is ready");
    let processes = [running.pid(), place.pid_of("left"), place.pid_of("right")];
    for process in processes.map(|pid| pid.as_raw_nonzero()) {
        let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap();
        let size = status.lines().find_map(|line| line.strip_prefix("FDSize:")).unwrap();
        assert!(size.trim().parse::<usize>().unwrap() >= 1024, "{status}");
    }
    running.signal(Signal::INT);
    assert_eq!(running.wait().code, Some(130));
}
