//! The hard cases: the suite as it is shipped, that it can fail, and that it is read strictly.

use crate::harness::{Ended, Place, case, root};
use serde_json::Value;
use std::fs;
use std::path::PathBuf;

/// Runs a suite into the place's output folder.
fn stability(place: &Place, suite: &str, more: &[&str]) -> Ended {
    let out = place.out().display().to_string();
    let mut arguments = vec!["stability", suite, "--out", &out];
    arguments.extend(more);
    place.start(&arguments).wait()
}

/// A suite of a folder of its own.
fn own_suite(text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("suite.toml");
    fs::write(&path, text).unwrap();
    (folder, path)
}

const EVERY: &str = "[every]\nnot_negative = [\"pressure\"]\nundershoot = 1e-9\nenergy = 1e-10\n";

/// A rolling contact whose pressure is held against this bound.
fn one_case(bound: &str) -> String {
    format!(
        "{EVERY}[[hard]]\nnumber = 1\nname = \"pressure\"\ntitle = \"one contact\"\n\
         case = {:?}\nset = [\"mech.model=hertz-carter\", \"mech.resolution=4\"]\n\
         [[hard.check]]\nname = \"Hertz pressure\"\nof = {{ \"contact.max_pressure_pa\" = 1 }}\n\
         {bound}\nbecause = \"Hertz\"\n",
        case("wheel-rail.toml")
    )
}

/// Every hard case and every edge is where the suite says, the report tells of each, and
/// docs/limits.md is what the suite finds.
#[test]
fn every_hard_case_holds_and_the_limits_are_as_documented() {
    let place = Place::new();
    let found = place.out().with_file_name("limits.md");
    let suite = case("hard/suite.toml");
    let more = ["--write-limits", found.to_str().unwrap()];
    let ended = stability(&place, &suite, &more);
    assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
    let report: Value =
        serde_json::from_slice(&fs::read(place.out().join("stability.json")).unwrap()).unwrap();
    let cases = report["cases"].as_array().unwrap();
    let page = fs::read_to_string(place.out().join("report.html")).unwrap();
    for case in cases {
        let name = case["name"].as_str().unwrap();
        assert!(ended.stdout.contains(name) && page.contains(name), "{name} is not told");
    }
    // The list of hard cases has twelve numbers; each is met or waits.
    let numbers = |list: &str| -> Vec<u64> {
        let entries = report[list].as_array().unwrap().iter();
        entries.map(|entry| entry["number"].as_u64().unwrap()).collect()
    };
    let all = [numbers("cases"), numbers("waiting")].concat();
    assert!((1..=12).all(|number| all.contains(&number)), "{all:?}");
    let documented = fs::read_to_string(root().join("docs/limits.md")).unwrap();
    let found = fs::read_to_string(&found).unwrap();
    assert!(
        documented == found,
        "docs/limits.md is stale; write it with `coordinator stability --write-limits \
         docs/limits.md`. Found:\n{found}"
    );
}

/// A bound that does not hold fails the suite, which names the case, the figure and the bound; one
/// that holds does not.
#[test]
fn a_bound_that_does_not_hold_is_named() {
    // Hertz's pressure of the case is 1364.4 MPa.
    for (bound, code) in [("at_most = 1.5e9", 0), ("at_most = 1.0e9", 1), ("at_least = 1.4e9", 1)] {
        let place = Place::new();
        let (_folder, suite) = own_suite(&one_case(bound));
        let ended = stability(&place, suite.to_str().unwrap(), &[]);
        assert_eq!(ended.code, Some(code), "{bound}: {}", ended.stderr);
        let named = ended.stderr.contains("pressure did not meet expectations");
        assert_eq!(named, code == 1, "{bound}: {}", ended.stderr);
        let figure = ended.stdout.contains("Hertz pressure: 1.364");
        assert_eq!(figure, code == 1, "{bound}: {}", ended.stdout);
        let rewritten = place.start(&["report", place.out().to_str().unwrap()]).wait();
        assert_eq!(rewritten.code, Some(0), "{}", rewritten.stderr);
    }
}

/// An end that is not the expected one fails the suite: an answer in the place of a refusal, another
/// message, and an edge elsewhere.
#[test]
fn another_end_is_named() {
    let refusal =
        "expect.refusal = { exit_code = 2, saying = [\"no such words\"] }\n[[hard.check]]";
    let answers = one_case("at_most = 1e10").replace("[[hard.check]]", refusal);
    let refused = answers.replace("mech.resolution=4", "mech.resolution=0");
    let edge = one_case("at_most = 1e10")
        + "[[hard.sweep]]\nparameter = \"resolution\"\nset = [\"mech.resolution={}\"]\n\
           values = [\"4\", \"2\", \"0\"]\nbefore = \"an answer\"\nwhy = \"no reason\"\n\
           edge = { at = \"2\", beyond.refusal = { exit_code = 2, saying = [] } }\n";
    for (text, told) in [
        (answers, "an answer came"),
        (refused, "“no such words” is not in"),
        (edge, "resolution 2: an answer came"),
    ] {
        let place = Place::new();
        let (_folder, suite) = own_suite(&text);
        let ended = stability(&place, suite.to_str().unwrap(), &[]);
        assert_eq!(ended.code, Some(1), "{}", ended.stderr);
        assert!(ended.stdout.contains(told), "{told}: {}", ended.stdout);
    }
}

/// What is wrong in a suite file is refused with its place, before anything runs.
#[test]
fn a_wrong_suite_is_refused_with_its_place() {
    let good = one_case("at_most = 1e10");
    for (text, told) in [
        (good.replace("number = 1", "numero = 1"), ":6: unknown field `numero`"),
        (good.replace("wheel-rail.toml", "no-case.toml"), ":9: there is no case file"),
        (good.replace("at_most = 1e10", ""), "check `Hertz pressure` needs one bound"),
        (good.replace("at_most = 1e10", "at_most = -1.0"), "a positive `at_most`"),
        (good.clone() + &good[EVERY.len()..], "`pressure` is defined twice"),
        (good.replace("[[hard.check]]", "expect.breach = \"x\"\n[[hard.check]]"), "no check `x`"),
    ] {
        let place = Place::new();
        let (_folder, suite) = own_suite(&text);
        let ended = stability(&place, suite.to_str().unwrap(), &[]);
        assert_eq!(ended.code, Some(2), "{told}: {}", ended.stderr);
        let place_and_reason = ended.stderr.contains(&format!("{}", suite.display()));
        assert!(place_and_reason && ended.stderr.contains(told), "{told}: {}", ended.stderr);
        assert!(!place.out().exists(), "nothing is written");
    }
    let place = Place::new();
    let missing = stability(&place, "no/such/suite.toml", &[]);
    assert_eq!(missing.code, Some(2));
    assert!(missing.stderr.contains("no/such/suite.toml: "), "{}", missing.stderr);
    let (_folder, suite) = own_suite(&good);
    let unknown = stability(&place, suite.to_str().unwrap(), &["--only", "presure"]);
    assert_eq!(unknown.code, Some(2));
    assert!(unknown.stderr.contains("no case `presure`; it has pressure"), "{}", unknown.stderr);
}
