//! The coordinator's code names no body, field, effect or model: participants provide these in
//! their descriptions and summaries. In the mechanics, only files in `effects` name an effect;
//! models know kinds of terms.

use super::code;
use contract::description::Description;
use contract::field::TABLE;
use contract::figure::FigureSpec;
use mech_solver::MechSolver;
use proto::model::Solver;
use std::collections::{BTreeMap, BTreeSet};
use tests::harness::root;
use thermal_solver::ThermalSolver;

/// Names with a second meaning in the coordinator: columns of tables and secant columns, geometry
/// of grids, patches of a surface.
const COMMON: [&str; 3] = ["columns", "geometry", "patches"];

/// Exceptions: files, the names they may contain, and the reason.
const EXCEPTIONS: &[(&str, &[&str], &str)] = &[(
    "coordinator/conformance/src/conform/input.rs",
    &["surface_speed"],
    "the one field of the contract's table that lies on a grid of one point",
)];

type Named = BTreeMap<String, BTreeSet<String>>;

fn names() -> BTreeSet<String> {
    let of = |description: Description| {
        let models = description.models.into_iter().map(|model| model.name);
        let effects = description.effects.into_iter().map(|effect| effect.name);
        let figure = |figure: FigureSpec| figure.key.rsplit('.').next().map(str::to_owned);
        let figures = description.figures.into_iter().filter_map(figure);
        models.chain(effects).chain(figures).collect::<Vec<_>>()
    };
    let solvers = [MechSolver.description(), ThermalSolver.description()].into_iter().flat_map(of);
    let fields = TABLE.iter().map(|field| field.name.to_owned());
    let bodies = ["wheel", "rail"].map(str::to_owned);
    let all = solvers.chain(fields).chain(bodies);
    all.filter(|name| !COMMON.contains(&name.as_str())).collect()
}

/// True if the text contains the name as a word, or as a part of a compound word.
fn has(text: &str, name: &str) -> bool {
    text.match_indices(name).any(|(at, _)| {
        let (before, after) = (&text[..at], &text[at + name.len()..]);
        !before.ends_with(char::is_alphanumeric) && !after.starts_with(char::is_alphanumeric)
    })
}

/// Names in the string literals and identifiers of each file in some folders.
fn named(folders: &[String], names: &BTreeSet<String>) -> Named {
    let (root, mut all) = (root(), Named::new());
    for file in folders.iter().flat_map(|folder| code::files(&root.join(folder))) {
        let refers = code::references(&code::read(&file));
        let words = refers.paths.into_iter().flatten().map(|word| word.to_lowercase());
        let texts: Vec<String> = refers.texts.into_iter().chain(words).collect();
        let found = names.iter().filter(|name| texts.iter().any(|text| has(text, name)));
        let found: BTreeSet<String> = found.cloned().collect();
        if !found.is_empty() {
            all.insert(file.strip_prefix(&root).unwrap().display().to_string(), found);
        }
    }
    all
}

#[test]
fn the_coordinator_names_no_physics() {
    let listed = |(file, names, _): &(&str, &[&str], _)| {
        ((*file).to_owned(), names.iter().map(|name| (*name).to_owned()).collect())
    };
    let expected: Named = EXCEPTIONS.iter().map(listed).collect();
    let members = super::manifests::members().into_iter();
    let own = members.filter(|member| member.split('/').next() == Some("coordinator"));
    let folders: Vec<String> = own.map(|member| format!("{member}/src")).collect();
    assert!(folders.contains(&"coordinator/watch/src".to_owned()), "{folders:?}");
    assert_eq!(named(&folders, &names()), expected, "files and names, as found and as listed");
}

#[test]
fn models_of_the_mechanics_name_no_effect() {
    let effects = MechSolver.description().effects.into_iter().map(|effect| effect.name);
    let mut found = named(&["mech-solver/src".to_owned()], &effects.collect());
    assert!(!found.is_empty(), "the effects name themselves");
    found.retain(|file, _| !file.starts_with("mech-solver/src/effects"));
    assert_eq!(found, Named::new());
}

/// The log level of iceoryx2 applies to the whole process: libraries must not change it; only the
/// `main` of a program may.
#[test]
fn only_a_main_decides_on_the_log_level_of_iceoryx2() {
    let root = root();
    let sources: Vec<_> = super::manifests::members()
        .iter()
        .flat_map(|folder| code::files(&root.join(folder)))
        .collect();
    let having = |text: &str| {
        let has =
            |file: &&std::path::PathBuf| std::fs::read_to_string(file).unwrap().contains(text);
        let shown =
            |file: &std::path::PathBuf| file.strip_prefix(&root).unwrap().display().to_string();
        sources.iter().filter(has).map(shown).collect::<BTreeSet<_>>()
    };
    let mains =
        ["coordinator/src/main.rs", "proto/src/participant.rs", "bridges/relay/src/main.rs"];
    assert_eq!(having("prepare_process();"), mains.map(str::to_owned).into());
    assert_eq!(having("set_log_level(LogLevel"), ["proto/src/transport.rs".to_owned()].into());
}
