//! The paper on its own grids: the stored page is up to date, and its figures are correct.

use serde_json::Value;
use std::fs;
use tests::harness::browser::{self, DESK, PHONE};
use tests::harness::paper::{
    RISE, assert_carter_strips, assert_close, assert_methods, assert_shown, figure, record,
    reproduce,
};
use tests::harness::{Place, root};

/// Runs everything again; the page is the same, and its figures agree with theory and CONTACT.
#[test]
fn the_paper_that_is_kept_is_fresh_and_right() {
    let place = Place::new();
    let study = root().join("cases/paper/study.toml");
    let kept = root().join("docs/paper.md").display().to_string();
    let ended = reproduce(&place, &study, &["--check", &kept]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    place.assert_nothing_left();
    let record = record(&place);
    assert_carter_strips(&record);
    assert_half_spaces(&record);
    assert_methods(&record);
    assert_shown(&place);
    // One drawing for each file.
    let drawings = fs::read_dir(place.out().join("img")).unwrap().count();
    browser::assert_shown(&place.out().join("report.html"), &[DESK, PHONE], drawings);
}

/// Half-spaces at a/80 against the limits of CONTACT. The tolerance covers the error of the grid
/// and that of the reference, which is extrapolated to first order. It is larger at μ = 0.2: our
/// values up to a/320 (31.333 K) converge to 31.36 K, 0.4 % below the reference. They are of a
/// higher order, so that an extrapolation to first order would miss by 1.4 %.
fn assert_half_spaces(record: &Value) {
    let rows = [
        ("0.58", 226.9, 0.004),
        ("0.50", 152.1, 0.004),
        ("0.40", 98.6, 0.004),
        ("0.30", 60.3, 0.004),
        ("0.20", 31.5, 0.009),
    ];
    for (mu, limit, tolerance) in rows {
        let [coarse, fine] =
            [40, 80].map(|n| figure(record, &format!("half-space-{n}/{mu}"), RISE));
        assert_close(fine, limit, tolerance * limit, mu);
        assert!((fine - coarse).abs() < tolerance * limit, "the last halving: {coarse} {fine}");
    }
}
