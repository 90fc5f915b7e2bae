//! Features of packages: `cargo test --workspace` reuses all packages that `cargo build` builds for
//! the default members.

use std::collections::BTreeSet;
use std::process::Command;
use tests::harness::root;

/// Packages built by cargo, each with its features.
fn packages(of: &[&str]) -> BTreeSet<String> {
    let fixed = ["tree", "--locked", "--offline", "--prefix=none", "--format={p} [{f}]"];
    let ended =
        Command::new(env!("CARGO")).args(fixed).args(of).current_dir(root()).output().unwrap();
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    let lines = String::from_utf8(ended.stdout).unwrap();
    lines.lines().filter(|line| line.ends_with(']')).map(str::to_owned).collect()
}

/// Cargo builds a package once for each set of features. If the default members enabled fewer
/// features than the whole workspace, the second command of the README would rebuild the package
/// and all its dependants.
#[test]
fn the_default_members_ask_for_all_features_that_the_workspace_asks_for() {
    let first = packages(&["--edges=normal,build"]);
    let all = packages(&["--edges=normal,build,dev", "--workspace"]);
    assert!(first.len() > 200 && all.len() > first.len(), "{} and {}", first.len(), all.len());
    let name = |line: &str| line.split(" [").next().unwrap().to_owned();
    let lacking = first.difference(&all).next().map(|lacking| {
        let wanted: Vec<_> = all.iter().filter(|line| name(line) == name(lacking)).collect();
        (lacking, wanted)
    });
    assert!(
        lacking.is_none(),
        "built again: {lacking:?}; add to the features at the end of the dependencies in coordinator/Cargo.toml what it lacks"
    );
}
