//! Hard cases with all their sweeps.

use serde_json::Value;
use std::fs;
use tests::harness::{Place, case, root};

/// Every hard case and every limit agrees with the suite, the report covers each, and
/// docs/limits.md agrees with the results.
#[test]
fn every_hard_case_holds_and_the_limits_are_as_documented() {
    let place = Place::new();
    let found = place.out().with_file_name("limits.md");
    let (suite, out) = (case("hard/suite.toml"), place.out().display().to_string());
    let limits = found.to_str().unwrap();
    let ended = place.start(&["stability", &suite, "--out", &out, "--write-limits", limits]).wait();
    assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
    let report: Value =
        serde_json::from_slice(&fs::read(place.out().join("stability.json")).unwrap()).unwrap();
    let cases = report["cases"].as_array().unwrap();
    let page = fs::read_to_string(place.out().join("report.html")).unwrap();
    for case in cases {
        let name = case["name"].as_str().unwrap();
        assert!(ended.stdout.contains(name) && page.contains(name), "{name} is not told");
    }
    // The list of hard cases has twelve numbers; each must occur.
    let numbers = |list: &str| -> Vec<u64> {
        let entries = report[list].as_array().unwrap().iter();
        entries.map(|entry| entry["number"].as_u64().unwrap()).collect()
    };
    let all = numbers("cases");
    assert!((1..=12).all(|number| all.contains(&number)), "{all:?}");
    let documented = fs::read_to_string(root().join("docs/limits.md")).unwrap();
    let found = fs::read_to_string(&found).unwrap();
    assert!(
        documented == found,
        "docs/limits.md is stale; write it with `coordinator stability --write-limits \
         docs/limits.md`. Found:\n{found}"
    );
}
