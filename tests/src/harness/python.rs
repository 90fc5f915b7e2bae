//! Python interpreter for tests.

use super::root;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Interpreter with the package `cosim` and the test dependencies, set up by
/// `proto/python/environment.py`.
///
/// # Panics
/// Panics if the environment cannot be set up.
pub fn interpreter() -> &'static Path {
    static PYTHON: OnceLock<PathBuf> = OnceLock::new();
    PYTHON.get_or_init(|| {
        let script = root().join("proto/python/environment.py");
        let made = Command::new("python3")
            .arg(script)
            .arg("--test")
            .output()
            .expect("Python 3.11 is installed");
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        PathBuf::from(String::from_utf8(made.stdout).unwrap().trim_end())
    })
}
