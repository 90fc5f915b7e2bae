//! `coordinator new`, and cases from standard input.

use crate::harness::{Place, root};
use std::io::Write as _;
use std::process::{Command, Output, Stdio};

fn run_in(place: &Place, arguments: &[&str], input: &str) -> Output {
    let folder = place.out();
    std::fs::create_dir_all(&folder).unwrap();
    let mut command = place.command(arguments);
    command
        .current_dir(&folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    finish(command, input)
}

fn finish(mut command: Command, input: &str) -> Output {
    let mut child = command.spawn().unwrap();
    // A case that is rejected early is not read completely.
    let _ = child.stdin.take().unwrap().write_all(input.as_bytes());
    child.wait_with_output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn every_scene_makes_a_case_without_errors() {
    let place = Place::new();
    let list = text(&run_in(&place, &["new", "--list"], "").stdout);
    let scenes: Vec<&str> =
        list.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert!(scenes.len() > 25, "{list}");
    for (n, scene) in scenes.iter().enumerate() {
        let name = format!("case-{n}");
        let made = run_in(&place, &["new", &name, "--scene", scene], "");
        assert!(made.status.success(), "{scene}: {}", text(&made.stderr));
        let checked = run_in(&place, &["check", &format!("{name}.toml")], "");
        assert!(checked.status.success(), "{scene}: {}", text(&checked.stderr));
        let said = text(&checked.stdout);
        assert!(!said.contains("nothing in this case reads"), "{scene}: {said}");
    }
    let first = std::fs::read_to_string(place.out().join("case-0.toml")).unwrap();
    assert!(
        first.contains("name = \"case-0\"") && first.contains("# friction coefficient ["),
        "{first}"
    );
    // Comments describe keys for the models and effects chosen in the case.
    for other in ["for bodies that expand", "steady rolling hardly depends on it"] {
        assert!(!first.contains(other), "{first}");
    }
}

#[test]
fn a_new_case_runs_and_nothing_is_replaced() {
    let place = Place::new();
    assert!(run_in(&place, &["new", "mine"], "").status.success());
    // Keys are explained for the models of the scene, not for thermal expansion or explicit
    // elements.
    let made = std::fs::read_to_string(place.out().join("mine.toml")).unwrap();
    for other in ["for bodies that expand", "steady rolling hardly depends on it"] {
        assert!(!made.contains(other), "{made}");
    }
    let ran = run_in(&place, &["run", "mine.toml", "--set", "mech.resolution=8", "--json"], "");
    assert!(ran.status.success(), "{}", text(&ran.stderr));
    assert!(text(&ran.stdout).contains("\"case\": \"mine\""));
    for (arguments, told) in [
        (&["new", "mine"][..], "is there already"),
        (&["new", "other", "--scene", "nowhere"], "no such scene"),
        (&["run", "mine"], "mine: there is no such file; did you mean mine.toml?"),
        (&["check", "wheel-rail"], "coordinator new mine --scene wheel-rail"),
        (&["ask", "."], ".: this sweep has no surrogate; run: coordinator fit ."),
        (&["new", "a/b"], "letters, digits"),
    ] {
        let refused = run_in(&place, arguments, "");
        assert_eq!(refused.status.code(), Some(2), "{arguments:?}");
        assert!(text(&refused.stderr).contains(told), "{}", text(&refused.stderr));
    }
    place.assert_nothing_left();
}

#[test]
fn a_case_comes_from_standard_input() {
    let place = Place::new();
    let case = std::fs::read_to_string(root().join("cases/wheel-rail.toml")).unwrap();
    let checked = run_in(&place, &["check", "-"], &case);
    assert!(checked.status.success(), "{}", text(&checked.stderr));
    assert!(text(&checked.stdout).contains("no errors"));
    let wrong = run_in(&place, &["check", "-"], "[case]\nname = 3\n");
    assert_eq!(wrong.status.code(), Some(2));
    assert!(text(&wrong.stderr).contains("<stdin>:2:8: case.name"), "{}", text(&wrong.stderr));
    // A study reads its case for every run.
    let vary = "motion.traction_coefficient=0.2,0.4";
    let swept = ["sweep", "-", "--set", "mech.model=hertz-carter", "--vary", vary, "--out", "s"];
    let swept = run_in(&place, &swept, &case);
    assert!(swept.status.success(), "{}", text(&swept.stderr));
    assert!(place.out().join("s/sweep.csv").is_file());
    place.assert_nothing_left();
}
