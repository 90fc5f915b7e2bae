//! The result directory, as other programs read it.

use crate::harness::{Place, case};

#[test]
fn the_files_of_a_steady_run() {
    let place = Place::new();
    place.summary(&case("wheel-rail.toml"), &[]);
    let out = place.out();
    for name in ["summary.json", "iterations.csv", "case.toml", "log.jsonl"] {
        assert!(out.join(name).is_file(), "{name}");
    }
    let as_run = std::fs::read_to_string(out.join("case.toml")).unwrap();
    assert_eq!(as_run, std::fs::read_to_string(case("wheel-rail.toml")).unwrap());
    let mut fields: Vec<String> = std::fs::read_dir(out.join("fields"))
        .unwrap()
        .flatten()
        .map(|e| e.file_name().into_string().unwrap())
        .collect();
    fields.sort();
    let expected = [
        "mech_contact.pvd",
        "mech_contact_000000.vti",
        "thermal_contact.pvd",
        "thermal_contact_000000.vti",
        "thermal_rail_section.pvd",
        "thermal_rail_section_000000.vti",
        "thermal_wheel_section.pvd",
        "thermal_wheel_section_000000.vti",
    ];
    assert_eq!(fields, expected);
}

/// The case as run gives the same answer again.
#[test]
fn the_case_as_run_can_be_run() {
    let (first, second) = (Place::new(), Place::new());
    let set = ["--set", "motion.traction_coefficient=0.4", "--set", "mech.resolution=10"];
    let one = first.summary(&case("wheel-rail.toml"), &set);
    let two = second.summary(&first.out().join("case.toml").display().to_string(), &[]);
    for part in ["contact", "temperature", "effects"] {
        assert_eq!(one[part], two[part]);
    }
}

#[test]
fn a_transient_run_writes_a_series() {
    let place = Place::new();
    place.summary(&case("cold-start.toml"), &[]);
    let series = std::fs::read_to_string(place.out().join("fields/thermal_contact.pvd")).unwrap();
    // Every tenth of 51 windows, and the last one.
    assert_eq!(series.matches("<DataSet").count(), 6, "{series}");
    assert!(series.contains("thermal_contact_000050.vti"));
    let table = std::fs::read_to_string(place.out().join("iterations.csv")).unwrap();
    assert_eq!(table.lines().count(), 52);
}

/// A quantity that a model cannot give is absent, never 0.
#[test]
fn absent_is_not_zero() {
    let place = Place::new();
    let summary = place.summary(&case("full-slip.toml"), &[]);
    let contact = summary["contact"].as_object().unwrap();
    assert!(!contact.contains_key("approach_m"), "the patch is given: no approach is known");
    assert!(!contact.contains_key("spin_moment_nm"));
    assert!(contact.contains_key("slip_area_ratio"));
}

#[test]
fn quiet_prints_nothing() {
    let place = Place::new();
    let ended = place.run(&case("wheel-rail.toml"), &["--quiet"]);
    assert_eq!((ended.stdout.as_str(), ended.stderr.as_str()), ("", ""));
}

#[test]
fn solvers_lists_every_model_with_its_source() {
    let text = Place::new().start(&["solvers"]).wait().stdout;
    for word in ["hertz-carter", "columns", "ertz-knothe", "friction_heat", "source:"] {
        assert!(text.contains(word), "`{word}` is missing in:\n{text}");
    }
}
