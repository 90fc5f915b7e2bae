//! The executable rejects invalid arguments and keys before it sends anything.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs::Permissions;
use std::os::unix::fs::PermissionsExt;
use std::process::{Command, Output};

fn relay(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cosim-relay"))
        .args(arguments)
        .env_remove("RUST_LOG")
        .output()
        .unwrap()
}

fn refused(arguments: &[&str], words: &str) {
    let output = relay(arguments);
    assert!(!output.status.success(), "{arguments:?}");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains(words), "{arguments:?}: {said}");
}

/// Options with which the coordinator starts a client.
const JOIN: [&str; 4] = ["--join", "folder", "--role", "left"];

#[test]
fn a_key_is_made_once_and_read_by_its_owner_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("key");
    let key = path.to_str().unwrap();
    assert!(relay(&["--new-key", key]).status.success());
    assert_eq!(path.metadata().unwrap().permissions().mode() & 0o777, 0o600);
    refused(&["--new-key", key], "exists");
    std::fs::set_permissions(&path, Permissions::from_mode(0o644)).unwrap();
    for mode in [["--connect", "127.0.0.1:1"], ["--listen", "127.0.0.1:0"]] {
        let more: &[&str] = if mode[0] == "--listen" { &["--", "true"] } else { &JOIN };
        let arguments = [&mode[..], &["--key", key], more].concat();
        refused(&arguments, "can be read by others (mode 644); make it yours alone: chmod 600");
    }
}

#[test]
fn what_cannot_be_is_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("key");
    let key = path.to_str().unwrap();
    refused(&["--connect", "127.0.0.1:1", "--join", "folder", "--role", "left"], "--key");
    refused(
        &["--connect", "127.0.0.1:1", "--key", key, "--join", "folder", "--role", "left"],
        "the key file",
    );
    assert!(relay(&["--new-key", key]).status.success());
    refused(&["--connect", "127.0.0.1:1", "--key", key], "nothing to do");
    refused(&["--listen", "127.0.0.1:0", "--key", key, "--", "./none"], "./none");
    refused(&["--listen", "127.0.0.1:0", "--key", key, "--", "true"], "ended with exit code 0");
    for address in ["tcp/127.0.0.1:1", "127.0.0.1", ":7447", "127.0.0.1:x"] {
        refused(
            &["--connect", address, "--key", key, "--join", "folder", "--role", "left"],
            "write HOST:PORT",
        );
    }
    refused(&["--listen", "192.0.2.1:1", "--key", key, "--", "./none"], "./none");
}
