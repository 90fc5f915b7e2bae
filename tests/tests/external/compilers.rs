//! Programs in Fortran and C++, and what `make` builds in folders of `coordinator new-solver`.

use std::fs;
use std::path::Path;
use std::process::Command;
use tests::harness::compiled::Compiled;
use tests::harness::precice::Pair;
use tests::harness::python::interpreter;
use tests::harness::{Place, case, example, library, new_solver, number, programs, root};

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
    let (code, said) = new_solver(folder, &[name, "--lang", language]);
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
    let (code, said) = new_solver(folder.path(), &["my_strips", "--lang", "python"]);
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
    let (code, said) = new_solver(folder.path(), &["in_rust", "--lang", "rust"]);
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

/// Fortran example, compiled as by a user.
fn fortran(folder: &std::path::Path) -> String {
    let (lib, program) = (library().display(), folder.join("solver").display().to_string());
    let mut compiler = Command::new("gfortran");
    compiler.args(["-std=f2018", "-O2", "-Wall", "-Wno-unused-dummy-argument", "-Werror"]);
    compiler.arg("-J").arg(folder);
    compiler.args(["proto/c/include/cosim.f90", "proto/c/examples/short_columns.f90"]);
    compiler.args([format!("-L{lib}"), format!("-Wl,-rpath,{lib}"), "-lcosim".to_owned()]);
    let built = compiler.args(["-o", &program]).current_dir(root()).output();
    let built = built
        .expect("gfortran is needed to test participants in Fortran: apt-get install gfortran");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    program
}

#[test]
fn the_solver_in_fortran_conforms_and_answers_like_the_one_in_c() {
    let folder = tempfile::tempdir().unwrap();
    let program = fortran(folder.path());
    let place = Place::new();
    let arguments = ["conform", "--role", "thermal", "--json", "--", &program];
    let ended = place.start(&arguments).wait();
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stderr, ended.stdout);
    place.assert_nothing_left();
    let rail = |program: &str| {
        let (place, command) = (Place::new(), format!("thermal.command={:?}", [program]));
        let sets = ["thermal.model=short", "output.fields=all", &command];
        let sets: Vec<&str> = sets.into_iter().flat_map(|set| ["--set", set]).collect();
        place.summary(&case("wheel-rail.toml"), &sets);
        place.field("thermal_passage_000000.vti", "rail_temperature")
    };
    let c = Compiled::from("proto/c/examples/short_columns.c");
    let (expected, found) = (rail(&c.path()), rail(&program));
    let peak = expected.iter().copied().fold(0.0, f64::max);
    let off = expected.iter().zip(&found).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(expected.len() == found.len() && peak > 200.0, "{peak} K");
    assert!(off < 1e-12 * peak, "sums in another order: {off:e} K");
}

#[test]
fn what_the_solver_in_fortran_refuses_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let program = fortran(folder.path());
    // Started directly, without a run.
    let ended = Command::new(&program).output().unwrap();
    assert_eq!(ended.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&ended.stderr).starts_with("error: "));
    let ended = Command::new(&program).arg("--fly").output().unwrap();
    assert_eq!(ended.status.code(), Some(2), "{}", String::from_utf8_lossy(&ended.stderr));
}

const A_SECOND_OF_HEAT: &str = "[time]\nmode = \"transient\"\nwindow = 0.1\nend = 1.0\n\
    [coupling]\nscheme = \"serial-implicit\"\nrelative = 1e-10\ninterpolation = \"linear\"\n";

/// Finite volumes and implicit steps reproduce the solution exactly, so that only the coupling's
/// tolerance is left.
#[test]
fn a_rod_of_two_programs_in_cpp_conducts_exactly() {
    let pair = Pair::new("rod.cpp", ["Dirichlet", "Neumann"]);
    let case = pair.case([&["12", "d.csv"], &["12", "n.csv"]], A_SECOND_OF_HEAT);
    let place = Place::new();
    let summary = place.summary(&case, &[]);
    assert_eq!(number(&summary, "/coupling/windows"), 10.0);
    for file in ["d.csv", "n.csv"] {
        for row in pair.rows(file) {
            assert!(row[1] < 1e-8, "{file}: {row:?}");
        }
    }
}

/// The program calls every method, so that the compiler checks them. Started by hand, it catches
/// the exception of its constructor.
#[test]
fn the_class_has_every_method_and_throws() {
    let pair = Pair::new("interface.cpp", ["One", "Two"]);
    let library = pair.path().join("libprecice.so.3");
    std::os::unix::fs::symlink(programs().join("libprecice.so"), library).unwrap();
    let mut program = Command::new(pair.path().join("program"));
    let ended = program.env("LD_LIBRARY_PATH", pair.path()).output().unwrap();
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
}

/// The two programs check what they read, so that a wrong value ends the run.
#[test]
fn a_program_linked_with_precice_itself_finds_its_symbols() {
    let pair = Pair::new("linked.cpp", ["One", "Two"]);
    let sections = "[time]\nmode = \"transient\"\nwindow = 1.0\nend = 3.0\n[coupling]\n\
        scheme = \"parallel-explicit\"\n";
    let case = pair.case([&[], &[]], sections);
    let place = Place::new();
    place.summary(&case, &[]);
    let log = fs::read_to_string(place.out().join("log.jsonl")).unwrap();
    assert!(log.contains("One: 3.4.0;cosim;") && log.contains("Two: 3.4.0;cosim;"), "{log}");
}

/// A user's simulation needs its configuration and the programs only.
#[test]
fn an_imported_simulation_runs() {
    let pair = Pair::new("rod.cpp", ["Dirichlet", "Neumann"]);
    let configuration = pair.configuration().display().to_string();
    let case = pair.path().join("rod.toml").display().to_string();
    let folder = pair.path().display();
    let options = pair.names.map(|name| {
        let file = format!("{name}.csv");
        [
            format!("--command={name}={folder}/program {name} {configuration} 10 {file}"),
            format!("--directory={name}={folder}"),
        ]
    });
    let options: Vec<&str> = options.as_flattened().iter().map(String::as_str).collect();
    let place = Place::new();
    let begin = ["import", &configuration, "--out", &case];
    let imported = place.start(&[&begin[..], &options].concat()).wait();
    assert_eq!(imported.code, Some(0), "{}", imported.stderr);
    assert!(imported.stdout.contains("next: coordinator check"), "{}", imported.stdout);
    // `python3` and the solvers are on the search path of a user.
    let launcher = programs().join("precice-participant").display().to_string();
    let text = fs::read_to_string(&case).unwrap();
    assert!(text.contains("\"precice-participant\""), "{text}");
    fs::write(&case, text.replace("precice-participant\"", &(launcher + "\""))).unwrap();
    place.summary(&case, &[]);
    for name in pair.names {
        for row in pair.rows(&format!("{name}.csv")) {
            assert!(row[1] < 1e-7, "{name}: {row:?}");
        }
    }
}

/// Two grids of different size, whose nodes do not match. Linear interpolation of α y² over
/// elements of 1/8 errs by α/4/8² = 0.012; conduction smooths it.
#[test]
fn grids_that_do_not_match_are_mapped() {
    let pair = Pair::new("rod.cpp", ["Dirichlet", "Neumann"]);
    let case = pair.case([&["8", "d.csv"], &["12", "n.csv"]], A_SECOND_OF_HEAT);
    Place::new().summary(&case, &["--set", "mapping.method=nearest-projection"]);
    let errors = ["d.csv", "n.csv"].map(|file| pair.rows(file).last().unwrap()[1]);
    assert!(errors.iter().all(|error| (1e-6..0.012).contains(error)), "{errors:?}");
}

#[test]
fn a_program_behind_the_bridge_keeps_the_contract() {
    let pair = Pair::new("rod.cpp", ["Dirichlet", "Neumann"]);
    let arguments = ["8", "rod.csv"];
    let case = pair.case([&arguments, &arguments], A_SECOND_OF_HEAT);
    let words = pair.words(1, &arguments);
    let command: Vec<&str> = words.iter().map(String::as_str).collect();
    let place = Place::new();
    let begin = ["conform", "--role", "second", "--case", &case, "--"];
    let ended = place.start(&[&begin[..], &command].concat()).wait();
    assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
    assert!(ended.stdout.contains(" 0 failed"), "{}", ended.stdout);
}
