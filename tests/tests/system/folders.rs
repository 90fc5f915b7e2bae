//! Result folders: ownership, replacement of results, and their state when the disk is full.

use crate::harness::{Place, Running, case, sets, toy, wait_until};
use rustix::process::{Resource, Rlimit, Signal, prlimit};
use serde_json::Value;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

/// Runs a short exchange in a folder, with more arguments; returns the exit code, and standard
/// output followed by standard error.
fn run_in(place: &Place, folder: &Path, more: &[&str]) -> (Option<i32>, String) {
    let file = case("exchange.toml");
    let arguments = [&["run", file.as_str(), "--set", "time.end=3"], more].concat();
    let mut command = place.command(&arguments);
    command.current_dir(folder);
    let ended = place.launch(command).wait();
    (ended.code, ended.stdout + &ended.stderr)
}

fn summary(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("summary.json")).unwrap()).unwrap()
}

fn log(folder: &Path) -> Vec<Value> {
    let text = fs::read_to_string(folder.join("log.jsonl")).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn a_second_run_has_a_folder_of_its_own() {
    let (place, here) = (Place::new(), tempfile::tempdir().unwrap());
    let results = here.path().join("results");
    let ran = |more: &[&str], name: &str| {
        let (code, said) = run_in(&place, here.path(), more);
        assert_eq!(code, Some(0), "{said}");
        assert!(said.contains(&format!("  results   results/{name}\n")), "{said}");
        let set = more.last().map_or("3", |set| set.rsplit_once('=').unwrap().1);
        assert_eq!(summary(&results.join(name))["coupling"]["windows"].to_string(), set);
    };
    let latest = || fs::read_link(results.join("latest")).unwrap();
    ran(&[], "exchange");
    ran(&["--set", "time.end=4"], "exchange-2");
    assert_eq!(latest(), Path::new("exchange-2"));
    ran(&["--set", "time.end=5"], "exchange-3");
    assert_eq!(latest(), Path::new("exchange-3"));
    assert_eq!(summary(&results.join("exchange"))["coupling"]["windows"], 3);
    // `--replace` applies to the folder without a number.
    ran(&["--replace", "--set", "time.end=6"], "exchange");
    assert_eq!(summary(&results.join("exchange-2"))["coupling"]["windows"], 4);
    let mut report = place.command(&["report", "results/latest"]);
    assert_eq!(
        place
            .launch({
                report.current_dir(here.path());
                report
            })
            .wait()
            .code,
        Some(0)
    );
    assert!(results.join("exchange-3/report.html").exists());
    assert_eq!(fs::read_dir(&results).unwrap().count(), 4);
}

#[test]
fn a_folder_that_is_named_is_replaced_only_when_asked() {
    let (place, here) = (Place::new(), tempfile::tempdir().unwrap());
    let out = here.path().join("mine");
    assert_eq!(run_in(&place, here.path(), &["--out", "mine"]).0, Some(0));
    let before = fs::read(out.join("summary.json")).unwrap();
    let (code, said) = run_in(&place, here.path(), &["--out", "mine"]);
    assert_eq!(code, Some(2));
    assert!(
        said.contains("mine already holds results of a run; replace them with --replace"),
        "{said}"
    );
    assert_eq!(fs::read(out.join("summary.json")).unwrap(), before);
    let again = ["--out", "mine", "--replace", "--set", "time.end=4"];
    assert_eq!(run_in(&place, here.path(), &again).0, Some(0));
    assert_eq!(summary(&out)["coupling"]["windows"], 4);
}

/// A file that resembles our log does not mark a folder as ours, and no link leads a run out of its
/// folder.
#[test]
fn nothing_foreign_is_replaced() {
    let place = Place::new();
    let mine = "{\"timestamp\":\"mine\"}\n";
    for linked in [false, true] {
        let here = tempfile::tempdir().unwrap();
        let (out, target) = (here.path().join("out"), here.path().join("target"));
        fs::create_dir(&out).unwrap();
        fs::write(&target, mine).unwrap();
        match linked {
            true => symlink(&target, out.join("log.jsonl")).unwrap(),
            false => fs::write(out.join("log.jsonl"), mine).unwrap(),
        }
        for more in [&["--out", "out"][..], &["--out", "out", "--replace"]] {
            let (code, said) = run_in(&place, here.path(), more);
            assert_eq!(code, Some(2), "{said}");
            assert!(said.contains("holds files but no results of a run"), "{said}");
        }
        assert_eq!(fs::read_to_string(out.join("log.jsonl")).unwrap(), mine);
        assert_eq!(fs::read_to_string(&target).unwrap(), mine);
        assert_eq!(fs::read_dir(&out).unwrap().count(), 1);
    }
}

/// The log is part of the results, but ownership does not depend on it or on `RUST_LOG`.
#[test]
fn a_quiet_log_does_not_make_results_foreign() {
    let place = Place::new();
    let out = place.out().display().to_string();
    let file = case("exchange.toml");
    for end in ["3", "4"] {
        let end = format!("time.end={end}");
        let mut run = place.command(&["run", &file, "--out", &out, "--replace", "--set", &end]);
        run.env("RUST_LOG", "warn");
        let ended = place.launch(run).wait();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert_eq!(ended.stderr, "", "the screen follows RUST_LOG");
        let messages: Vec<Value> =
            log(&place.out()).iter().map(|event| event["fields"]["message"].clone()).collect();
        assert!(messages.contains(&"every participant is ready".into()), "{messages:?}");
    }
    let ended = place.start(&["run", "--resume", &out]).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    fs::remove_file(place.out().join("log.jsonl")).unwrap();
    let ended = place.run(&file, &["--set", "time.end=3"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
}

/// A participant may write any amount; its log is limited.
#[test]
fn a_flood_of_words_is_cut_and_counted() {
    let place = Place::new();
    let script = format!(
        "case \"$*\" in *--join*) seq -f 'word %.0f' 300000 ;; esac; exec {} \"$@\"",
        toy("left").join(" ")
    );
    let command = format!("left.command=[\"sh\", \"-c\", {script:?}, \"sh\"]");
    let ended = place.run(&case("exchange.toml"), &["--set", &command, "--set", "time.end=3"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let length = fs::metadata(place.out().join("log.jsonl")).unwrap().len();
    assert!(length < 16 << 20, "{length} bytes");
    let log = log(&place.out());
    let words: Vec<&str> = log
        .iter()
        .filter(|event| event["target"] == "participant")
        .filter_map(|event| event["fields"]["message"].as_str())
        .collect();
    let left_out = log.iter().find_map(|event| event["fields"]["lines"].as_u64()).unwrap();
    assert_eq!(words.len() as u64 + left_out, 300_000);
    assert_eq!((words[0], *words.last().unwrap()), ("word 1", "word 300000"));
}

/// Slow participants, so that the folder can be renamed during the run.
const SLOW: [&str; 8] = [
    "--set",
    "left.delay=5 ms",
    "--set",
    "output.fields=all",
    "--set",
    "output.every=10",
    "--set",
    "output.checkpoint_every=10",
];

/// Asserts that the folder contains all results of a run and nothing else.
fn assert_whole(folder: &Path, windows: u64) {
    assert_eq!(summary(folder)["coupling"]["windows"], windows);
    let table = fs::read_to_string(folder.join("iterations.csv")).unwrap();
    assert_eq!(table.lines().count() as u64, windows + 1);
    let fields = fs::read_dir(folder.join("fields")).unwrap().flatten();
    let images = fields.filter(|file| file.path().extension().is_some_and(|end| end == "vti"));
    assert_eq!(images.count() as u64, 2 * windows.div_ceil(10));
    let mut states: Vec<String> = fs::read_dir(folder.join("checkpoints"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    states.sort();
    let last = (windows - 1) / 10 * 10;
    assert_eq!(states, [last - 10, last].map(|window| format!("{window:06}")));
}

#[test]
fn a_folder_renamed_in_mid_run_keeps_its_results_together() {
    let place = Place::new();
    let first =
        place.start_run(&case("exchange.toml"), &[&SLOW[..], &["--set", "time.end=95"]].concat());
    let moved = place.out().with_file_name("moved");
    wait_until("a checkpoint", || place.out().join("checkpoints/000010").exists());
    fs::rename(place.out(), &moved).unwrap();
    place.summary(&case("exchange.toml"), &[&SLOW[..], &["--set", "time.end=35"]].concat());
    let ended = first.wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let told = format!("  results   {}\n", moved.canonicalize().unwrap().display());
    assert!(ended.stdout.contains(&told), "{}", ended.stdout);
    assert_whole(&place.out(), 35);
    assert_whole(&moved, 95);
}

/// Limits the size of the files of a coordinator, to simulate a full disk. Processes started before
/// have no limit.
fn limit_files(running: &Running<'_>) {
    let limit = Rlimit { current: Some(64 << 10), maximum: Some(64 << 10) };
    prlimit(Some(running.pid()), Resource::Fsize, limit).unwrap();
}

/// Starts a run whose files may not grow any further. The signal for a file that has grown too
/// large does not end it.
fn start_limited<'a>(place: &'a Place, settings: &[&str], log: &str) -> Running<'a> {
    let mut command = place.command(&["run", &case("exchange.toml"), "--out"]);
    command.arg(place.out()).args(sets(settings)).env("RUST_LOG", log);
    let running = place.launch(command);
    place.wait_for_log("every participant is ready");
    limit_files(&running);
    running
}

/// The summary states why the run ended, and every file with its final name is complete.
#[test]
fn a_full_disk_leaves_whole_files_and_a_summary_that_says_so() {
    let fields = ["left.points=20000", "right.points=20000", "output.fields=all"];
    let later = ["output.every=40", "left.delay=10 ms"];
    let fields = [&fields[..], &later[..]].concat();
    let (table, log) = (["time.end=1e6"], ["time.end=400", "left.delay=2 ms"]);
    for (settings, level) in [(&fields[..], "info"), (&table, "info"), (&log, "debug")] {
        let place = Place::new();
        let ended = start_limited(&place, settings, level).wait();
        assert_eq!(ended.code, Some(1), "{}", ended.stderr);
        assert!(ended.stderr.contains("the file system failed at"), "{}", ended.stderr);
        place.assert_nothing_left();
        let summary = place.read_summary();
        assert_eq!(summary["status"], "failed", "{summary}");
        assert!(summary["reason"].as_str().unwrap().contains("the file system failed"));
        for name in ["iterations.csv", "log.jsonl"] {
            let rows = fs::read_to_string(place.out().join(name)).unwrap();
            assert!(rows.ends_with('\n'), "{name}: {:?}", rows.lines().last());
        }
        let files = fs::read_dir(place.out().join("fields")).into_iter().flatten().flatten();
        for path in files.map(|file| file.path()) {
            let text = fs::read(&path).unwrap();
            let whole = text.ends_with(b"</VTKFile>\n") || path.extension().unwrap() != "vti";
            assert!(whole && path.extension().unwrap() != "new", "{}", path.display());
        }
    }
}

#[test]
fn a_result_that_cannot_be_printed_is_an_error() {
    let place = Place::new();
    let file = case("wheel-rail.toml");
    let out = place.out().display().to_string();
    let commands: [&[&str]; 6] = [
        &["run", &file, "--out", &out],
        &["plan", &file],
        &["check", &file],
        &["solvers"],
        &["--help"],
        &["--version"],
    ];
    for arguments in commands {
        let mut command = place.command(arguments);
        command.stdout(fs::File::options().write(true).open("/dev/full").unwrap());
        let ended = place.launch(command).wait();
        assert_eq!(ended.code, Some(1), "{arguments:?}: {}", ended.stderr);
        let told = "error: standard output failed while a result was printed: No space left";
        assert!(ended.stderr.contains(told), "{arguments:?}: {}", ended.stderr);
    }
    assert_eq!(place.read_summary()["status"], "completed", "the results are there");
    // Standard error cannot be written.
    let mut command = place.command(&["run", &file, "--out", &out, "--replace", "--log", "trace"]);
    command.stderr(fs::File::options().write(true).open("/dev/full").unwrap());
    assert_eq!(place.launch(command).wait().code, Some(0));
}

/// The existing result stays until the better one is complete.
#[test]
fn an_answer_stays_while_it_is_refined() {
    let place = Place::new();
    let out = place.out();
    let more = ["--accuracy", "0.2%"];
    let running = place.start_run(&case("wheel-rail.toml"), &more);
    let refined = out.join("refined/log.jsonl");
    let ready = || {
        let log = fs::read_to_string(&refined).unwrap_or_default();
        log.contains("every participant is ready")
    };
    wait_until("a better answer under way", ready);
    running.signal(Signal::INT);
    let ended = running.wait();
    assert_eq!(ended.code, Some(130), "{}", ended.stderr);
    let summary = place.read_summary();
    assert_eq!(summary["status"], "completed");
    assert_eq!(summary["accuracy"]["met"], false);
    assert!(out.join("fields/thermal_contact.pvd").exists());
    let unfinished: PathBuf = out.join("refined/summary.json");
    let unfinished: Value = serde_json::from_slice(&fs::read(unfinished).unwrap()).unwrap();
    assert_eq!(unfinished["status"], "interrupted");
    place.summary(&case("wheel-rail.toml"), &["--accuracy", "1%"]);
    assert!(!out.join("refined").exists());
}

#[test]
fn what_an_option_replaces_is_told() {
    let place = Place::new();
    let set = ["--set", "motion.traction_coefficient=0.3"];
    let ended = place.start(&["check", &case("curving.toml"), set[0], set[1]]).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    // Every warning begins with the keys.
    let told = "warning: motion.creepage.xi, motion.creepage.eta, motion.creepage.phi: \
                --set motion.traction_coefficient=0.3 replaces them; remove them by --unset";
    assert!(ended.stdout.contains(told), "{}", ended.stdout);
    let ended = place.start(&["check", &case("wheel-rail.toml"), set[0], set[1]]).wait();
    assert!(!ended.stdout.contains("warning"), "nothing is replaced: {}", ended.stdout);
}
