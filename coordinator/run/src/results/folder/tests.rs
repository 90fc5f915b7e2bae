use super::*;
use crate::results::claim::MARKER;
use crate::results::vtk::SCENE;
use std::os::unix::fs::symlink;
use tempfile::{TempDir, tempdir};

/// Creates a folder with a case file, and returns the path of a missing result folder beside it.
fn place() -> (TempDir, PathBuf, PathBuf) {
    let place = tempdir().unwrap();
    let (out, case) = (place.path().join("out"), place.path().join("mine.toml"));
    fs::write(&case, "case").unwrap();
    (place, out, case)
}

/// Creates such a folder, with a result folder that holds these files of a run.
fn results(files: &[(&str, &str)]) -> (TempDir, PathBuf, PathBuf) {
    let (place, out, case) = place();
    drop(ResultFolder::prepare(&out, &case, Existing::Refuse).unwrap());
    fs::create_dir(out.join("fields")).unwrap();
    for (name, content) in files {
        fs::write(out.join(name), content).unwrap();
    }
    (place, out, case)
}

fn refusal(prepared: Result<ResultFolder, RunError>) -> String {
    match prepared {
        Err(RunError::Usage(what)) => what,
        other => panic!("{other:?}"),
    }
}

fn replace(out: &Path, case: &Path) -> Result<ResultFolder, RunError> {
    ResultFolder::prepare(out, case, Existing::Replace)
}

fn text(path: PathBuf) -> String {
    fs::read_to_string(path).unwrap()
}

#[test]
fn old_results_go_and_foreign_files_stay() {
    let ours = [
        "fields/a_b_000001.vti",
        "fields/a_b_000001.csv",
        "fields/c_000000.vtu",
        "fields/c_000001.vtu.new",
        "fields/a_b.pvd",
        "fields/last.bin",
        "fields/last.bin.new",
        "summary.json",
        "case.toml",
        "recording.mcap",
        "recording-000120.mcap",
        "iterations.csv.new",
    ];
    let foreign = [
        "notes.txt",
        "recording-mine.mcap",
        "fields/mine.vti",
        "fields/mine.pvd",
        "fields/mine_000001.csv",
    ];
    let all: Vec<_> = ours.iter().chain(&foreign).map(|name| (*name, "x")).collect();
    let (_place, out, case) = results(&all);
    replace(&out, &case).unwrap();
    for name in ours {
        assert!(!out.join(name).exists(), "{name}");
    }
    for name in foreign {
        assert_eq!(text(out.join(name)), "x", "{name}");
    }
}

#[test]
fn results_stay_unless_they_are_to_be_replaced() {
    let (_place, out, case) = results(&[("summary.json", "old")]);
    let refused = refusal(ResultFolder::prepare(&out, &case, Existing::Refuse));
    assert!(refused.contains("--replace"), "{refused}");
    assert_eq!(text(out.join("summary.json")), "old");
    replace(&out, &case).unwrap();
    assert!(!out.join("summary.json").exists());
}

#[test]
fn without_a_name_the_next_number_is_taken() {
    let (place, _, _) = place();
    let results = place.path().join("results");
    fs::create_dir_all(results.join("a-2")).unwrap();
    let shown = |n: usize| {
        let folder = ResultFolder::next(&results, "a").unwrap();
        assert_eq!(
            fs::read_link(results.join("latest")).unwrap(),
            folder.shown().file_name().unwrap()
        );
        assert_eq!(folder.shown(), results.join(["a", "a-3"][n]));
    };
    shown(0);
    shown(1);
}

#[test]
fn a_state_goes_and_a_foreign_file_of_its_name_stays() {
    let scene = include_str!("../vtk/open.py");
    let state = format!("fields/{SCENE}");
    for (content, stays) in [(scene, false), ("# mine", true)] {
        let (_place, out, case) = results(&[(&state, content)]);
        replace(&out, &case).unwrap();
        assert_eq!(out.join(&state).exists(), stays);
        assert_eq!(out.join("fields").exists(), stays);
    }
}

/// File names of a run, or a log, do not make a folder a result folder.
#[test]
fn a_folder_without_the_marker_is_refused_and_left_alone() {
    let foreign = ["case.toml", "fields/mine_000001.vti", "summary.json", "log.jsonl", MARKER];
    for but in [4, 5] {
        let (_place, out, case) = place();
        fs::create_dir_all(out.join("fields")).unwrap();
        for name in &foreign[..but] {
            fs::write(out.join(name), "{\"timestamp\":0,\"schema\":1}").unwrap();
        }
        for existing in [Existing::Refuse, Existing::Replace] {
            let refused = refusal(ResultFolder::prepare(&out, &case, existing));
            assert!(refused.contains("no results of a run"), "{refused}");
        }
        assert!(refusal(ResultFolder::resume(&out)).contains("no results of a run"));
        for name in &foreign[..but] {
            assert_eq!(text(out.join(name)), "{\"timestamp\":0,\"schema\":1}");
        }
    }
}

#[test]
fn no_link_is_followed() {
    for name in ["log.jsonl", "summary.json", "iterations.csv", "recording.mcap", ".summary"] {
        let (place, out, case) = results(&[]);
        let target = place.path().join("target");
        fs::write(&target, "mine").unwrap();
        let _ = fs::remove_file(out.join(name));
        symlink(&target, out.join(name)).unwrap();
        let folder = replace(&out, &case).unwrap();
        folder.write_summary(&Summary::default()).unwrap();
        folder.log().unwrap().set_len(0).unwrap();
        assert_eq!(text(target), "mine", "{name}");
    }
    for name in ["fields", "checkpoints", "refined"] {
        let (place, out, case) = results(&[]);
        let _ = fs::remove_dir(out.join(name));
        symlink(place.path(), out.join(name)).unwrap();
        let refused = refusal(replace(&out, &case));
        assert!(refused.contains("is a link, which is not followed"), "{refused}");
    }
    let (place, out, case) = place();
    fs::create_dir(&out).unwrap();
    let target = place.path().join("target");
    symlink(&target, out.join(MARKER)).unwrap();
    assert!(replace(&out, &case).is_err() && !target.exists());
}

#[test]
fn the_case_file_is_never_replaced() {
    let (_place, out, _) = results(&[("case.toml", "mine")]);
    let roundabout = out.join("fields/../case.toml");
    assert!(refusal(replace(&out, &roundabout)).contains("its own case file"));
    assert_eq!(text(out.join("case.toml")), "mine");
}

#[test]
fn a_file_is_no_folder() {
    let (_place, out, case) = results(&[("file", "mine")]);
    for path in [out.join("file"), out.join("file/below")] {
        assert!(refusal(replace(&path, &case)).contains("is not a directory; give one"));
    }
    assert_eq!(text(out.join("file")), "mine");
}

#[test]
fn one_run_at_a_time() {
    let (_place, out, case) = place();
    let first = ResultFolder::prepare(&out, &case, Existing::Refuse).unwrap();
    first.write_summary(&Summary::default()).unwrap();
    for existing in [Existing::Refuse, Existing::Replace] {
        let refused = refusal(ResultFolder::prepare(&out, &case, existing));
        assert!(refused.contains("is used by another run"), "{refused}");
    }
    assert!(refusal(ResultFolder::resume(&out)).contains("is used by another run"));
    assert!(out.join("summary.json").exists(), "the other run's results stay");
    drop(first);
    replace(&out, &case).unwrap();
}

/// Files are replaced, except one that somebody else has put under the name of a result.
fn named(case: &str) -> Summary {
    Summary { case: case.to_owned(), ..Summary::default() }
}

fn text_of(case: &str) -> String {
    String::from_utf8(named(case).to_json()).unwrap()
}

#[test]
fn a_better_answer_takes_the_place_of_the_one_before() {
    let (_place, out, case) = place();
    let answer = ResultFolder::prepare(&out, &case, Existing::Refuse).unwrap();
    answer.write_summary(&named("coarse")).unwrap();
    fs::create_dir(out.join("fields")).unwrap();
    for (name, content) in [("a_000000.vti", "coarse"), ("b_000000.vti", "coarse"), ("x", "mine")] {
        fs::write(out.join("fields").join(name), content).unwrap();
    }
    let refined = answer.refined().unwrap();
    fs::create_dir(refined.file("fields")).unwrap();
    for (name, content) in [("a_000000.vti", "fine"), ("x", "fine")] {
        fs::write(refined.file("fields").join(name), content).unwrap();
    }
    assert_eq!(text(out.join("summary.json")), text_of("coarse"));
    refined.write_summary(&named("fine")).unwrap();
    let answer = answer.take_over(refined).unwrap();
    assert_eq!(text(out.join("summary.json")), text_of("fine"));
    assert_eq!(text(out.join("fields/a_000000.vti")), "fine");
    assert_eq!(text(out.join("fields/x")), "mine");
    assert!(!out.join("fields/b_000000.vti").exists() && !out.join(".summary").exists());
    answer.write_summary(&named("again")).unwrap();
    assert_eq!(text(out.join("summary.json")), text_of("again"));
}
