//! Python package with its executables, installed as by a user.

use std::path::{Path, PathBuf};
use std::process::Command;
use tests::harness::python::interpreter;
use tests::harness::{programs, root};

fn done(command: &mut Command) -> String {
    let ended = command.output().unwrap();
    assert!(ended.status.success(), "{command:?}: {}", String::from_utf8_lossy(&ended.stderr));
    String::from_utf8(ended.stdout).unwrap()
}

/// Collects all shipped files: `cargo test` leaves executables in one folder and the newest library
/// in another.
fn shipped(folder: &Path) {
    std::fs::create_dir(folder).unwrap();
    for name in std::fs::read_to_string(root().join("release/programs")).unwrap().lines() {
        let folders = [programs().join("deps"), programs().to_owned()];
        let built = folders.iter().map(|built| built.join(name)).find(|path| path.is_file());
        let built = built.unwrap_or_else(|| panic!("{name} is not built"));
        std::os::unix::fs::symlink(built, folder.join(name)).unwrap();
    }
}

/// New environment with the wheel installed.
struct Installed(tempfile::TempDir);

impl Installed {
    fn new() -> Self {
        let new = Self(tempfile::tempdir().unwrap());
        done(Command::new("python3").args(["-m", "venv"]).arg(new.at("venv")));
        shipped(&new.at("built"));
        let pip = || {
            let mut pip = Command::new(new.at("venv/bin/pip"));
            pip.args(["--quiet", "--disable-pip-version-check"]);
            pip
        };
        done(
            pip()
                .args(["wheel", "--no-deps", "--wheel-dir"])
                .arg(new.at("dist"))
                .arg(root().join("proto/python"))
                .env("COSIM_EXECUTABLES", new.at("built")),
        );
        let wheel = new.at("dist").read_dir().unwrap().next().unwrap().unwrap().path();
        let size = wheel.metadata().unwrap().len() as f64 / 1e6;
        println!("{}: {size:.1} MB", wheel.display());
        done(pip().arg("install").arg(&wheel));
        new
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Program of the environment, without a compiler or other programs on the path.
    fn program(&self, name: &str) -> Command {
        let mut program = Command::new(self.at("venv/bin").join(name));
        program.current_dir(self.0.path()).env_clear().env("PATH", "/usr/bin:/bin");
        program
    }

    fn python(&self, script: &str) -> String {
        done(self.program("python").args(["-c", script]).current_dir(Path::new("/")))
    }
}

/// The wheel alone runs the main case, and contains everything a release contains.
#[test]
fn a_wheel_runs_without_rust() {
    let wheel = Installed::new();
    let said =
        wheel.python("import cosim; print(cosim.run('wheel-rail').temperature.rail.max_rise_k)");
    let rise: f64 = said.trim().parse().unwrap();
    assert!((rise - 227.55).abs() < 0.1, "{rise}");

    let coordinator = |words: &[&str]| done(wheel.program("coordinator").args(words));
    coordinator(&["new", "mine", "--scene", "wheel-rail"]);
    let said = coordinator(&["run", "mine.toml"]);
    assert!(said.contains("+227.55 K"), "{said}");
    let live = "load.normal_force={at=\"134 kN\",from=\"60 kN\",to=\"140 kN\"}";
    let said = coordinator(&["fmu", "mine.toml", "-o", "contact.fmu", "--set", live]);
    assert!(said.contains("input   load.normal_force [N]"), "{said}");
    coordinator(&["relay", "--new-key", "key"]);
    assert!(wheel.at("key").is_file());

    // FMUs of cases, and FMUs as participants: the tests of both, with the executables of the
    // wheel.
    let inside = wheel.python("import cosim.command; print(cosim.command.executable())");
    let inside = Path::new(inside.trim());
    assert!(inside.starts_with(wheel.0.path()), "{}", inside.display());
    let runtime = tempfile::Builder::new().prefix("ct-").tempdir_in("/dev/shm").unwrap();
    let said = done(
        Command::new(interpreter())
            .args(["-m", "pytest", "-p", "no:cacheprovider"])
            .args(["proto/python/tests/fmu_out.py", "proto/python/tests/fmu_in.py"])
            .env("COSIM_COORDINATOR", inside)
            .env("COSIM_RUNTIME_DIR", runtime.path())
            .current_dir(root()),
    );
    println!("{said}");
}
