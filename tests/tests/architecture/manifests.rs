//! Allowed dependencies of each crate: from the manifests, and for external crates from the lock
//! file.

use super::code;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use tests::harness::root;
use toml::{Table, Value};

/// Every shipped crate, with the crates of the workspace it may use.
const ORDER: &[(&str, &[&str])] = &[
    ("grids", &[]),
    ("tables", &[]),
    ("contract", &["grids", "tables"]),
    ("proto", &["contract", "grids"]),
    ("cosim-c", &["contract", "proto"]),
    ("numerics", &[]),
    ("elastic", &["grids", "numerics"]),
    ("half-space", &["elastic", "grids", "numerics", "tables"]),
    ("explicit-fe", &["elastic", "grids", "numerics"]),
    ("wheel-rail", &["elastic", "grids", "half-space", "numerics", "tables"]),
    (
        "mech-solver",
        &["contract", "proto", "numerics", "elastic", "half-space", "explicit-fe", "wheel-rail"],
    ),
    ("heat", &["grids", "numerics", "tables"]),
    ("thermal-solver", &["contract", "proto", "numerics", "heat"]),
    ("coupling", &["contract"]),
    ("case", &["contract", "coupling"]),
    ("surrogate", &[]),
    ("run", &["contract", "proto", "coupling", "case"]),
    ("contact-fmu", &["surrogate"]),
    ("fmu-participant", &["proto"]),
    ("precice-config", &[]),
    ("precice", &["precice-config", "proto"]),
    ("relay", &["contract", "proto", "coupling", "run"]),
    ("console", &["contract", "proto", "case", "run"]),
    ("pages", &["contract", "run"]),
    ("conformance", &["contract", "proto", "coupling", "case", "run", "console"]),
    ("watch", &["contract", "proto", "run", "console", "pages", "conformance"]),
    (
        "studies",
        &[
            "contract",
            "proto",
            "coupling",
            "case",
            "surrogate",
            "run",
            "console",
            "pages",
            "conformance",
        ],
    ),
    (
        "coordinator",
        &[
            "contract",
            "proto",
            "coupling",
            "case",
            "surrogate",
            "run",
            "contact-fmu",
            "precice-config",
            "console",
            "pages",
            "conformance",
            "watch",
            "studies",
        ],
    ),
];

/// External crates that library crates must not use, directly or indirectly.
const WITHOUT: [&str; 4] = ["iceoryx2", "mcap", "tokio", "clap"];

/// Numerical libraries; they depend on neither protocol nor case, and do not use JSON.
const NUMERICS: [&str; 7] =
    ["numerics", "grids", "elastic", "half-space", "explicit-fe", "wheel-rail", "heat"];

struct Manifest {
    folder: String,
    /// Crates used in the code, and in the tests.
    code: BTreeSet<String>,
    tests: BTreeSet<String>,
}

/// Folders of the crates.
pub(super) fn members() -> Vec<String> {
    let Value::Array(members) = &table(&root().join("Cargo.toml"))["workspace"]["members"] else {
        panic!("the workspace names no members");
    };
    members.iter().map(|folder| folder.as_str().unwrap().to_owned()).collect()
}

fn table(path: &Path) -> Table {
    fs::read_to_string(path).unwrap().parse().unwrap()
}

fn manifests() -> BTreeMap<String, Manifest> {
    let read = |folder: String| {
        let manifest = table(&root().join(&folder).join("Cargo.toml"));
        let of = |key: &str| -> BTreeSet<String> {
            manifest
                .get(key)
                .and_then(Value::as_table)
                .into_iter()
                .flat_map(Table::keys)
                .cloned()
                .collect()
        };
        let code = &of("dependencies") | &of("build-dependencies");
        let name = manifest["package"]["name"].as_str().unwrap().to_owned();
        (name, Manifest { folder, code, tests: of("dev-dependencies") })
    };
    members().into_iter().map(read).collect()
}

/// Dependencies of the packages in the lock file, by name.
fn locked() -> BTreeMap<String, BTreeSet<String>> {
    let lock = table(&root().join("Cargo.lock"));
    let mut uses: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for package in lock["package"].as_array().unwrap() {
        let list = package.get("dependencies").and_then(Value::as_array).into_iter().flatten();
        let names = list.map(|entry| entry.as_str().unwrap().split(' ').next().unwrap().to_owned());
        uses.entry(package["name"].as_str().unwrap().to_owned()).or_default().extend(names);
    }
    uses
}

/// All direct and indirect dependencies of a crate's code.
fn closure(name: &str, manifests: &BTreeMap<String, Manifest>) -> BTreeSet<String> {
    let locked = locked();
    let (mut all, mut open) = (BTreeSet::new(), vec![name.to_owned()]);
    while let Some(next) = open.pop() {
        let used = manifests.get(&next).map_or_else(|| &locked[&next], |manifest| &manifest.code);
        open.extend(used.iter().filter(|one| all.insert((*one).clone())).cloned());
    }
    all
}

#[test]
fn crates_use_only_those_below_them() {
    let manifests = manifests();
    let ours: BTreeSet<String> = manifests.keys().cloned().collect();
    for (name, manifest) in manifests.iter().filter(|(name, _)| *name != "tests") {
        let allowed = ORDER.iter().find(|(of, _)| of == name);
        let (_, allowed) = allowed.unwrap_or_else(|| panic!("{name} has no place in the order"));
        let used = &(&manifest.code | &manifest.tests) & &ours;
        // The example on the front page of the engine runs a case with linked solvers.
        let shown = |one: &str| name == "run" && ["mech-solver", "thermal-solver"].contains(&one);
        let wrong = used.iter().filter(|one| !allowed.contains(&one.as_str()));
        let wrong: Vec<_> =
            wrong.filter(|one| manifest.code.contains(*one) || !shown(one)).collect();
        assert!(wrong.is_empty(), "{name} must not use {wrong:?}");
    }
}

#[test]
fn the_contract_is_plain_data() {
    let contract = &manifests()["contract"].code;
    let plain = ["grids", "serde", "serde_json", "tables", "thiserror", "zerocopy"];
    assert_eq!(contract.iter().collect::<Vec<_>>(), plain);
}

#[test]
fn libraries_do_without_transport_and_command_line() {
    let manifests = manifests();
    for name in ["grids", "tables", "contract", "coupling", "case", "surrogate"] {
        let all = closure(name, &manifests);
        let wrong: Vec<_> = WITHOUT.iter().filter(|one| all.contains(**one)).collect();
        assert!(wrong.is_empty(), "{name} uses {wrong:?}, directly or through others");
    }
    for name in NUMERICS {
        let all = closure(name, &manifests);
        let foreign = WITHOUT.iter().chain(&["contract", "proto", "serde_json"]);
        let wrong: Vec<_> = foreign.filter(|one| all.contains(**one)).collect();
        assert!(wrong.is_empty(), "{name} uses {wrong:?}, directly or through others");
    }
    assert!(closure("run", &manifests).contains("iceoryx2"), "no way of dependencies is seen");
}

#[test]
fn one_crate_knows_the_transport() {
    for (name, manifest) in manifests() {
        let declares = (&manifest.code | &manifest.tests).contains("iceoryx2");
        assert_eq!(declares, name == "proto", "{name}");
        for file in code::files(&root().join(&manifest.folder).join("src")) {
            let refers = code::references(&code::read(&file));
            let used = refers.uses.iter().map(|one| &one.path).chain(&refers.paths);
            let named = used.flatten().any(|word| word == "iceoryx2");
            assert!(!named || file.ends_with("proto/src/transport.rs"), "{}", file.display());
        }
    }
}

/// The example of a library's page imports this library only, so that `cargo add --path` of the
/// library is enough. Types of other crates in its signatures are re-exported.
#[test]
fn an_example_of_a_library_needs_no_other_crate() {
    let mut imports = 0;
    for folder in [
        "numerics",
        "mech-solver/elastic",
        "mech-solver/half-space",
        "mech-solver/explicit-fe",
        "mech-solver/wheel-rail",
        "thermal-solver/heat",
    ] {
        let own = folder.rsplit('/').next().unwrap().replace('-', "_");
        let page = fs::read_to_string(root().join(folder).join("README.md")).unwrap();
        for line in page.lines().filter_map(|line| line.strip_prefix("use ")) {
            let from = line.split([':', ';']).next().unwrap();
            assert!(from == own || from == "std", "{folder}/README.md: use {line}");
            imports += 1;
        }
    }
    assert!(imports > 10, "{imports}");
}
