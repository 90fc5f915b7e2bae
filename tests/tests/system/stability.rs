//! Hard cases: the shipped suite passes, a suite can fail, and its file is read strictly.

use crate::cost::finished_runs;
use crate::harness::{Ended, Place, case, root, wait_until};
use rustix::process::Signal;
use serde_json::Value;
use std::fs;
use std::path::PathBuf;

/// Runs a suite into the output folder of the place.
fn stability(place: &Place, suite: &str, more: &[&str]) -> Ended {
    let out = place.out().display().to_string();
    let mut arguments = vec!["stability", suite, "--out", &out];
    arguments.extend(more);
    place.start(&arguments).wait()
}

/// Suite in a folder of its own.
fn own_suite(text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("suite.toml");
    fs::write(&path, text).unwrap();
    (folder, path)
}

const EVERY: &str = "[every]\nnot_negative = [\"pressure\"]\nundershoot = 1e-9\nenergy = 1e-10\n";

/// Rolling contact whose pressure is compared with this bound.
fn one_case(bound: &str) -> String {
    format!(
        "{EVERY}[[hard]]\nnumber = 1\nname = \"pressure\"\ntitle = \"one contact\"\n\
         case = {:?}\nset = [\"mech.model=hertz-carter\", \"mech.resolution=4\"]\n\
         [[hard.check]]\nname = \"Hertz pressure\"\nof = {{ \"contact.max_pressure_pa\" = 1 }}\n\
         {bound}\nbecause = \"Hertz\"\n",
        case("wheel-rail.toml")
    )
}

/// Cases in explicit elements of more than five seconds.
const SLOW: [&str; 2] = ["joint", "incompressible-elements"];

/// Asserts that the cases of the suite with this number in the list of hard cases pass, with their
/// sweeps if requested. (The target `nightly` runs the slow cases and all sweeps, and checks every
/// documented limit.)
fn hold(number: i64, sweeps: bool) {
    let is_slow = |case: &toml::Value| SLOW.contains(&case["name"].as_str().unwrap());
    cases_hold(|case| case["number"].as_integer() == Some(number) && !is_slow(case), sweeps);
}

/// Asserts that these cases pass; the report covers each, and docs/limits.md has a section for it.
fn cases_hold(wanted: impl Fn(&toml::Value) -> bool, sweeps: bool) {
    let suite = shipped();
    let cases = suite["hard"].as_array().unwrap().iter();
    let cases: Vec<&toml::Value> = cases.filter(|case| wanted(case)).collect();
    assert!(!cases.is_empty());
    let text = |case: &toml::Value, key: &str| case[key].as_str().unwrap().to_owned();
    let names: Vec<String> = cases.iter().map(|case| text(case, "name")).collect();
    let mut more: Vec<&str> = names.iter().flat_map(|name| ["--only", name]).collect();
    more.extend((!sweeps).then_some("--no-sweep"));
    let place = Place::new();
    let ended = stability(&place, &case("hard/suite.toml"), &more);
    assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
    place.assert_nothing_left();
    let report = fs::read(place.out().join("stability.json")).unwrap();
    let report: Value = serde_json::from_slice(&report).unwrap();
    assert_eq!(report["cases"].as_array().unwrap().len(), names.len());
    let page = fs::read_to_string(place.out().join("report.html")).unwrap();
    let limits = fs::read_to_string(root().join("docs/limits.md")).unwrap();
    for (name, case) in names.iter().zip(&cases) {
        assert!(ended.stdout.contains(name) && page.contains(name), "{name} is not told");
        let heading = format!("## {}. {name}: {}\n", case["number"], text(case, "title"));
        assert!(limits.contains(&heading), "docs/limits.md does not tell of {name}");
    }
}

fn shipped() -> toml::Table {
    fs::read_to_string(case("hard/suite.toml")).unwrap().parse().unwrap()
}

// Limits of each kind: rejection, a violated bound, a failed run, none.
table_of_tests! { hold:
    coarse_cells_hold_to_their_edges(1, true);
    traction_at_the_limit_holds(2, false);
    tiny_loads_and_creepages_hold(3, false);
    falling_friction_holds(4, false);
    thermo_elastic_instability_holds(5, false);
    rods_with_several_states_hold(6, false);
    contacts_that_merge_and_are_lost_hold(7, false);
    contrasts_hold(8, false);
    extreme_windows_hold(9, false);
    stretched_elements_hold(10, false);
    what_must_not_be_sent_holds(11, false);
    the_ends_of_tables_hold_to_their_edges(12, true);
}

/// Limits that depend on rounding or on the magnitude of numbers: loads down to the smallest
/// floating-point number, and loops that barely converge or have no solution.
#[test]
fn edges_of_numbers_and_of_iterations_hold() {
    let names = ["tiny-load-exact", "falling-to-nothing", "hot-limit", "above-instability"];
    cases_hold(|case| names.contains(&case["name"].as_str().unwrap()), true);
}

/// The list of hard cases has twelve numbers; each must occur.
#[test]
fn every_hard_case_is_met() {
    let suite = shipped();
    let entries = suite["hard"].as_array().unwrap().iter();
    let numbers: Vec<i64> = entries.map(|entry| entry["number"].as_integer().unwrap()).collect();
    assert!((1..=12).all(|number| numbers.contains(&number)), "{numbers:?}");
}

/// A violated bound fails the suite, and the message names case, figure and bound; a satisfied one
/// does not.
#[test]
fn a_bound_that_does_not_hold_is_named() {
    // The Hertz pressure of the case is 1364.4 MPa.
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

/// An unexpected outcome fails the suite: a result in place of a rejection, a different message,
/// and a limit at a different place.
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
        (answers, "the run gave a result"),
        (refused, "“no such words” is not in"),
        (edge, "resolution 2: the run gave a result"),
    ] {
        let place = Place::new();
        let (_folder, suite) = own_suite(&text);
        let ended = stability(&place, suite.to_str().unwrap(), &[]);
        assert_eq!(ended.code, Some(1), "{}", ended.stderr);
        assert!(ended.stdout.contains(told), "{told}: {}", ended.stdout);
    }
}

/// A stopped suite keeps its finished runs, and the same command continues with them. Several runs
/// at a time give the report of the suite in its order.
#[test]
fn a_suite_that_is_stopped_goes_on() {
    let values: Vec<String> = (10..50).map(|count| count.to_string()).collect();
    let sweep = format!(
        "[[hard.sweep]]\nparameter = \"resolution\"\nset = [\"mech.resolution={{}}\"]\n\
         values = {values:?}\nbefore = \"an answer\"\nwhy = \"no reason\"\n"
    );
    let place = Place::new();
    let (_folder, suite) = own_suite(&(one_case("at_most = 1e10") + &sweep));
    let out = place.out().display().to_string();
    let arguments = ["stability", suite.to_str().unwrap(), "--out", &out, "--jobs", "2"];
    let running = place.start(&arguments);
    wait_until("finished runs", || finished_runs(&place).len() >= 2);
    running.signal(Signal::INT);
    let ended = running.wait();
    assert_eq!(ended.code, Some(130), "{}", ended.stderr);
    let kept = finished_runs(&place);
    let ended = place.start(&arguments).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let told = format!("{} runs of the interrupted study are reused", kept.len());
    assert!(ended.stderr.contains(&told), "{told}: {}", ended.stderr);
    let report: Value =
        serde_json::from_slice(&fs::read(place.out().join("stability.json")).unwrap()).unwrap();
    let rows = report["cases"][0]["sweeps"][0]["rows"].as_array().unwrap();
    let found: Vec<&str> = rows.iter().map(|row| row[0].as_str().unwrap()).collect();
    assert_eq!(found, values);
    for run in &kept {
        let name = run["options"][0].as_str().unwrap();
        let place = values.iter().position(|value| name == format!("pressure-resolution-{value}"));
        let row = place.map_or(&report["cases"][0]["row"], |at| &rows[at][1]);
        // The time shows that the run was not repeated.
        assert_eq!(row["seconds"], run["seconds"], "{name}");
    }
    assert!(finished_runs(&place).is_empty());
    place.assert_nothing_left();
}

/// An error in a suite file is rejected with its place, before any run.
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
    assert!(unknown.stderr.contains("no case `presure`; known: pressure"), "{}", unknown.stderr);
}
