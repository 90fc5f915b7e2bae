//! The page of measurements is up to date, and its fits are plausible.

use tests::harness::paper::{record, reproduce};
use tests::harness::{Place, root};

/// Runs all cases again: the page is the same.
#[test]
fn the_measurements_that_are_kept_are_fresh() {
    let place = Place::new();
    let study = root().join("cases/measured/study.toml");
    let kept = root().join("docs/measured.md").display().to_string();
    let ended = reproduce(&place, &study, &["--check", &kept]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    place.assert_nothing_left();
    let runs = record(&place)["runs"].as_array().unwrap().len();
    assert!(runs > 150, "{runs}");
}
