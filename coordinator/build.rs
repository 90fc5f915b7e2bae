//! The commit that `-V` says.

use std::env;
use std::path::Path;
use std::process::Command;

/// The commit that is built, where it is one.
fn main() {
    let git = |arguments: &[&str]| {
        let ended = Command::new("git")
            .args(arguments)
            .output()
            .ok()
            .filter(|ended| ended.status.success())?;
        Some(String::from_utf8(ended.stdout).ok()?.trim().to_owned())
    };
    // Sources may lie in a repository of somebody else.
    if !Path::new("../.git").exists() {
        return println!("cargo:rustc-env=COORDINATOR_VERSION={}", env!("CARGO_PKG_VERSION"));
    }
    let commit = git(&["rev-parse", "--short=10", "HEAD"]);
    // Every commit writes a line there.
    if let Some(log) =
        git(&["rev-parse", "--git-path", "logs/HEAD"]).filter(|log| Path::new(log).exists())
    {
        println!("cargo:rerun-if-changed={log}");
    }
    let named = commit.map_or(String::new(), |commit| format!(" ({commit})"));
    println!("cargo:rustc-env=COORDINATOR_VERSION={}{named}", env!("CARGO_PKG_VERSION"));
}
