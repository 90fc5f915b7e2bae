//! The whole contract, up to the largest grids, by a participant that takes its time.

use serde_json::Value;
use std::process::Command;
use tests::harness::{Place, case, root};

/// Every check that concerns it passes, in both of its modes.
#[test]
fn strip_columns_in_python_conform_up_to_the_largest_grids() {
    let made = Command::new("python3")
        .arg(root().join("proto/python/environment.py"))
        .arg("--test")
        .output()
        .expect("Python 3.11 is installed");
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let interpreter = String::from_utf8(made.stdout).unwrap();
    let program = root().join("proto/python/examples/strip_columns.py").display().to_string();
    let place = Place::new();
    let case = case("falling-friction.toml");
    let ended = place
        .start(&[
            "conform",
            "--role",
            "thermal",
            "--case",
            &case,
            "--json",
            "--",
            interpreter.trim_end(),
            &program,
        ])
        .wait();
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stderr, ended.stdout);
    place.assert_nothing_left();
    let report: Value = serde_json::from_str(&ended.stdout).unwrap();
    assert_eq!(report["settings"].as_array().unwrap().len(), 2);
    let checks = report["checks"].as_array().unwrap();
    // It has no volume.
    let expected = |name: &Value| if name == "volumes" { "inapplicable" } else { "passed" };
    let as_expected = |row: &Value| row["verdict"] == expected(&row["name"]);
    assert!(checks.iter().all(as_expected), "{}", ended.stdout);
}
