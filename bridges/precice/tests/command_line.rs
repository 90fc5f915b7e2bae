//! The executable describes a program from its configuration, without starting it, and refuses
//! commands that do not fit.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use serde_json::Value;
use std::process::{Command, Output};

const CONFIGURATION: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/programs/rod.xml");

fn ask(arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_precice-participant");
    Command::new(program).args(arguments).env_remove("RUST_LOG").output().unwrap()
}

fn description(wires: &[&str]) -> Value {
    let wires = wires.iter().flat_map(|wire| ["--wire", wire]);
    let arguments = [CONFIGURATION, "--participant", "Neumann"].into_iter().chain(wires);
    // A program may have arguments that look like those of the contract.
    let program = ["--", "no-such-program", "--join", "--describe"];
    let answer = ask(&arguments.chain(program).chain(["--describe"]).collect::<Vec<_>>());
    assert!(answer.status.success(), "{}", String::from_utf8_lossy(&answer.stderr));
    serde_json::from_slice(&answer.stdout).unwrap()
}

fn refusal(arguments: &[&str]) -> String {
    let program = ["--", "no-such-program", "--describe"];
    let answer = ask(&[arguments, &program].concat());
    assert!(!answer.status.success());
    String::from_utf8(answer.stderr).unwrap()
}

#[test]
fn data_without_a_wire_are_fields_of_the_same_name() {
    let description = description(&[]);
    assert_eq!(description["role"], "neumann");
    let model = &description["models"][0];
    assert_eq!(model["consumes"], serde_json::json!(["Heat-Flux"]));
    assert_eq!(model["provides"], serde_json::json!(["Temperature"]));
    assert_eq!(description["fields"][0]["mapping"], "consistent");
}

#[test]
fn wires_name_the_fields() {
    let wires = ["Heat-Flux <- 0.5 * friction_power", "Temperature - 293.15 -> lower_temperature"];
    let description = description(&wires);
    let model = &description["models"][0];
    assert_eq!(model["consumes"], serde_json::json!(["friction_power"]));
    assert_eq!(model["provides"], serde_json::json!(["lower_temperature"]));
    assert_eq!(description["fields"], serde_json::json!([]));
}

#[test]
fn commands_that_do_not_fit_are_refused() {
    let unknown = refusal(&[CONFIGURATION, "--participant", "Robin"]);
    assert!(unknown.contains("no participant `Robin`; it has: Dirichlet, Neumann"), "{unknown}");
    let wired = |wire: &str| refusal(&[CONFIGURATION, "--participant", "Neumann", "--wire", wire]);
    let read = wired("Temperature <- friction_power");
    assert!(read.contains("`Neumann` does not read; these are: Heat-Flux"), "{read}");
    let vector = wired("Temperature -> traction");
    assert!(vector.contains("1 components, and the field `traction` has 2"), "{vector}");
    let unit = wired("Temperature -> lower_temperature [degC]");
    assert!(unit.contains("is in K, not in degC"), "{unit}");
    let twice = [CONFIGURATION, "--participant", "Neumann", "--wire", "Temperature -> a"];
    let twice = refusal(&[&twice[..], &["--wire", "Temperature -> b"]].concat());
    assert!(twice.contains("data `Temperature` has two wires"), "{twice}");
    let malformed = wired("Temperature = lower_temperature");
    assert!(malformed.contains("has no arrow"), "{malformed}");
    let own = [CONFIGURATION, "--participant", "Neumann", "--", "PROGRAM-OF-Neumann", "--describe"];
    let imported = String::from_utf8(ask(&own).stderr).unwrap();
    assert!(imported.contains("write the program of Neumann in its place"), "{imported}");
    let absent = refusal(&["no-such.xml", "--participant", "Neumann"]);
    assert!(absent.contains("no-such.xml"), "{absent}");
}
