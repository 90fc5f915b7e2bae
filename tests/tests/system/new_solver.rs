//! `coordinator new-solver`: the generated solvers build, conform, and give the same results in
//! every language.

use crate::harness::python::interpreter;
use crate::harness::{Place, case, example, flat, library, programs, root};
use std::path::Path;
use std::process::Command;

/// Generates a solver in a folder; returns the exit code and the output.
fn write(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let mut coordinator = Command::new(programs().join("coordinator"));
    let ended = coordinator.arg("new-solver").args(arguments).current_dir(folder).output().unwrap();
    let said = [ended.stdout, ended.stderr].concat();
    (ended.status.code(), String::from_utf8(said).unwrap())
}

/// Asserts that the solver passes the quick conformance checks; returns the temperature of the rail
/// in the main case.
fn conforms(command: &[&str]) -> Vec<f64> {
    let arguments = [&["conform", "--quick", "--role", "thermal", "--"], command].concat();
    // Runs in any folder: the test case is built in.
    let (place, folder) = (Place::new(), tempfile::tempdir().unwrap());
    let mut conform = place.command(&arguments);
    conform.current_dir(folder.path());
    let ended = place.launch(conform).wait();
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stderr, ended.stdout);
    let place = Place::new();
    let command = format!("thermal.command={command:?}");
    let sets = ["--set", "thermal.model=short", "--set", &command, "--set", "output.fields=all"];
    let summary = place.summary(&case("wheel-rail.toml"), &sets);
    let rail = place.field("thermal_passage_000000.vti", "rail_temperature");
    // The figure is the largest value of the field, and is printed on a line of the terminal.
    let largest = rail.iter().copied().fold(0.0, f64::max);
    let figure = summary["temperature"]["rail"]["max_rise_k"].as_f64().unwrap();
    assert!((figure / largest - 1.0).abs() < 1e-12, "{figure} K, {largest} K: digits of a text");
    rail
}

/// Generates and builds a solver; returns the program.
fn made(folder: &Path, name: &str, language: &str) -> String {
    let (code, said) = write(folder, &[name, "--lang", language]);
    assert_eq!(code, Some(0), "{said}");
    let library = format!("LIBRARY={}", library().display());
    let made = Command::new("make").arg(library).current_dir(folder.join(name)).output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    folder.join(name).join(name.replace('-', "_")).display().to_string()
}

fn assert_alike(a: &[f64], b: &[f64]) {
    let peak = a.iter().copied().fold(0.0, f64::max);
    let off = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(a.len() == b.len() && peak > 200.0, "{peak} K");
    assert!(off < 1e-12 * peak, "sums in another order: {off:e} K");
}

#[test]
fn in_every_language_they_conform_and_are_alike() {
    let folder = tempfile::tempdir().unwrap();
    let (code, said) = write(folder.path(), &["my_strips", "--lang", "python"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(
        said.contains(
            "coordinator conform --quick --role thermal -- python3 my_strips/my_strips.py"
        ),
        "{said}"
    );
    let script = folder.path().join("my_strips/my_strips.py").display().to_string();
    let source = std::fs::read_to_string(&script).unwrap();
    assert!(source.contains("class MyStrips(Solver)") && source.contains("name = \"my-strips\""));
    let python = conforms(&[&interpreter().display().to_string(), &script]);

    assert_alike(&python, &conforms(&[&made(folder.path(), "in-c", "c")]));
    assert_alike(&python, &conforms(&[&made(folder.path(), "in_fortran", "fortran")]));

    // The generated Rust solver equals this example; the nightly test compiles it in a folder of
    // its own.
    let (code, said) = write(folder.path(), &["in_rust", "--lang", "rust"]);
    assert_eq!(code, Some(0), "{said}");
    let shipped = std::fs::read_to_string(root().join("proto/examples/short_columns.rs")).unwrap();
    let written = std::fs::read_to_string(folder.path().join("in_rust/src/main.rs")).unwrap();
    assert_eq!(
        written,
        shipped.replace("ShortColumns", "InRust").replace("short-columns", "in-rust")
    );
    let rust = conforms(&[&example("short_columns").display().to_string()]);
    assert_alike(&python, &rust);
}

/// A locked wheel has no steady temperature by conduction normal to the surface: the generated
/// solver refuses it. A solver that neither reads nor receives the speeds computes a rolling wheel,
/// which gives a warning.
#[test]
fn a_locked_wheel_is_refused_or_told() {
    let folder = tempfile::tempdir().unwrap();
    let (code, said) = write(folder.path(), &["mine", "--lang", "python"]);
    assert_eq!(code, Some(0), "{said}");
    let script = folder.path().join("mine/mine.py");
    let python = interpreter().display().to_string();
    let (place, file) = (Place::new(), case("wheel-rail.toml"));
    let start = |verb: &str, more: &[&str]| {
        let program = format!("thermal.command=[{python:?}, {:?}]", script.display().to_string());
        let sets = ["--set", "thermal.model=short", "--set", &program, "--set"];
        let locked = ["bodies.wheel.surface_speed=0", "--unset", "motion.traction_coefficient"];
        let model = ["--set", "mech.model=hertz-carter"];
        place.start(&[&[verb, &file][..], &sets, &locked, &model, more].concat()).wait()
    };
    let out = place.out().display().to_string();
    let refused = start("run", &["--out", &out]);
    assert_ne!(refused.code, Some(0), "{}", refused.stdout);
    assert!(refused.stderr.contains("`surface_speed` > 0"), "{}", refused.stderr);

    let source = std::fs::read_to_string(&script).unwrap();
    let deaf = source
        .replace(", \"surface_speed\")", ",)")
        .replace("inputs.finite(\"surface_speed\").ravel()", "(5.0, 5.0)");
    assert_ne!(deaf, source);
    std::fs::write(&script, deaf).unwrap();
    let told = start("check", &[]);
    let words = "bodies.wheel.surface_speed: has no effect in thermal, which neither reads it nor \
                 receives the field `surface_speed`";
    assert!(told.code == Some(0) && flat(&told.stdout).contains(words), "{}", told.stdout);
}

#[test]
fn nothing_that_is_there_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("mine")).unwrap();
    let (code, said) = write(folder.path(), &["mine", "--lang", "python"]);
    assert!(code == Some(2) && said.contains("mine is there already"), "{said}");
    let (code, said) = write(folder.path(), &["../mine", "--lang", "python"]);
    assert!(code == Some(2) && said.contains("begins with a letter"), "{said}");
    let (code, said) = write(folder.path(), &["other", "--lang", "rust", "--sources", "nowhere"]);
    assert!(code == Some(2) && said.contains("name their folder by --sources"), "{said}");
    assert!(!folder.path().join("other").exists());
}
