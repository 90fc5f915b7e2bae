//! The executable describes an FMU, and rejects invalid input before any code of the FMU runs.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use fmu_participant::solver::{Fmu, FmuSolver};
use proto::configuration::{Layout, Refusal};
use proto::model::Solver;
use serde_json::{Value, json};
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use zip::write::SimpleFileOptions;

/// Packs an FMU without a library: only its description is read.
fn fmu(folder: &Path, name: &str, description: &str) -> PathBuf {
    let path = folder.join(name);
    let mut zip = zip::ZipWriter::new(File::create(&path).unwrap());
    zip.start_file("modelDescription.xml", SimpleFileOptions::default()).unwrap();
    zip.write_all(description.as_bytes()).unwrap();
    zip.finish().unwrap();
    path
}

const VEHICLE: &str = include_str!("../../../tests/fmus/vehicle/modelDescription.xml");
const BODY: &str = include_str!("../../../tests/fmus/body/modelDescription.xml");

fn ask(path: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fmu-participant"))
        .arg(path)
        .args(arguments)
        .env_remove("RUST_LOG")
        .output()
        .unwrap()
}

fn answer(path: &Path, arguments: &[&str]) -> Value {
    let output = ask(path, arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn refused(path: &Path, arguments: &[&str], words: &str) {
    let output = ask(path, arguments);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && said.contains(words), "{arguments:?}: {said}");
}

#[test]
fn it_says_what_the_fmu_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = fmu(folder.path(), "car.fmu", VEHICLE);
    let wires = ["--wire", "Q -> load.normal_force", "--wire", "Fx, Fy, Fz <- contact_force"];
    let said = answer(&path, &[&wires[..], &["--describe"]].concat());
    assert_eq!((&said["role"], &said["standalone"]), (&json!("car"), &json!(true)));
    let model = &said["models"][0];
    assert_eq!(model["provides"], json!(["load.normal_force"]));
    assert_eq!(model["consumes"], json!(["contact_force"]));
    assert_eq!((&model["steady"], model.get("rewinds")), (&json!(false), None));
    assert_eq!(said["fields"][0]["unit"], "N");
    let keys: Vec<_> = said["keys"].as_array().unwrap().iter().map(|key| &key["path"]).collect();
    assert_eq!(keys[..2], ["car.start.speed", "car.start.body.mass"]);
    let figures: Vec<_> =
        said["figures"].as_array().unwrap().iter().map(|one| (&one["key"], &one["unit"])).collect();
    assert_eq!(figures[0], (&json!("car.Q"), &json!("N")));
    let named = answer(&path, &["--role", "vehicle", "--describe"]);
    assert_eq!(named["role"], "vehicle");
    let without = VEHICLE.replace("canGetAndSetFMUstate=\"true\"", "");
    let without = answer(&fmu(folder.path(), "b.fmu", &without), &["--describe"]);
    assert_eq!(without["models"][0]["rewinds"], json!(false));
}

/// Layout of an FMU that plays `thermal` with these wires, or its refusal.
fn configured(path: &Path, wires: &[&str], configuration: Value) -> Result<Layout, Refusal> {
    let wires: Vec<String> = wires.iter().map(|&wire| wire.to_owned()).collect();
    let solver = FmuSolver::new(Fmu::read(path, "thermal", &wires).unwrap(), None);
    let setup = solver.configure(&serde_json::from_value(configuration).unwrap())?;
    Ok(setup.layout().clone())
}

/// Configuration with the friction power density on 24 x 16 elements, for a program that replaces
/// the thermal solver.
fn configuration(case: &Value) -> Value {
    json!({
        "role": "thermal", "model": "co-simulation", "mode": "transient", "case": {"thermal": case},
        "inputs": [{
            "field": {"name": "friction_power", "unit": "W/m2", "components": 1, "mapping": "conservative",
                      "body": "interface", "meaning": "frictional power density"},
            "producer": "mech",
            "grid": {"name": "contact", "revision": 1, "kind": "structured", "origin": [-0.0046, -0.003, 0.0],
                     "step_i": [4e-4, 0.0, 0.0], "step_j": [0.0, 4e-4, 0.0], "ni": 24, "nj": 16}
        }],
        "outputs": ["lower_temperature"], "observed": []
    })
}

#[test]
fn arrays_are_placed_by_the_case() {
    let folder = tempfile::tempdir().unwrap();
    let path = fmu(folder.path(), "thermal.fmu", BODY);
    let arrays = ["q <- friction_power", "surface -> lower_temperature"];
    let with = |case: Value| configured(&path, &arrays, configuration(&case));
    let lost = with(json!({})).unwrap_err();
    assert!(lost.reason.contains(
        "`q` has 96 values in the FMU, and `friction_power` has 384 on the grid `contact`"
    ));
    assert!(lost.fix.contains("[thermal.grid]"), "{lost}");
    let grid = json!({"grid": {"x_from": -0.006, "x_to": 0.006, "y_from": -0.004, "y_to": 0.004, "nx": 12, "ny": 8}});
    let layout = json!(with(grid).unwrap());
    assert_eq!(layout["inputs"], json!([{"field": "friction_power", "grid": "fmu"}]), "{layout}");
    assert_eq!(layout["fields"], json!([{"field": "lower_temperature", "grid": "fmu"}]));
    assert_eq!((&layout["grids"][0]["ni"], &layout["grids"][0]["nj"]), (&json!(12), &json!(8)));
    let none = json!({"grid": {"x_from": 0, "x_to": 0, "y_from": 0, "y_to": 1, "nx": 1, "ny": 1}});
    assert_eq!(with(none).unwrap_err().key, "thermal.grid");
}

#[test]
fn a_scalar_is_the_same_everywhere() {
    let folder = tempfile::tempdir().unwrap();
    let path = fmu(folder.path(), "thermal.fmu", BODY);
    let with = |wires: [&str; 2]| configured(&path, &wires, configuration(&json!({})));
    let layout = with(["P <- integral(friction_power)", "T -> lower_temperature"]).unwrap();
    let expected = json!([{"field": "lower_temperature", "grid": "contact"}]);
    assert_eq!(json!(layout.fields), expected);
    let whole = with(["P <- friction_power", "T -> lower_temperature"]).unwrap_err();
    assert!(whole.fix.contains("wire integral(friction_power)"), "{whole}");
}

#[test]
fn what_cannot_be_is_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let path = fmu(folder.path(), "car.fmu", VEHICLE);
    refused(
        &path,
        &["--wire", "P -> load", "--describe"],
        "not a variable of the FMU; its inputs and outputs are: Q, xi, Fx",
    );
    refused(&path, &[], "nothing to do");
    let none = folder.path().join("none.fmu");
    refused(&none, &["--describe"], "none.fmu");
    std::fs::write(&none, "no archive").unwrap();
    refused(&none, &["--describe"], "none.fmu");
    let other = fmu(folder.path(), "a.fmu", "<a/>");
    refused(&other, &["--describe"], "a.fmu: modelDescription.xml is not a model description");
}
