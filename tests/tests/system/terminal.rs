//! Output of commands: lines of the terminal's width, colours if wanted, JSON on request.

use crate::harness::{Place, case};
use serde_json::Value;

/// Runs a command to its end; returns standard output.
fn printed(place: &Place, arguments: &[&str], code: i32) -> String {
    let ended = place.start(arguments).wait();
    assert_eq!(ended.code, Some(code), "{arguments:?}: {}", ended.stderr);
    ended.stdout
}

fn parsed(place: &Place, arguments: &[&str], code: i32) -> Value {
    serde_json::from_str(&printed(place, arguments, code)).unwrap()
}

#[test]
fn lines_are_no_longer_than_a_terminal_is_wide() {
    let place = Place::new();
    let (file, out) = (case("falling-friction.toml"), place.out().display().to_string());
    let help = ["run", "--help"];
    for arguments in [&["run", &file, "--out", &out][..], &["plan", &file], &help] {
        let text = printed(&place, arguments, 0);
        let long: Vec<&str> = text.lines().filter(|line| line.chars().count() > 80).collect();
        // A single word, such as a path, is not broken.
        let whole = |line: &&str| line.split_whitespace().any(|word| word.chars().count() > 60);
        assert!(long.iter().all(whole), "{arguments:?}: {long:?}");
    }
}

#[test]
fn colours_are_where_they_are_wanted() {
    let place = Place::new();
    let file = case("wheel-rail.toml");
    let plain = printed(&place, &["plan", &file], 0);
    assert!(!plain.contains('\u{1b}'), "a pipe has no colours");
    let coloured = printed(&place, &["plan", &file, "--color", "always"], 0);
    assert!(coloured.contains("\u{1b}[36meffects\u{1b}[0m"), "{coloured}");
    assert_eq!(printed(&place, &["plan", &file, "--color", "never"], 0), plain);
    let ended = place.start(&["plan", "no-such-file.toml", "--color", "always"]).wait();
    assert!(ended.stderr.contains("\u{1b}[1;31merror\u{1b}[0m"), "{}", ended.stderr);
}

#[test]
fn what_is_printed_as_json_is_what_the_files_have() {
    let place = Place::new();
    let (file, out) = (case("wheel-rail.toml"), place.out().display().to_string());
    let small = "mech.resolution=8";
    let summary = parsed(&place, &["run", &file, "--set", small, "--out", &out, "--json"], 0);
    assert_eq!(summary, place.read_summary());
    // A failed run is reported in JSON too.
    let other = Place::new();
    let out = other.out().display().to_string();
    let falling = case("falling-friction.toml");
    let failing = [
        "run",
        &falling,
        "--set",
        "coupling.max_iterations=2",
        "--out",
        &out,
        "--replace",
        "--json",
    ];
    let failing = parsed(&other, &failing, 3);
    assert_eq!(failing["status"], "failed");
    let plan = parsed(&place, &["plan", &file, "--set", small, "--json"], 0);
    let kept = std::fs::read(place.out().join("plan.json")).unwrap();
    let kept: Value = serde_json::from_slice(&kept).unwrap();
    assert_eq!(plan["fields"], kept["fields"]);
    assert_eq!(plan["effects"], kept["effects"]);
    let roles: Vec<Value> = parsed(&place, &["solvers", "--json"], 0)
        .as_array()
        .unwrap()
        .iter()
        .map(|one| one["role"].clone())
        .collect();
    assert_eq!(roles, ["mech", "thermal"]);
    let wrong =
        ["check", &file, "--json", "--set", "motion.sped=3", "--unset", "load.normal_force"];
    let wrong = parsed(&place, &wrong, 2);
    let errors = wrong["errors"].as_array().unwrap();
    let sped = errors.iter().find(|one| one["key"] == "motion.sped").unwrap();
    assert_eq!(sped["fix"], "write `motion.speed`");
    assert!(
        errors.len() >= 2 && errors.iter().all(|one| one["place"] != "" && one["reason"] != "")
    );
    let odd = ["check", &file, "--json", "--set", "bodies.wheel.radius_x=420"];
    let odd = parsed(&place, &odd, 0);
    assert_eq!(odd["errors"], serde_json::json!([]));
    assert_eq!(odd["warnings"][0]["bound"], 50.0);
}

#[test]
fn shells_complete_commands_and_each_has_a_page() {
    let place = Place::new();
    for shell in ["bash", "zsh", "fish"] {
        let script = printed(&place, &["completions", shell], 0);
        assert!(script.contains("reproduce"), "{shell}");
        assert!(script.contains("sweep") && script.contains("vary"), "{shell}");
    }
    let folder = place.out().join("man");
    printed(&place, &["man", &folder.display().to_string()], 0);
    let page = std::fs::read_to_string(folder.join("coordinator-run.1")).unwrap();
    assert!(page.starts_with(".ie") && page.contains("\\-\\-record"), "{page:.400}");
    assert!(page.contains("[\\-\\-set <KEY=VALUE>]..."), "{page:.800}");
    assert!(folder.join("coordinator.1").is_file());
}
