//! Locates the executables that tests run, and checks that they are up to date.
//!
//! `cargo test --workspace` builds the executables of every package with an integration test. A
//! narrower command does not rebuild those of other packages. Tests do not build executables
//! themselves, because that would wait for every other cargo process on the machine. A missing or
//! outdated executable is an error that names the command to build it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::SystemTime;
use toml::Table;

/// Executables, with the folder of the package and the main source file.
const PROGRAMS: [(&str, &str, &str); 7] = [
    ("coordinator", "coordinator", "src/main.rs"),
    ("cosim-relay", "bridges/relay", "src/main.rs"),
    ("fmu-participant", "bridges/fmu-participant", "src/main.rs"),
    ("mech-solver", "mech-solver", "src/main.rs"),
    ("thermal-solver", "thermal-solver", "src/main.rs"),
    ("precice-participant", "bridges/precice", "src/main.rs"),
    ("toy", "tests", "src/bin/toy.rs"),
];

/// Returns the folder of the executables, `target/PROFILE`.
///
/// # Panics
/// Panics if an executable is missing or outdated.
pub fn programs() -> &'static Path {
    static FOLDER: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    let checked = FOLDER.get_or_init(|| {
        let folder = deps().parent().unwrap().to_owned();
        // A source edited while tests run belongs to the next build; the tests are linked with the
        // same libraries.
        let linked = changed(&std::env::current_exe().unwrap());
        for (name, package, main) in PROGRAMS {
            let libraries = sources_of(package).into_iter();
            let mut sources: Vec<_> = libraries.filter(|path| changed(path) <= linked).collect();
            sources.push(root().join(package).join(main));
            fresh(&folder.join(name), &sources)?;
        }
        beside_programs(&folder, "libcosim.so", "proto/c")?;
        beside_programs(&folder, "libprecice.so", "bridges/precice")?;
        Ok(folder)
    });
    checked.as_ref().unwrap_or_else(|told| panic!("{told}"))
}

/// Returns the command of a participant of the tests: the program, and the name of the participant.
pub fn toy(name: &str) -> [String; 2] {
    [programs().join("toy").display().to_string(), name.to_owned()]
}

/// Returns the folder of `libcosim.so`, where cargo puts the libraries of a test.
///
/// # Panics
/// Panics if the library is missing or outdated.
pub fn library() -> &'static Path {
    static FOLDER: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    let checked = FOLDER.get_or_init(|| {
        fresh(&deps().join("libcosim.so"), &sources_of("proto/c"))?;
        Ok(deps())
    });
    checked.as_ref().unwrap_or_else(|told| panic!("{told}"))
}

/// Links a library beside the executables, where participants in Python and
/// `precice-participant` look for it. `cargo build` does this, `cargo test` does not.
fn beside_programs(folder: &Path, name: &str, package: &str) -> Result<(), String> {
    let (built, place) = (deps().join(name), folder.join(name));
    fresh(&built, &sources_of(package))?;
    let partial = folder.join(format!("{name}.{}", std::process::id()));
    let copied = std::fs::hard_link(&built, &partial).and_then(|()| {
        let renamed = std::fs::rename(&partial, &place);
        // If both names are the same file, `rename` does nothing.
        std::fs::remove_file(&partial).or(renamed)
    });
    copied.map_err(|error| format!("{}: {error}", place.display()))
}

/// Returns an example of the crate `proto`, built by `cargo test`.
///
/// # Panics
/// Panics if the example is missing or outdated.
pub fn example(name: &str) -> PathBuf {
    let built = programs().join("examples").join(name);
    fresh(&built, &[root().join(format!("proto/examples/{name}.rs"))])
        .unwrap_or_else(|told| panic!("{told}"));
    built
}

/// Root folder of the workspace.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// Folder of the test executable, `target/PROFILE/deps`.
fn deps() -> PathBuf {
    std::env::current_exe().unwrap().parent().unwrap().to_owned()
}

/// Checks that the file exists and is no older than any of its sources.
fn fresh(file: &Path, sources: &[PathBuf]) -> Result<(), String> {
    let command = match cfg!(debug_assertions) {
        true => "cargo test --workspace",
        false => "cargo test --release --workspace",
    };
    let how = format!(
        "Run all tests (`{command}`), or build what they run first (`{command} --no-run`)."
    );
    let Some(built) = changed(file) else {
        return Err(format!("{} is missing. {how}", file.display()));
    };
    let newer = sources.iter().find(|source| changed(source) > Some(built));
    newer.map_or(Ok(()), |source| {
        Err(format!("{} is older than {}. {how}", file.display(), source.display()))
    })
}

fn changed(path: &Path) -> Option<SystemTime> {
    path.metadata().and_then(|file| file.modified()).ok()
}

fn manifest(folder: &Path) -> Table {
    std::fs::read_to_string(folder.join("Cargo.toml")).unwrap().parse().unwrap()
}

/// Folders of a package and of all workspace packages it depends on.
fn packages(package: &str) -> Vec<PathBuf> {
    let workspace = manifest(&root());
    let shared = &workspace["workspace"]["dependencies"];
    let mut found = vec![root().join(package)];
    let mut next = 0;
    while let Some(folder) = found.get(next).cloned() {
        next += 1;
        let manifest = manifest(&folder);
        let dependencies = manifest.get("dependencies").and_then(toml::Value::as_table);
        for (name, told) in dependencies.into_iter().flatten() {
            let inherited = told.get("workspace").is_some();
            let (told, from) =
                if inherited { (&shared[name], root()) } else { (told, folder.clone()) };
            if let Some(path) = told.get("path").and_then(toml::Value::as_str) {
                let path = from.join(path).canonicalize().unwrap();
                if !found.contains(&path) {
                    found.push(path);
                }
            }
        }
    }
    found
}

/// Sources of the libraries of a package and its dependencies.
fn sources_of(package: &str) -> Vec<PathBuf> {
    packages(package).iter().flat_map(|package| sources(package)).collect()
}

/// Sources of the library of a package, as reported by the compiler.
fn sources(package: &Path) -> Vec<PathBuf> {
    let manifest = manifest(package);
    let own = manifest.get("lib").and_then(|lib| lib.get("name")).and_then(toml::Value::as_str);
    let name = own.or_else(|| manifest["package"]["name"].as_str()).unwrap().replace('-', "_");
    let told = compiled().get(&name).cloned().unwrap_or_default();
    told.into_iter().map(|source| root().join(source)).collect()
}

/// Sources of every library in `deps`, by name; the latest build wins.
fn compiled() -> &'static BTreeMap<String, Vec<PathBuf>> {
    static LIBRARIES: OnceLock<BTreeMap<String, Vec<PathBuf>>> = OnceLock::new();
    LIBRARIES.get_or_init(|| {
        let entries = std::fs::read_dir(deps()).unwrap().flatten().map(|entry| entry.path());
        let told = entries.filter(|path| path.extension().is_some_and(|end| end == "d"));
        let mut told: Vec<_> = told.map(|path| (changed(&path), path)).collect();
        told.sort();
        told.iter().filter_map(|(_, path)| library_of(path)).collect()
    })
}

/// Parses a dependency file: returns library and sources, if the library belongs to the workspace.
fn library_of(path: &Path) -> Option<(String, Vec<PathBuf>)> {
    let text = std::fs::read_to_string(path).ok()?;
    let (target, sources) = text.lines().find_map(|line| {
        let (target, sources) = line.split_once(": ")?;
        target.ends_with(".rlib").then_some((target, sources))
    })?;
    let file = Path::new(target).file_stem()?.to_str()?.strip_prefix("lib")?;
    let name = file.rsplit_once('-').map_or(file, |(name, _)| name);
    // Spaces in paths are escaped. Sources of other packages have absolute paths.
    let sources = sources.replace("\\ ", "\0");
    let sources: Vec<PathBuf> =
        sources.split(' ').map(|source| PathBuf::from(source.replace('\0', " "))).collect();
    let ours = sources.first()?.is_relative();
    ours.then(|| (name.to_owned(), sources))
}

#[cfg(test)]
mod tests {
    use super::{fresh, packages, sources, sources_of};
    use crate::harness::root;
    use std::fs::File;
    use std::time::SystemTime;

    #[test]
    fn what_is_missing_or_stale_is_refused_with_the_command() {
        let folder = tempfile::tempdir().unwrap();
        let (program, sources) = (folder.path().join("coordinator"), sources_of("coordinator"));
        let missing = fresh(&program, &sources).unwrap_err();
        assert!(
            missing.contains("coordinator is missing. Run all tests (`cargo test"),
            "{missing}"
        );
        let file = File::create(&program).unwrap();
        assert_eq!(fresh(&program, &sources), Ok(()));
        file.set_modified(SystemTime::UNIX_EPOCH).unwrap();
        let stale = fresh(&program, &sources).unwrap_err();
        assert!(stale.contains("coordinator is older than") && stale.contains(".rs"), "{stale}");
        assert!(stale.contains("--workspace`"), "{stale}");
    }

    /// The coordinator depends on the protocol but on no solver. No package has an empty list of
    /// sources.
    #[test]
    fn a_program_is_made_from_its_package_and_those_that_it_depends_on() {
        let packages = packages("coordinator");
        let has = |name: &str| packages.contains(&root().join(name));
        assert!(has("coordinator") && has("proto") && !has("mech-solver") && !has("tests"));
        for package in &packages {
            let sources = sources(package);
            assert!(sources.iter().any(|source| source.starts_with(package)), "{sources:?}");
        }
    }
}
