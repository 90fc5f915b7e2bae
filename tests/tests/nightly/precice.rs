//! Stock finite-element program as a participant: Nutils from PyPI, through pyprecice, which pip
//! compiles against this project's headers.

use std::path::{Path, PathBuf};
use std::process::Command;
use tests::harness::{Ended, Place, number, programs, root};

/// Python environment with the packages of the case. It needs a C++ compiler and pkg-config.
struct Environment(tempfile::TempDir);

impl Environment {
    fn new() -> Self {
        let new = Self(tempfile::tempdir().unwrap());
        done(Command::new("python3").args(["-m", "venv"]).arg(new.at("venv")));
        let template = root().join("bridges/precice/libprecice.pc.in");
        let headers = root().join("bridges/precice/include").display().to_string();
        let text = std::fs::read_to_string(template).unwrap();
        let text = text
            .replace("@includedir@", &headers)
            .replace("@libdir@", &programs().display().to_string());
        std::fs::write(new.at("libprecice.pc"), text).unwrap();
        let packages = ["nutils==9.2", "scipy==1.17.1", "mpich==5.0.2", "pyprecice==3.4.0"];
        done(
            Command::new(new.at("venv/bin/pip"))
                .args(["--quiet", "--disable-pip-version-check", "install", "--no-cache-dir"])
                .args(packages)
                .env("PKG_CONFIG_PATH", new.0.path()),
        );
        new
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Runs the coordinator with this environment's Python, in the root of the project.
    fn run(&self, place: &Place, arguments: &[&str]) -> Ended {
        let search = std::env::var("PATH").unwrap();
        let search = format!("{}:{search}", self.at("venv/bin").display());
        let mut command = place.command(arguments);
        command.env("PATH", search);
        place.launch(command).wait()
    }
}

fn done(command: &mut Command) {
    let ended = command.output().unwrap();
    assert!(ended.status.success(), "{command:?}: {}", String::from_utf8_lossy(&ended.stderr));
}

const CASE: &str = "cases/precice/wheel-rail.toml";

/// Command of the rail in the case.
const RAIL: &str = "precice-participant cases/precice/precice-config.xml --participant Rail \
    --origin -6.5e-3,0,0 --velocity -38.889,0,0 --wire \"Heat-Rail <- 0.5 * friction_power\" \
    --wire \"Rise-Rail -> lower_temperature\" -- python3 cases/precice/solid.py Rail \
    cases/precice/precice-config.xml 33e-3 1e-3 20e-3 165 32";

/// Returns the longitudinal force at the end of the run [N], and the number of iterations.
fn result(place: &Place, ended: &Ended) -> (f64, u64) {
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let summary = place.read_summary();
    let iterations = summary["coupling"]["iterations"].as_u64().unwrap();
    (number(&summary, "/contact/creep_force_x_n"), iterations)
}

/// Case with another number of layers below the surface.
fn with_layers(folder: &Path, layers: &str) -> String {
    let text = std::fs::read_to_string(root().join(CASE)).unwrap();
    let path = folder.join("case.toml");
    std::fs::write(&path, text.replace("\"165\", \"32\"]", &format!("\"165\", \"{layers}\"]")))
        .unwrap();
    path.display().to_string()
}

/// The error of the layers is of second order, and the force without it is that of `columns`.
/// Recorded, each side computes its bits again without the other.
#[test]
fn nutils_heats_wheel_and_rail_as_columns_do() {
    let environment = Environment::new();
    let [fine, coarse, columns] = [Place::new(), Place::new(), Place::new()];
    let run = |place: &Place, case: &str, more: &[&str]| {
        let out = place.out().display().to_string();
        let arguments = [&["run", case, "--out", out.as_str()], more].concat();
        result(place, &environment.run(place, &arguments))
    };
    let (force, iterations) = run(&fine, CASE, &["--record"]);
    assert!(iterations <= 700, "{iterations}");
    let other = with_layers(environment.0.path(), "16");
    let (less_accurate, _) = run(&coarse, &other, &[]);
    let unset = ["--unset", "rail", "--unset", "wheel", "--set", "thermal.model=columns"];
    let more = [&unset[..], &["--set", "effects.friction_heat.partition=equal"]].concat();
    let (reference, _) = run(&columns, CASE, &more);
    println!("{less_accurate:.1} N, {force:.1} N, {reference:.1} N; {iterations} iterations");
    let ratio = (less_accurate - reference) / (force - reference);
    assert!((3.0..5.0).contains(&ratio), "second order: {ratio}");
    let without_error = force - (less_accurate - force) / 3.0;
    // Tolerance: the error along the surface and in time, which does not depend on the layers.
    assert!((without_error / reference - 1.0).abs() < 2e-4, "{without_error} {reference}");

    let recording = fine.out().join("recording.mcap").display().to_string();
    let solvers = [&["rail", "--command", RAIL][..], &["mech"]];
    for solver in solvers {
        let arguments = [&["replay", recording.as_str(), "--only"], solver].concat();
        let ended = environment.run(&fine, &arguments);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert!(ended.stdout.contains("bit-identical"), "{}", ended.stdout);
    }
}
