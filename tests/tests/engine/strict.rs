//! Warnings of the shipped cases, which `run --strict` turns into errors.

use crate::harness::{Place, case, fleet, planned, root, sets};
use serde_json::Value;
use std::fs;

/// A shipped case is an example: its plan gives no warning.
#[test]
fn the_plan_of_a_shipped_case_has_no_warning() {
    let names = |folder: &str| -> Vec<String> {
        let entries = fs::read_dir(root().join("cases").join(folder)).unwrap().flatten();
        let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
        let cases = names.filter(|name| name.ends_with(".toml") && name != "study.toml");
        cases.map(|name| format!("{folder}{name}")).collect()
    };
    let names = [names(""), names("measured/")].concat();
    assert!(names.len() > 60, "{names:?}");
    for name in &names {
        let planned = planned(&case(name), &[], &mut fleet());
        let warnings = planned.unwrap_or_else(|error| panic!("{name}: {error}")).plan.warnings;
        assert_eq!(warnings, [], "{name}");
    }
}

/// A case that prescribes the speed of a surface is meant to slide: its creepage is not judged as
/// that of a wheel that rolls. The grids are coarse, and say nothing about the creepage.
fn slides(name: &str, settings: &[&str]) {
    let place = Place::new();
    let summary = place.summary(&case(name), &sets(settings));
    let creepage = summary["contact"]["creepage_xi"].as_f64().unwrap();
    assert!(creepage.abs() > 0.05, "{name} rolls: {creepage}");
    let warnings = summary["warnings"].as_array().cloned().unwrap_or_default();
    let judged = |warning: &&Value| warning["key"] == "contact.creepage_xi";
    assert_eq!(warnings.iter().find(judged), None, "{name}");
}

table_of_tests! { slides:
    a_pin_on_a_disc_slides("pin-on-disc.toml", &["mech.resolution=6", "time.end=40 us"]);
    a_locked_wheel_slides("locked-wheel.toml", &["mech.resolution=6", "time.end=0.2 ms"]);
    a_locked_wheel_in_a_steady_state_slides("locked-wheel-steady.toml", &["mech.resolution=6"]);
    flanks_of_gears_slide("gear-flank.toml", &["mech.resolution=6"]);
    a_spinning_wheel_slides("wheel-spin.toml", &["mech.resolution=6"]);
    a_wheel_with_thermal_stress_slides("thermal-stress.toml", &["mech.resolution=6"]);
    a_brake_block_slides("brake-block.toml", &["time.end=25 ms"]);
}
