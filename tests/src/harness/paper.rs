//! Checks of a reproduction of the paper: figures against theory and CONTACT, and the resulting
//! files.

use super::{Ended, Place};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Reproduces a study into the result folder of the place.
pub fn reproduce(place: &Place, study: &Path, more: &[&str]) -> Ended {
    let (study, out) = (study.display().to_string(), place.out().display().to_string());
    let mut arguments = vec!["reproduce", &study, "--out", &out, "--replace"];
    arguments.extend(more);
    place.start(&arguments).wait()
}

/// Figure of one run of a reproduction.
pub fn figure(record: &Value, run: &str, pointer: &str) -> f64 {
    let runs = record["runs"].as_array().unwrap();
    let found = runs.iter().find(|one| one["name"] == run);
    let found = found.unwrap_or_else(|| panic!("there is no run {run}"));
    found["summary"].pointer(pointer).and_then(Value::as_f64).unwrap()
}

/// Asserts that a figure is within a tolerance.
pub fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) {
    let off = (found - expected).abs();
    assert!(off <= tolerance, "{what}: {found}, expected {expected} ± {tolerance}");
}

/// Largest rise of the rail in a summary.
pub const RISE: &str = "/temperature/rail/max_rise_k";

/// Reads the record of the runs of a reproduction.
pub fn record(place: &Place) -> Value {
    let record = fs::read_to_string(place.out().join("reproduce.json")).unwrap();
    serde_json::from_str(&record).unwrap()
}

/// Carter strips on the patch of Table 2. The tolerances are the last digits of the reference
/// figures plus the error of the grid, 0.2 %.
pub fn assert_carter_strips(record: &Value) {
    let rows = [
        ("0.58", 298.2, -0.829, -0.01149),
        ("0.50", 209.0, -0.857, -0.00832),
        ("0.40", 137.8, -0.886, -0.00594),
        ("0.20", 44.3, -0.943, -0.00258),
    ];
    for (mu, rise, x_over_a, creepage) in rows {
        let of = |pointer: &str| figure(record, &format!("carter-table-2/{mu}"), pointer);
        assert_close(of(RISE), rise, 2e-3 * rise, mu);
        assert_close(of("/temperature/rail/x_over_a"), x_over_a, 5e-3, mu);
        assert_close(of("/contact/creepage_xi"), creepage, 5e-6, mu);
    }
}

/// Closed forms of the paper with its own inputs, to the last digit of the reference figures.
pub fn assert_methods(record: &Value) {
    for (run, rise, x_over_a) in [("knothe-liebelt", 260.9, -0.652), ("ertz-knothe", 261.9, -0.647)]
    {
        assert_close(figure(record, run, RISE), rise, 0.06, run);
        assert_close(figure(record, run, "/temperature/rail/x_over_a"), x_over_a, 1e-3, run);
    }
}

/// The page of the folder can be written again, and shows every drawing stored there as a file.
pub fn assert_shown(place: &Place) {
    let page = place.out().join("report.html");
    let first = fs::read_to_string(&page).unwrap();
    fs::remove_file(&page).unwrap();
    let out = place.out().display().to_string();
    assert_eq!(place.start(&["report", &out]).wait().code, Some(0));
    assert_eq!(fs::read_to_string(&page).unwrap(), first);
    let images = fs::read_dir(place.out().join("img")).unwrap().flatten();
    let images: Vec<String> =
        images.map(|image| fs::read_to_string(image.path()).unwrap()).collect();
    assert!(images.len() > 10, "{}", images.len());
    assert_eq!(first.matches("<svg class=\"plot\"").count(), images.len());
    for image in images {
        assert!(image.starts_with("<svg") && image.contains("<style>"), "{image:.200}");
        assert!(image.contains("class=\"line") || image.contains("class=\"map\""), "{image:.200}");
        // Embedded pixels are skipped: their base64 may contain any letters.
        let parts = image.split("base64,").map(|part| part.split_once('"').map_or(part, |p| p.1));
        let text =
            [image.split("base64,").next().unwrap_or_default(), &parts.skip(1).collect::<String>()]
                .concat();
        assert!(!text.contains("NaN") && !text.contains("inf\""), "{image:.200}");
    }
}
