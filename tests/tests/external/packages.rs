//! Packages from the Python index: pytest, SciPy and SALib, FMPy, scikit-fem, MPI, notebooks.

use std::path::PathBuf;
use std::process::Command;
use tests::harness::python::interpreter_with_packages;
use tests::harness::{Place, case, completed as run, number, programs, root, sets, toy};

const IMBALANCE: &str = "/coupling/energy_imbalance";

/// Runs a file of `proto/python/tests` that needs the executables. Nothing is left in its runtime
/// folder.
fn passes(file: &str) {
    let runtime = tempfile::Builder::new().prefix("ct-").tempdir_in("/dev/shm").unwrap();
    let ended = Command::new(interpreter_with_packages())
        .args(["-m", "pytest", "-p", "no:cacheprovider"])
        .arg(root().join("proto/python/tests").join(file))
        .env("COSIM_COORDINATOR", programs().join("coordinator"))
        .env("COSIM_RUNTIME_DIR", runtime.path())
        .current_dir(root())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&ended.stdout);
    assert!(ended.status.success(), "{said}{}", String::from_utf8_lossy(&ended.stderr));
    assert_eq!(std::fs::read_dir(runtime.path()).unwrap().count(), 0, "{file} leaves folders");
    println!("{said}");
}

#[test]
fn an_fmu_gives_what_it_gives_in_fmpy() {
    passes("fmu_in.py");
}

#[test]
fn a_case_is_an_fmu() {
    passes("fmu_out.py");
}

#[test]
fn a_surrogate_is_an_fmu() {
    passes("fmu_surrogate.py");
}

/// Cases run from Python.
#[test]
fn cases_are_run_from_python() {
    passes("front_door.py");
}

/// `cosim.Model`, and the scripts that use it with SciPy and SALib.
#[test]
fn cases_are_functions_of_arrays_in_python() {
    passes("model_runs.py");
}

/// Notebooks of the how-to pages on `cosim.Model`, with small samples.
#[test]
fn notebooks_of_the_how_to_pages_run() {
    passes("model_notebooks.py");
}

/// Trilinear bricks of scikit-fem converge with second order from below: errors of 4.2 % with 14
/// elements along the flux and 6 layers, 1.2 % with twice as many. Our solver counts as exact here.
#[test]
fn finite_elements_of_a_library_come_closer_by_the_second_order() {
    let program = "proto/python/examples/finite_elements.py";
    let command = format!(
        "thermal.command=[{:?}, {program:?}]",
        interpreter_with_packages().display().to_string()
    );
    let (_, ours) = run("wheel-rail.toml", &["thermal.model=moving-source"]);
    let of = |elements: u32, layers: u32| {
        let mesh = [("resolution", elements), ("layers", layers)];
        let mesh = mesh.map(|(key, value)| format!("thermal.{key}={value}"));
        let (_, found) =
            run("wheel-rail.toml", &["thermal.model=bricks", &command, &mesh[0], &mesh[1]]);
        assert!(number(&found, IMBALANCE) <= 1e-12);
        ["rail", "wheel"].map(|body| {
            let rise = format!("/temperature/{body}/max_rise_k");
            1.0 - number(&found, &rise) / number(&ours, &rise)
        })
    };
    let (coarse, fine) = (of(14, 6), of(28, 12));
    for (coarse, fine) in coarse.into_iter().zip(fine) {
        let order = (coarse / fine).log2();
        assert!(fine < 0.015 && (1.6..2.4).contains(&order), "{coarse} {fine}");
    }
}

/// Heat that spreads beyond the mesh is rejected while planning.
#[test]
fn finite_elements_of_a_library_refuse_a_body_that_is_too_slow() {
    let program = "proto/python/examples/finite_elements.py";
    let command = format!(
        "thermal.command=[{:?}, {program:?}]",
        interpreter_with_packages().display().to_string()
    );
    let place = Place::new();
    let settings = sets(&["thermal.model=bricks", &command, "motion.speed=1e-3"]);
    let ended = place.run(&case("wheel-rail.toml"), &settings);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("passes too slowly"), "{}", ended.stderr);
}

/// MPI launcher installed with the test dependencies.
fn launcher() -> PathBuf {
    let bin = interpreter_with_packages().parent().unwrap();
    // If `venv` is not available, packages are in a folder.
    let places = [bin.join("mpiexec"), bin.with_file_name("packages").join("bin/mpiexec")];
    places.into_iter().find(|path| path.exists()).expect("mpich is installed with the tests' needs")
}

/// Thermal solver with three ranks.
fn ranks(script: &str) -> String {
    let words = [
        &launcher().display().to_string(),
        "-n",
        "3",
        &interpreter_with_packages().display().to_string(),
        "-m",
        "mpi4py",
        script,
    ];
    format!("thermal.command={words:?}")
}

/// Rank 0 takes part and the others follow: each row is computed as by one process.
#[test]
fn several_ranks_are_one_participant() {
    let program = "proto/python/examples/short_columns.py";
    let one = format!(
        "thermal.command=[{:?}, {program:?}]",
        interpreter_with_packages().display().to_string()
    );
    let settings = ["mech.model=hertz-carter", "mech.resolution=20", "thermal.model=short"];
    let (alone, _) = run("wheel-rail.toml", &[&settings[..], &[&one]].concat());
    let spread = ranks("proto/python/examples/ranks.py");
    let (together, summary) = run("wheel-rail.toml", &[&settings[..], &[&spread]].concat());
    assert!(number(&summary, IMBALANCE) <= 1e-12);
    let read = |place: &Place| place.field("thermal_contact_000000.vti", "rail_temperature");
    let (found, expected) = (read(&together), read(&alone));
    let peak = expected.iter().copied().fold(0.0, f64::max);
    let off = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(found.len() == expected.len() && off < 1e-14 * peak, "{off:e} of {peak} K");
    let work = together.table("iterations.csv").numbers("thermal_work");
    assert_eq!(work[0], 3.0, "all ranks have computed");
}

/// Ranks that do not know of each other all join; the error says what to do.
#[test]
fn ranks_that_all_take_part_are_told_what_to_do() {
    let taken = format!(
        "case $1 in --join) {0} \"$@\" & until [ -e $2/participant-left.lock ]; do sleep 0.01; done; \
         sleep 0.3; esac; exec {0} \"$@\"",
        toy("left").join(" ")
    );
    let command = format!("left.command=[\"sh\", \"-c\", {taken:?}, \"sh\"]");
    let place = Place::new();
    let more = ["--set", &command, "--set", "left.delay=600"];
    let ended = place.run(&case("exchange.toml"), &more);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    for part in ["left (sh) failed", "another process plays the role `left`", "only one joins"] {
        assert!(ended.stderr.contains(part), "`{part}` is missing in: {}", ended.stderr);
    }
    place.assert_nothing_left();
}

/// On a mesh that is generated quickly.
#[test]
fn finite_elements_of_scikit_fem_conform() {
    let program = root().join("proto/python/examples/finite_elements.py");
    let command = [interpreter_with_packages(), &program].map(|path| path.display().to_string());
    let mesh = ["--quick", "--set", "thermal.resolution=8", "--set", "thermal.layers=4"];
    let file = case("wheel-rail.toml");
    let begin = ["conform", "--role", "thermal", "--case", &file];
    let command = ["--", &command[0], &command[1]];
    let place = Place::new();
    let ended = place.start(&[&begin[..], &mesh, &command].concat()).wait();
    assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
    assert!(ended.stdout.contains(" 0 failed"), "{}", ended.stdout);
    place.assert_nothing_left();
}
