//! Programs with preCICE's interface as participants: the programs of `bridges/precice/tests`,
//! compiled as a user compiles them, with the library in place of preCICE's.

use crate::harness::{Ended, Place, number, programs, root};
use crate::resume::killed_and_resumed;
use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// Two programs of one source, in a folder of their own.
struct Pair {
    folder: TempDir,
    /// Participants of the configuration.
    names: [&'static str; 2],
    source: &'static str,
}

impl Pair {
    /// Compiles a program.
    fn new(source: &'static str, names: [&'static str; 2]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let (compiler, standard) = match source.ends_with(".cpp") {
            true => ("c++", "-std=c++17"),
            false => ("cc", "-std=c11"),
        };
        let library = programs().display();
        let built = Command::new(compiler)
            .args([standard, "-O2", "-Wall", "-Wextra", "-Werror", "-Ibridges/precice/include"])
            .arg(format!("bridges/precice/tests/programs/{source}"))
            .args([format!("-L{library}").as_str(), "-lprecice", "-lm", "-o"])
            .arg(folder.path().join("program"))
            .current_dir(root())
            .output()
            .unwrap_or_else(|error| {
                panic!("a compiler is on the search path: {compiler}: {error}")
            });
        assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
        Self { folder, names, source }
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Configuration of both programs.
    fn configuration(&self) -> PathBuf {
        let (name, _) = self.source.split_once('.').unwrap();
        let name = if matches!(name, "hostile" | "linked") { "dummy" } else { name };
        root().join("bridges/precice/tests/programs").join(format!("{name}.xml"))
    }

    /// Command line of a participant, with the arguments of its program after the configuration.
    fn words(&self, side: usize, arguments: &[&str]) -> Vec<String> {
        let launcher = programs().join("precice-participant").display().to_string();
        let configuration = self.configuration().display().to_string();
        let program = self.path().join("program").display().to_string();
        let name = self.names[side].to_owned();
        let own = [launcher, configuration.clone(), "--participant".to_owned(), name.clone()];
        let role = ["--role", ["first", "second"][side], "--resume-by-repeating"];
        let directory = ["--directory".to_owned(), self.path().display().to_string()];
        let own = own.into_iter().chain(role.map(str::to_owned)).chain(directory);
        let started = ["--".to_owned(), program, name, configuration];
        let arguments = arguments.iter().map(|word| (*word).to_owned());
        own.chain(started).chain(arguments).collect()
    }

    /// Writes a case of both programs, with the sections of its own.
    fn case(&self, arguments: [&[&str]; 2], sections: &str) -> String {
        let [first, second] = [0, 1].map(|side| self.words(side, arguments[side]));
        let text = format!(
            "[case]\nname = \"pair\"\n[first]\nmodel = \"program\"\ncommand = {first:?}\n\
             [second]\nmodel = \"program\"\ncommand = {second:?}\n{sections}"
        );
        let path = self.path().join("case.toml");
        fs::write(&path, text).unwrap();
        path.display().to_string()
    }

    /// Returns rows of numbers that a program has written.
    fn rows(&self, file: &str) -> Vec<Vec<f64>> {
        let text = fs::read_to_string(self.path().join(file)).unwrap();
        let row = |line: &str| line.split(',').map(|word| word.parse().unwrap()).collect();
        text.lines().skip(1).map(row).collect()
    }
}

const HALF_A_SECOND: &str = "[time]\nmode = \"transient\"\nwindow = 0.05\nend = 0.5\n\
    [coupling]\nscheme = \"parallel-implicit\"\nrelative = 1e-10\ninterpolation = \"linear\"\n";

const A_SECOND_OF_HEAT: &str = "[time]\nmode = \"transient\"\nwindow = 0.1\nend = 1.0\n\
    [coupling]\nscheme = \"serial-implicit\"\nrelative = 1e-10\ninterpolation = \"linear\"\n";

/// Runs the two masses with a number of substeps; returns the rows of both programs.
fn oscillate(substeps: [&str; 2], more: &[&str]) -> (Place, Pair, [Vec<Vec<f64>>; 2]) {
    let pair = Pair::new("oscillator.c", ["Left", "Right"]);
    let [left, right] = substeps;
    let case = pair.case([&["left.csv", left], &["right.csv", right]], HALF_A_SECOND);
    let place = Place::new();
    place.summary(&case, more);
    let rows = ["left.csv", "right.csv"].map(|file| pair.rows(file));
    (place, pair, rows)
}

/// Displacements of both masses whose time steps h turn the angular frequency w into
/// (2/h) atan(w h/2).
fn displacements(time: f64, step: Option<f64>) -> [f64; 2] {
    let turned = |frequency: f64| {
        step.map_or(frequency, |step| 2.0 / step * (frequency * step / 2.0).atan())
    };
    let [in_phase, opposed] = [2.0 * PI, 4.0 * PI].map(|w| (turned(w) * time).cos() / 2.0);
    [in_phase + opposed, in_phase - opposed]
}

/// The tolerance is that of the coupling, which is relative to the forces.
#[test]
fn two_masses_swing_as_their_coupled_steps_do() {
    let (place, _, sides) = oscillate(["1", "1"], &[]);
    for (side, rows) in sides.iter().enumerate() {
        assert_eq!(rows.len(), 11, "a row a window, and the first");
        for row in rows {
            let expected = displacements(row[0], Some(0.05))[side];
            assert!((row[1] - expected).abs() < 1e-8, "{row:?}, expected {expected}");
        }
    }
    assert_eq!(place.read_summary()["coupling"]["windows"], 10);
    place.assert_nothing_left();
}

/// Programs with steps of their own in a window read forces that are linear in time. The error in
/// the middle of the swing falls with the window, so only its size is checked: interpolation over
/// windows of 0.05 s of a force with the period 0.5 s errs by (0.05 · 4π)²/8 = 0.05 of its
/// amplitude at most.
#[test]
fn programs_step_within_a_window() {
    let (_, _, [left, right]) = oscillate(["4", "3"], &[]);
    for (side, rows) in [left, right].iter().enumerate() {
        assert_eq!(rows.len(), 11);
        let errors = rows.iter().map(|row| (row[1] - displacements(row[0], None)[side]).abs());
        let error = errors.fold(0.0, f64::max);
        assert!(error < 0.05, "side {side}: {error}");
    }
}

#[test]
fn a_recorded_program_is_replayed_alone() {
    let (place, pair, _) = oscillate(["1", "2"], &["--record"]);
    let recording = place.out().join("recording.mcap").display().to_string();
    for (side, role) in ["first", "second"].into_iter().enumerate() {
        let words = pair.words(side, &["replayed.csv", ["1", "2"][side]]).join(" ");
        let replay = ["replay", &recording, "--only", role, "--command", &words];
        let ended = place.start(&replay).wait();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert!(ended.stdout.contains("bit-identical"), "{}", ended.stdout);
        let written = pair.rows(["left.csv", "right.csv"][side]);
        assert_eq!(pair.rows("replayed.csv"), written, "{role} has written another history");
    }
    place.assert_nothing_left();
}

/// The programs are started anew and repeat the accepted windows, with substeps, and with forces at
/// the start that only the first iteration has.
#[test]
fn a_killed_run_is_resumed_by_repeating_its_windows() {
    let pair = Pair::new("oscillator.c", ["Left", "Right"]);
    let case = pair.case([&["left.csv", "2"], &["right.csv", "1"]], HALF_A_SECOND);
    let settings =
        ["time.end=20", "output.checkpoint_every=3", "output.fields=all", "output.every=50"];
    killed_and_resumed(&case, &settings, 100, &mut 5);
}

/// Skipped if there is no C++ compiler.
#[test]
fn a_program_behind_the_bridge_keeps_the_contract() {
    if !has_cpp() {
        return;
    }
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

fn has_cpp() -> bool {
    let found = Command::new("c++").arg("--version").output().is_ok();
    if !found {
        println!("there is no C++ compiler");
    }
    found
}

/// Finite volumes and implicit steps reproduce the solution exactly, so that only the coupling's
/// tolerance is left. Skipped if there is no C++ compiler.
#[test]
fn a_rod_of_two_programs_in_cpp_conducts_exactly() {
    if !has_cpp() {
        return;
    }
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
    if !has_cpp() {
        return;
    }
    let pair = Pair::new("interface.cpp", ["One", "Two"]);
    let library = pair.path().join("libprecice.so.3");
    std::os::unix::fs::symlink(programs().join("libprecice.so"), library).unwrap();
    let mut program = Command::new(pair.path().join("program"));
    let ended = program.env("LD_LIBRARY_PATH", pair.path()).output().unwrap();
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
}

/// The two programs check what they read, so that a wrong value ends the run. Skipped if there is
/// no C++ compiler.
#[test]
fn a_program_linked_with_precice_itself_finds_its_symbols() {
    if !has_cpp() {
        return;
    }
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
    if !has_cpp() {
        return;
    }
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

/// Imports a configuration with a replacement in it; returns the ends of import and check.
fn imported(from: &str, to: &str) -> (Ended, Ended) {
    let dummy = root().join("bridges/precice/tests/programs/dummy.xml");
    let text = fs::read_to_string(dummy).unwrap();
    assert!(text.contains(from), "{from}");
    let folder = tempfile::tempdir().unwrap();
    let [configuration, case] =
        ["dummy.xml", "dummy.toml"].map(|name| folder.path().join(name).display().to_string());
    fs::write(&configuration, text.replace(from, to)).unwrap();
    let place = Place::new();
    let commands = ["--command=One=./one", "--command=Two=./two"];
    let words = [&["import", &configuration, "--out", &case][..], &commands].concat();
    (place.start(&words).wait(), place.start(&["check", &case]).wait())
}

/// The case of an import passes the check, or import names what it refuses and does not succeed.
#[test]
fn import_and_check_agree() {
    for (from, to) in [
        ("Scalar-One", "Scalar  One -&gt; &quot;Two&quot;"),
        ("Scalar-One", "friction_power"),
        ("Scalar-One", "traction"),
        ("<time-window-size value=\"1\"", "<time-window-size method=\"first-participant\""),
    ] {
        let (import, check) = imported(from, to);
        assert_eq!(import.code, Some(0), "{to}: {}{}", import.stdout, import.stderr);
        assert_eq!(check.code, Some(0), "{to}: {}", check.stderr);
    }
    let reads = "<read-data name=\"Scalar-Two\" mesh=\"One-Mesh\"";
    let (import, check) = imported(reads, &reads.replace("One-Mesh", "Two-Mesh"));
    assert_eq!((import.code, check.code), (Some(2), Some(1)), "{}{}", import.stderr, check.stderr);
    let listed = crate::harness::flat(&import.stdout);
    assert!(listed.contains("To do before the first run"), "{listed}");
    assert!(listed.contains("of another participant (direct access), which is not"), "{listed}");
    assert!(
        import.stderr.contains("`coordinator check` refuses it for 1 reason"),
        "{}",
        import.stderr
    );
}

/// Two grids of different size, whose nodes do not match. Linear interpolation of α y² over
/// elements of 1/8 errs by α/4/8² = 0.012; conduction smooths it.
#[test]
fn grids_that_do_not_match_are_mapped() {
    if !has_cpp() {
        return;
    }
    let pair = Pair::new("rod.cpp", ["Dirichlet", "Neumann"]);
    let case = pair.case([&["8", "d.csv"], &["12", "n.csv"]], A_SECOND_OF_HEAT);
    Place::new().summary(&case, &["--set", "mapping.method=nearest-projection"]);
    let errors = ["d.csv", "n.csv"].map(|file| pair.rows(file).last().unwrap()[1]);
    assert!(errors.iter().all(|error| (1e-6..0.012).contains(error)), "{errors:?}");
}

/// Runs a program with a defect beside one without; returns the end of the run.
fn run_with_defect(defect: &str) -> Ended {
    let pair = Pair::new("hostile.c", ["One", "Two"]);
    let sections = "[time]\nmode = \"transient\"\nwindow = 1.0\nend = 3.0\n[coupling]\n\
        scheme = \"parallel-implicit\"\nrelative = 1e-8\n";
    let case = pair.case([&[defect], &["none"]], sections);
    let place = Place::new();
    let ended = place.run(&case, &["--set", "coupling.solve_deadline=5"]);
    place.assert_nothing_left();
    ended
}

fn ends_with(defect: &str, code: i32, told: &str) {
    let ended = run_with_defect(defect);
    assert_eq!(ended.code, Some(code), "{defect}: {}", ended.stderr);
    assert!(ended.stderr.contains(told), "{defect}: {}", ended.stderr);
}

table_of_tests! {
    ends_with:
    a_program_without_defect_ends_well("none", 0, "");
    a_program_that_dies_is_named("abort", 1, "has ended (signal: 6 (SIGABRT)) in this window");
    a_program_that_leaves_is_named("exit", 1, "has ended (exit status: 0) in this window");
    a_program_that_hangs_is_ended("hang", 1, "no answer after 5.0 s");
    a_program_that_finalises_early_is_named("finalize-early", 1, "finalises before the simulation ends");
    advance_before_initialize_is_refused("advance-first", 2, "advance: not allowed before initialize");
    initialize_twice_is_refused("initialize-twice", 1, "initialize: not allowed after initialize");
    a_second_participant_is_refused("create-twice", 2, "a participant exists already");
    a_step_that_is_too_long_is_refused("long-step", 1, "at most getMaxTimeStepSize() = 1 s");
    a_step_that_is_no_number_is_refused("nan-step", 1, "a time step of NaN s");
    reading_beyond_the_window_is_refused("read-late", 1, "a relative time of 2 s");
    data_that_are_not_written_are_named("silent", 1, "`Scalar-One` of mesh `One-Mesh` was not written");
    a_written_nan_is_refused("nan", 1, "writeData: value 1 is NaN");
    a_vertex_of_nan_is_refused("nan-vertex", 2, "setMeshVertices: coordinate 0 is NaN");
    a_mesh_without_vertices_is_refused("no-vertices", 2, "mesh `One-Mesh` has no vertices");
    a_late_vertex_is_refused("late-vertex", 1, "setMeshVertex: not allowed after initialize");
    a_mesh_that_changes_is_refused("reset-mesh", 1, "resetMesh: a mesh that changes during the run");
    a_wrong_vertex_is_refused("wrong-vertex", 1, "vertex 1000 of mesh `One-Mesh` does not exist");
    a_null_pointer_is_refused("null-values", 1, "a pointer is null although 4 values are expected");
    a_name_that_is_null_is_refused("null-name", 2, "a name is null or not UTF-8");
    another_participant_is_refused("unknown-participant", 2, "creates the participant `Three`");
    an_unknown_mesh_is_refused("unknown-mesh", 2, "it provides: One-Mesh");
    data_of_the_partner_are_refused("foreign-data", 1, "`Scalar-Two` is not written on mesh");
    several_ranks_are_refused("ranks", 2, "rank 0 of 2 creates a participant");
}
