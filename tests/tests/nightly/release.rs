//! Release archive and package, unpacked and installed as by a user.

use crate::licences::cargo_tool;
use serde_json::Value;
use std::path::Path;
use std::process::Command;
use tests::harness::root;

fn done(command: &mut Command) -> String {
    let ended = command.output().unwrap();
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert!(ended.status.success(), "{command:?}: {said}");
    String::from_utf8(ended.stdout).unwrap()
}

/// Runs the main case with a coordinator that finds its solvers in its own folder, in an empty
/// environment.
fn runs(bin: &Path) {
    let folder = tempfile::tempdir().unwrap();
    let coordinator = || {
        let mut coordinator = Command::new(bin.join("coordinator"));
        coordinator.current_dir(folder.path()).env_clear().env("PATH", "/usr/bin:/bin");
        coordinator
    };
    done(coordinator().args(["new", "mine", "--scene", "wheel-rail"]));
    let said = done(coordinator().args(["run", "mine.toml"]));
    assert!(said.contains("+227.55 K"), "{said}");
}

/// Archive and package contain the same executables, which run in any folder. A solver in C builds
/// against the archive. Two releases of the same sources give identical archives.
#[test]
fn the_archive_and_the_package_run() {
    cargo_tool("cyclonedx", &["--help"]);
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let build = |into: &str| done(Command::new(root().join("release/build")).arg(at(into)));
    println!("{}", build("dist"));
    let files: Vec<_> = at("dist").read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    let with = |end: &str| files.iter().find(|path| path.to_string_lossy().ends_with(end)).unwrap();
    let (archive, package) = (with(".tar.gz"), with(".deb"));
    done(Command::new("tar").arg("xzf").arg(archive).arg("-C").arg(folder.path()));
    let name = archive.file_name().unwrap().to_str().unwrap().trim_end_matches(".tar.gz");
    let tree = at(name);
    runs(&tree.join("bin"));
    done(Command::new("dpkg-deb").arg("-x").arg(package).arg(at("root")));
    runs(&at("root/usr/bin"));
    let control = done(Command::new("dpkg-deb").arg("-f").arg(package));
    assert!(control.contains("Depends: libc6 (>= 2."), "{control}");

    done(
        Command::new(tree.join("bin/coordinator"))
            .args(["new-solver", "mine", "--lang", "c"])
            .current_dir(folder.path()),
    );
    done(Command::new("make").current_dir(at("mine")));
    let described = done(Command::new(at("mine/mine")).arg("--describe"));
    assert!(described.contains("short"), "{described}");

    // The bill of materials of an executable lists its crates with their licences.
    let list =
        std::fs::read_to_string(tree.join("share/contact-cosim/coordinator.cdx.json")).unwrap();
    let list: Value = serde_json::from_str(&list).unwrap();
    let parts = list["components"].as_array().unwrap();
    let named = |name: &str| parts.iter().find(|part| part["name"] == name);
    let iceoryx2 = named("iceoryx2").expect("shared memory is by iceoryx2");
    assert!(iceoryx2["licenses"].is_array() && parts.len() > 50, "{} parts", parts.len());
    assert!(named("mdbook-driver").is_none(), "tools are not shipped");

    build("again");
    let bytes = |path: &Path| std::fs::read(path).unwrap();
    assert!(
        bytes(archive) == bytes(&at("again").join(archive.file_name().unwrap())),
        "two archives differ"
    );
}

/// A Rust solver from `new-solver` compiles in a folder of its own, and conforms.
#[test]
fn a_new_solver_in_rust_builds() {
    let folder = tempfile::tempdir().unwrap();
    let coordinator = tests::harness::programs().join("coordinator");
    done(
        Command::new(&coordinator)
            .args(["new-solver", "mine", "--lang", "rust"])
            .current_dir(folder.path()),
    );
    let crate_of = folder.path().join("mine");
    done(
        Command::new(env!("CARGO"))
            .args(["build", "--release"])
            .current_dir(&crate_of)
            .env_remove("CARGO_TARGET_DIR"),
    );
    let program = crate_of.join("target/release/mine");
    let said = done(
        Command::new(&coordinator)
            .args(["conform", "--quick", "--role", "thermal", "--"])
            .arg(program)
            .current_dir(folder.path()),
    );
    println!("{said}");
}
