//! Programs with preCICE's interface as participants: the programs of `bridges/precice/tests`,
//! compiled as a user compiles them, with the library in place of preCICE's.

use crate::harness::precice::Pair;
use crate::harness::{Ended, Place, root};
use crate::resume::killed_and_resumed;
use std::f64::consts::PI;
use std::fs;

const HALF_A_SECOND: &str = "[time]\nmode = \"transient\"\nwindow = 0.05\nend = 0.5\n\
    [coupling]\nscheme = \"parallel-implicit\"\nrelative = 1e-10\ninterpolation = \"linear\"\n";

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
