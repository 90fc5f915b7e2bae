//! Untrusted files: cases and recordings from other people, with arbitrary content. Without consent
//! no program they name is started and no file is written. No escape sequence reaches a terminal.

use crate::harness::{Ended, Place, case, flat, programs, toy};
use proto::message::{CommandKind, Topics};
use proto::recording::{Compression, Event, Head, Item, Recording, RecordingWriter};
use std::fs::File;
use std::path::{Path, PathBuf};

/// Records a short run.
fn recorded(place: &Place) -> PathBuf {
    place.summary(&case("wheel-rail.toml"), &["--record", "--set", "mech.model=hertz-carter"]);
    place.out().join("recording.mcap")
}

/// Copies a recording with a changed head and changed events.
fn rewritten(
    path: &Path,
    change_head: impl FnOnce(&mut Head),
    change: impl Fn(&mut Event),
) -> PathBuf {
    let mut recording = Recording::open(File::open(path).unwrap()).unwrap();
    let mut head = recording.head().clone();
    change_head(&mut head);
    let copy = path.with_file_name("changed.mcap");
    let out = File::create(&copy).unwrap();
    let mut to = RecordingWriter::create(out, Compression::None, &head, &[]).unwrap();
    while let Some(entry) = recording.read().unwrap() {
        match entry.item {
            Item::Event(mut event) => {
                change(&mut event);
                to.event(&event).unwrap();
            }
            Item::Sample { service, header, values } => {
                to.sample(service, &header, values).unwrap();
            }
            Item::State { role, bytes } => to.state(role, bytes).unwrap(),
        }
    }
    to.finish().unwrap();
    copy
}

/// Copies a recording with changed topics for every participant.
fn with_topics(path: &Path, change: impl Fn(&mut serde_json::Value)) -> PathBuf {
    rewritten(
        path,
        |_| (),
        |event| {
            if let Event::Command { body, .. } = event
                && serde_json::from_slice::<Topics>(body).is_ok()
            {
                let mut topics = serde_json::from_slice(body).unwrap();
                change(&mut topics);
                *body = serde_json::to_vec(&topics).unwrap();
            }
        },
    )
}

/// Asserts that `export` and `replay` reject the recording with these words, write nothing and
/// leave nothing.
fn refused(place: &Place, path: &Path, words: &str) {
    let path = path.display().to_string();
    let csv = place.out().join("exported").display().to_string();
    for arguments in
        [&["export", path.as_str(), "--csv", &csv][..], &["replay", &path, "--only", "thermal"]]
    {
        let Ended { code, stderr, .. } = place.start(arguments).wait();
        assert!([Some(1), Some(2)].contains(&code), "{arguments:?}: {code:?} {stderr}");
        assert!(stderr.contains(words), "{arguments:?}: `{words}` is missing in {stderr}");
        assert!(!stderr.contains("panicked"), "{stderr}");
    }
    assert!(!Path::new(&csv).exists(), "something was exported");
    place.assert_nothing_left();
}

#[test]
fn names_and_grids_of_a_recording_are_checked() {
    let place = Place::new();
    let path = recorded(&place);
    let role = |role: &'static str| {
        rewritten(&path, |head| head.participants[1].role = role.to_owned(), |_| ())
    };
    refused(&place, &role("../../evil"), "the role name \"../../evil\"");
    refused(&place, &role("\u{1b}[2J"), "control character");
    let counts = |ni: u64, nj: u64| {
        with_topics(&path, |topics| {
            for list in ["inputs", "outputs"] {
                for topic in topics[list].as_array_mut().unwrap() {
                    topic["grid"]["ni"] = ni.into();
                    topic["grid"]["nj"] = nj.into();
                }
            }
        })
    };
    refused(&place, &counts(0, 3), "has 0 x 3 points");
    refused(&place, &counts(7_071_068, 7_071_068), "7071068 x 7071068 points");
    let field = with_topics(&path, |topics| {
        for topic in topics["outputs"].as_array_mut().unwrap() {
            topic["field"] = "../../../../tmp/evil".into();
        }
    });
    refused(&place, &field, "the field name \"../../../../tmp/evil\"");
}

/// The author of the file may have named any program.
#[test]
fn a_replay_starts_no_program_that_the_recording_names() {
    let place = Place::new();
    place.summary(&case("exchange.toml"), &["--record", "--set", "time.end=3"]);
    let path = place.out().join("recording.mcap").display().to_string();
    // `toy` is in the folder of the coordinator and is the recorded program.
    let Ended { code, stderr, .. } = place.start(&["replay", &path, "--only", "left"]).wait();
    assert_eq!(code, Some(2), "{stderr}");
    for words in ["no left-solver beside the coordinator", "--command PROGRAM", "`toy`"] {
        assert!(stderr.contains(words), "{stderr}");
    }
    let program = toy("left").join(" ");
    let given = ["replay", &path, "--only", "left", "--command", &program];
    assert_eq!(place.start(&given).wait().code, Some(0));
}

/// Error messages in a recording may contain anything.
#[test]
fn escapes_of_a_recording_reach_no_terminal() {
    let place = Place::new();
    let forged = "\u{1b}[2J\u{9b}31m\n  the run       completed\rx";
    let path = rewritten(
        &recorded(&place),
        |_| (),
        |event| match event {
            Event::Ended { error } => *error = Some(forged.to_owned()),
            Event::Iteration(one) => one.residuals.push((forged.to_owned(), 0.5)),
            Event::Command { command, body, .. }
                if command.kind == CommandKind::Configure as u32 =>
            {
                let mut configuration: serde_json::Value = serde_json::from_slice(body).unwrap();
                configuration["model"] = forged.into();
                *body = serde_json::to_vec(&configuration).unwrap();
            }
            _ => {}
        },
    );
    let path = path.display().to_string();
    let shown = place.start(&["inspect", &path]).wait();
    assert!(shown.stdout.contains("FAILED: \\u{1b}[2J\\u{9b}31m\\n"), "{}", shown.stdout);
    assert!(!shown.stdout.contains("completed\n"), "{}", shown.stdout);
    let json = place.start(&["inspect", &path, "--json"]).wait();
    let seen: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!(seen["error"], forged);
    let replayed = place.start(&["replay", &path, "--only", "thermal"]).wait();
    assert_eq!(replayed.code, Some(2), "{}", replayed.stderr);
    for text in [&shown.stdout, &json.stdout, &replayed.stderr, &replayed.stdout] {
        assert!(!text.contains(['\u{1b}', '\u{9b}', '\r']), "{text:?}");
    }
}

/// Case in a folder of its own.
fn case_file(text: &str) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.toml");
    std::fs::write(&path, text).unwrap();
    let path = path.display().to_string();
    (folder, path)
}

#[test]
fn escapes_of_a_case_and_of_a_participant_reach_no_terminal() {
    let place = Place::new();
    let text = std::fs::read_to_string(case("wheel-rail.toml")).unwrap();
    let (_folder, titled) =
        case_file(&text.replace("title = \"", "title = \"\\u001b[2J\\nno errors"));
    for command in ["check", "plan"] {
        let ended = place.start(&[command, &titled]).wait();
        assert_eq!(ended.code, Some(2), "{}", ended.stderr);
        assert!(ended.stderr.contains("case.title: the text"), "{}", ended.stderr);
        assert!(!ended.stderr.contains('\u{1b}') && ended.stdout.is_empty(), "{ended:?}");
    }
    // Output of a participant during a run, and its description.
    let solver = programs().join("thermal-solver").display().to_string();
    let script =
        |script: &str| format!("thermal.command=[\"sh\", \"-c\", {script:?}, \"{solver}\"]");
    let loud = script("printf '\\033[2J\\rforged\\n' >&2; exec \"$0\" \"$@\"");
    let more = ["--log", "info", "--set", "mech.model=hertz-carter", "--set", &loud];
    let ended = place.run(&case("wheel-rail.toml"), &more);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stderr.contains("\\u{1b}[2J\\rforged"), "{}", ended.stderr);
    assert!(!ended.stderr.contains(['\u{1b}', '\r']), "{:?}", ended.stderr);
    let said = r#"left.command=["toy", "rogue", "escapes"]"#;
    let ended = place.start(&["check", &case("exchange.toml"), "--set", said]).wait();
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("description.models.summary"), "{}", ended.stderr);
    assert!(!ended.stderr.contains('\u{1b}'), "{:?}", ended.stderr);
}

/// The program named by a case is started to describe itself, except with `--no-start`.
#[test]
fn a_case_is_judged_without_starting_what_it_names() {
    let place = Place::new();
    let text = std::fs::read_to_string(case("wheel-rail.toml")).unwrap();
    let mark = place.out().with_file_name("started");
    let touch = format!("echo started > {}", mark.display());
    let command = format!("[thermal]\ncommand = [\"sh\", \"-c\", {touch:?}]\n");
    let (_folder, path) = case_file(&text.replace("[thermal]\n", &command));
    let check = place.start(&["check", &path, "--no-start"]).wait();
    assert_eq!(check.code, Some(0), "{}", check.stderr);
    let said = "no errors in what was checked\nnot checked, because no program was started: models, effects";
    assert!(check.stdout.contains(said), "{}", check.stdout);
    assert!(check.stdout.contains("effects.friction_heat"), "{}", check.stdout);
    let plan = place.start(&["plan", &path, "--no-start"]).wait();
    assert_eq!(plan.code, Some(0), "{}", plan.stderr);
    for words in
        ["wheel-rail · ", "steady: one window", "would start, as the case says: sh -c echo"]
    {
        assert!(plan.stdout.contains(words), "{}", plan.stdout);
    }
    assert!(!mark.exists(), "the program was started");
    let (_folder, wrong) =
        case_file(&text.replace("[thermal]\n", &(command + "\n[limits]\nx = 1\n")));
    let refused = place.start(&["check", &wrong, "--no-start"]).wait();
    assert_eq!(refused.code, Some(2), "{}", refused.stdout);
    assert!(refused.stderr.contains("limits.x: unknown key"), "{}", refused.stderr);
    assert!(!mark.exists(), "the program was started");
    let started = place.start(&["check", &path]).wait();
    assert!(mark.exists() && started.code == Some(1), "{}", started.stderr);
    let help = place.start(&["check", "--help"]).wait();
    assert!(flat(&help.stdout).contains("Starts the programs"), "{}", help.stdout);
}
