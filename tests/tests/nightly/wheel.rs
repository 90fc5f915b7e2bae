//! The Python package with the executables inside, as its users install it.

use std::path::Path;
use std::process::Command;
use tests::harness::{programs, root};

fn done(command: &mut Command) -> String {
    let ended = command.output().unwrap();
    assert!(ended.status.success(), "{command:?}: {}", String::from_utf8_lossy(&ended.stderr));
    String::from_utf8(ended.stdout).unwrap()
}

/// A fresh environment, with no compiler on the path: the wheel alone runs the main case.
#[test]
fn a_wheel_runs_without_rust() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    done(Command::new("python3").args(["-m", "venv"]).arg(at("venv")));
    let pip = || {
        let mut pip = Command::new(at("venv/bin/pip"));
        pip.args(["--quiet", "--disable-pip-version-check"]);
        pip
    };
    done(
        pip()
            .args(["wheel", "--no-deps", "--wheel-dir"])
            .arg(at("dist"))
            .arg(root().join("proto/python"))
            .env("COSIM_EXECUTABLES", programs()),
    );
    let wheel = at("dist").read_dir().unwrap().next().unwrap().unwrap().path();
    println!("{}: {} MB", wheel.display(), wheel.metadata().unwrap().len() >> 20);
    done(pip().arg("install").arg(&wheel));
    let script = "import cosim; print(cosim.run('wheel-rail').temperature.rail.max_rise_k)";
    let said = done(
        Command::new(at("venv/bin/python"))
            .args(["-c", script])
            .current_dir(Path::new("/"))
            .env_clear()
            .env("PATH", "/usr/bin:/bin"),
    );
    let rise: f64 = said.trim().parse().unwrap();
    assert!((rise - 225.9).abs() < 0.1, "{rise}");
}
