//! Licences, bans and sources of all dependencies, checked by cargo-deny.

use std::process::Command;
use tests::harness::root;

/// Runs a cargo command, and installs it if missing.
pub(crate) fn cargo_tool(name: &str, arguments: &[&str]) -> std::process::Output {
    let cargo = || {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.current_dir(root());
        cargo
    };
    let there = cargo().args([name, "--version"]).output().unwrap().status.success();
    if !there {
        let made =
            cargo().args(["install", "--locked", &format!("cargo-{name}")]).status().unwrap();
        assert!(made.success(), "cargo-{name} is not installed, and cannot be");
    }
    cargo().arg(name).args(arguments).output().unwrap()
}

/// The rules are in deny.toml.
#[test]
fn everything_that_we_depend_on_is_allowed() {
    let ended = cargo_tool("deny", &["check", "licenses", "bans", "sources"]);
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
}
