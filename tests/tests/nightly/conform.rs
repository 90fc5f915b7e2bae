//! All conformance checks: a slow participant on the largest grids, and the mechanical solver with
//! every model.

use serde_json::Value;
use tests::harness::python::interpreter;
use tests::harness::{Place, case, root};

/// Asserts that every applicable check passes, in the given number of settings.
fn conforms(role: &str, name: &str, more: &[&str], inapplicable: &[&str], settings: usize) {
    let (place, case) = (Place::new(), case(name));
    let mut arguments = vec!["conform", "--role", role, "--case", &case, "--json"];
    arguments.extend(more);
    let ended = place.start(&arguments).wait();
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stderr, ended.stdout);
    place.assert_nothing_left();
    let report: Value = serde_json::from_str(&ended.stdout).unwrap();
    assert_eq!(report["settings"].as_array().unwrap().len(), settings);
    let of_no_concern = |name: &Value| inapplicable.iter().any(|one| name == one);
    let expected = |name: &Value| if of_no_concern(name) { "inapplicable" } else { "passed" };
    let checks = report["checks"].as_array().unwrap();
    let as_expected = |row: &Value| row["verdict"] == expected(&row["name"]);
    assert!(checks.iter().all(as_expected), "{}", ended.stdout);
}

/// Both modes; the participant has no volume.
#[test]
fn strip_columns_in_python_conform_up_to_the_largest_grids() {
    let interpreter = interpreter().display().to_string();
    let program = root().join("proto/python/examples/strip_columns.py").display().to_string();
    let more = ["--", &interpreter, &program];
    conforms("thermal", "falling-friction.toml", &more, &["volumes"], 2);
}

/// Mechanics that read temperatures: all models use them.
#[test]
fn the_thermal_solver_conforms_in_a_loop() {
    conforms("thermal", "falling-friction.toml", &[], &["volumes"], 7);
}

/// On coarse grids, with prescribed creepage. The solver runs alone.
#[test]
fn the_mechanical_solver_conforms_with_every_model() {
    let more = [
        "--set",
        "mech.resolution=2",
        "--unset",
        "motion.traction_coefficient",
        "--set",
        "motion.creepage.xi=-0.003",
    ];
    let alone = [
        "received-power",
        "growing-grids",
        "volumes",
        "missing-sample",
        "wrong-sample",
        "not-finite",
    ];
    conforms("mech", "wheel-rail.toml", &more, &alone, 10);
}
