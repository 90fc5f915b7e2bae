//! Participants in C: the header and the library of `proto/c`, compiled and run as by a user.

use crate::harness::compiled::Compiled;
use crate::harness::{Place, case, field_files, number, root};
use rustix::process::Signal;
use std::process::Command;

/// Arguments with these settings and a C program for a role.
fn with<'a>(settings: &[&'a str], command: &'a [String; 2]) -> Vec<&'a str> {
    let settings = settings.iter().flat_map(|set| ["--set", set]);
    settings.chain(command.iter().map(String::as_str)).collect()
}

fn largest_work(place: &Place) -> f64 {
    place.table("iterations.csv").numbers("thermal_work").into_iter().fold(0.0, f64::max)
}

/// Runs a case twice, with our solver and with the closed form in C, and asserts equal results.
fn assert_same_answer(program: &Compiled, settings: &[&str]) {
    let settings = [&["thermal.model=ertz-knothe", "output.fields=all"], settings].concat();
    let command = program.command("thermal", None);
    let (ours, theirs) = (Place::new(), Place::new());
    let own: Vec<&str> = settings.iter().flat_map(|set| ["--set", set]).collect();
    let expected = ours.summary(&case("wheel-rail.toml"), &own);
    let found = theirs.summary(&case("wheel-rail.toml"), &with(&settings, &command));
    for body in ["rail", "wheel"] {
        let pointer = |key: &str| format!("/temperature/{body}/{key}");
        let peak = number(&expected, &pointer("max_rise_k"));
        let off = (number(&found, &pointer("max_rise_k")) / peak - 1.0).abs();
        assert!(off < 1e-13, "rounding of the moments' sums: {off:e}");
        // Our solver finds the position of the maximum to the square root of the rounding error,
        // relative to the semi-axis.
        let off = number(&found, &pointer("x_m")) - number(&expected, &pointer("x_m"));
        assert!(off.abs() < 1e-7 * number(&expected, "/contact/semi_axis_a_m"), "{off:e}");
        assert_eq!(number(&found, &pointer("y_m")), number(&expected, &pointer("y_m")));
        let name = format!("{body}_temperature");
        let [a, b] = [&ours, &theirs].map(|place| place.field("thermal_contact_000000.vti", &name));
        assert_eq!(a.len(), b.len());
        let off = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / peak;
        // Our solver integrates the tail behind a short row, to 1e-12 of F; the rest is rounding.
        assert!(off < 1e-12 && off.is_finite(), "{settings:?} {name}: {off:e}");
    }
    assert!(number(&found, "/coupling/energy_imbalance") <= 1e-12);
    assert_eq!(largest_work(&theirs), largest_work(&ours));
}

#[test]
fn the_closed_form_in_c_answers_like_ours() {
    let program = Compiled::from("proto/c/examples/closed_form.c");
    assert_same_answer(&program, &[]);
    assert_same_answer(&program, &["mech.model=hertz-carter", "mech.resolution=17"]);
    assert_same_answer(&program, &["effects.friction_heat.partition=effusivity"]);
}

#[test]
fn the_closed_form_refuses_what_it_cannot() {
    let program = Compiled::from("proto/c/examples/closed_form.c");
    let command = program.command("thermal", None);
    let settings = ["thermal.model=ertz-knothe", "materials.steel.conductivity=-1"];
    let ended = Place::new().run(&case("wheel-rail.toml"), &with(&settings, &command));
    assert_eq!(ended.code, Some(2));
    assert!(ended.stderr.contains("materials.steel.conductivity"), "{}", ended.stderr);
    // Started directly, without a run.
    let ended = Command::new(program.path()).output().unwrap();
    assert_eq!(ended.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&ended.stderr).starts_with("error: "));
}

const TOY: &str = "proto/c/tests/toy.c";

/// Each kind of failure ends with the right exit code and the message of the program.
#[test]
fn failures_say_who_when_and_why() {
    let program = Compiled::from(TOY);
    let command = program.command("right", None);
    for (fault, code, parts) in [
        ("refuse", 2, ["right.fault", "is a word too many"]),
        ("missing", 2, ["right.depth", "missing"]),
        ("configure", 1, ["while being configured", "told to fail"]),
        ("build", 1, ["while building its model", "told to fail"]),
        ("solve", 1, ["in window 3, iteration 1", "told to fail"]),
        ("silent", 1, ["in window 3, iteration 1", "`solve` returned 5 without a reason"]),
        ("unwritten", 1, ["in window 3, iteration 1", "output `right_value` was not written"]),
        ("misuse", 1, ["in window 3, iteration 1", "cosim_output: `outputs` is NULL"]),
        ("accept", 1, ["its process ended with exit code 1", "told to fail"]),
        ("summary", 1, ["while finishing", "told to fail"]),
    ] {
        let place = Place::new();
        let fault = format!("right.fault={fault}");
        let ended = place.run(&case("exchange.toml"), &with(&["time.end=9", &fault], &command));
        assert_eq!(ended.code, Some(code), "{fault}: {}", ended.stderr);
        for part in parts {
            assert!(ended.stderr.contains(part), "`{part}` is missing in: {}", ended.stderr);
        }
        place.assert_nothing_left();
    }
}

#[test]
fn progress_restarts_the_deadline() {
    let program = Compiled::from(TOY);
    let command = program.command("right", None);
    for (fault, code) in [("long", 0), ("stuck", 1)] {
        let fault = format!("right.fault={fault}");
        let settings = ["time.end=9", "coupling.solve_deadline=1", &fault];
        let ended = Place::new().run(&case("exchange.toml"), &with(&settings, &command));
        assert_eq!(ended.code, Some(code), "{}", ended.stderr);
        let told = ended.stderr.contains("it stopped at 10 of 30 sweeping: no progress for 1.0 s");
        assert_eq!(told, code == 1, "{}", ended.stderr);
    }
}

#[test]
fn a_table_that_cannot_be_is_told() {
    let program = Compiled::from(TOY);
    for (word, part) in [
        ("no-solve", "cosim_solver.solve is NULL"),
        ("old", "cosim_solver has version 0"),
        ("bad-json", "the text of `describe`"),
    ] {
        let place = Place::new();
        let command = program.command("right", Some(word));
        let ended = place.run(&case("exchange.toml"), &with(&[], &command));
        assert_eq!(ended.code, Some(1), "{word}: {}", ended.stderr);
        assert!(ended.stderr.contains(part), "{}", ended.stderr);
        assert!(ended.stderr.contains("right (solver) failed"), "{}", ended.stderr);
    }
}

#[test]
fn a_killed_run_continues_bit_identically() {
    let program = Compiled::from(TOY);
    let command = program.command("right", None);
    let settings = [
        "time.end=400",
        "left.delay=1 ms",
        "output.fields=all",
        "output.every=20",
        "output.checkpoint_every=10",
    ];
    let settings = with(&settings, &command);
    let undisturbed = Place::new();
    undisturbed.summary(&case("exchange.toml"), &settings);
    // On a fast machine the run may end before it is killed.
    let killed = (0..20).map(|_| Place::new()).find(|place| {
        let running = place.start_run(&case("exchange.toml"), &settings);
        place.wait_for_log("checkpoint written");
        running.signal(Signal::KILL);
        running.wait().code.is_none()
    });
    let place = killed.expect("killed in time");
    place.assert_nothing_left();
    let resumed = place.start(&["run", "--resume", &place.out().display().to_string()]).wait();
    assert_eq!(resumed.code, Some(0), "{}", resumed.stderr);
    assert!(place.read_summary()["cost"]["resumed_at_window"].as_u64() >= Some(10));
    let [expected, found] =
        [&undisturbed, &place].map(|place| place.read_summary()["right"].clone());
    assert_eq!(found, expected);
    assert!(field_files(&place.out()) == field_files(&undisturbed.out()), "a field file differs");
    assert!(number(&found, "/sum").is_finite() && number(&found, "/sum") != 0.0);
}

/// C++ programs can include the same header. Skipped if there is no C++ compiler.
#[test]
fn the_header_is_also_cpp() {
    if Command::new("c++").arg("--version").output().is_err() {
        println!("there is no C++ compiler");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("header.cpp");
    let text = "#include \"cosim.h\"\n\
                static const char *const text = COSIM_JSON({\"name\": \"x\", \"list\": [1, 2]});\n\
                int main(int argc, char **argv) {\n\
                    cosim_solver solver = {};\n\
                    solver.size = sizeof solver;\n\
                    solver.version = COSIM_VERSION;\n\
                    solver.describe = [](void *) { return text; };\n\
                    return cosim_main(argc, argv, &solver, nullptr);\n\
                }\n";
    std::fs::write(&source, text).unwrap();
    let mut check = Command::new("c++");
    check.args(["-std=c++17", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-Iproto/c/include"]);
    let checked = check.arg(&source).current_dir(root()).output().unwrap();
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stderr));
}
