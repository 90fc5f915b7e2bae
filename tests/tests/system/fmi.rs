//! Cases and surrogates as FMUs, in FMPy: `proto/python/tests/fmu_out.py` and `fmu_surrogate.py`,
//! which need the executables.

use crate::harness::python::interpreter;
use crate::harness::{programs, root};
use std::process::Command;

#[test]
fn a_case_is_an_fmu() {
    passes("proto/python/tests/fmu_out.py");
}

#[test]
fn a_surrogate_is_an_fmu() {
    passes("proto/python/tests/fmu_surrogate.py");
}

/// Runs tests in Python, with the executables.
fn passes(tests: &str) {
    let runtime = tempfile::Builder::new().prefix("ct-").tempdir_in("/dev/shm").unwrap();
    let ended = Command::new(interpreter())
        .args(["-m", "pytest", "-p", "no:cacheprovider", tests])
        .env("COSIM_COORDINATOR", programs().join("coordinator"))
        .env("COSIM_RUNTIME_DIR", runtime.path())
        .current_dir(root())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&ended.stdout);
    assert!(ended.status.success(), "{said}{}", String::from_utf8_lossy(&ended.stderr));
    println!("{said}");
}
