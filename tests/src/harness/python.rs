//! Python interpreters for tests.

use super::root;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Interpreter with the package `cosim` and NumPy.
///
/// # Panics
/// Panics if the environment cannot be set up.
pub fn interpreter() -> &'static Path {
    static PYTHON: OnceLock<PathBuf> = OnceLock::new();
    PYTHON.get_or_init(|| environment(&[]))
}

/// Interpreter with the packages of all tests, for the target `external`.
///
/// # Panics
/// Panics if the environment cannot be set up.
pub fn interpreter_with_packages() -> &'static Path {
    static PYTHON: OnceLock<PathBuf> = OnceLock::new();
    PYTHON.get_or_init(|| environment(&["--test"]))
}

/// Makes the environment by `proto/python/environment.py`.
fn environment(options: &[&str]) -> PathBuf {
    let script = root().join("proto/python/environment.py");
    let made = Command::new("python3")
        .arg(script)
        .args(options)
        .output()
        .expect("Python 3.11 is installed as python3");
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    PathBuf::from(String::from_utf8(made.stdout).unwrap().trim_end())
}
