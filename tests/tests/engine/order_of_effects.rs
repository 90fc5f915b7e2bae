//! The order of the tables `[effects.*]` in a case has no influence: participants receive identical
//! values and give identical results, bit for bit.

use crate::harness::{Place, case, field_files, root};
use ::case::{RawCase, validate};
use contract::description::Description;
use proto::model::Solver;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// Number of orders for each case.
const ORDERS: u64 = 3;

/// Splits the text of a case into its tables of effects, each with its subtables, and the rest.
fn parts(text: &str) -> (String, Vec<String>) {
    let (mut rest, mut tables, mut current) = (String::new(), Vec::<(String, String)>::new(), None);
    for line in text.lines() {
        if line.starts_with('[') {
            let name =
                line.strip_prefix("[effects.").and_then(|name| name.split([']', '.']).next());
            current = name.map(|name| {
                let known = tables.iter().position(|(own, _)| own == name);
                known.unwrap_or_else(|| {
                    tables.push((name.to_owned(), String::new()));
                    tables.len() - 1
                })
            });
        }
        let into = current.map_or(&mut rest, |at: usize| &mut tables[at].1);
        into.push_str(line);
        into.push('\n');
    }
    (rest, tables.into_iter().map(|(_, text)| text).collect())
}

/// Shuffles the tables of effects of a case, by Fisher and Yates with a linear congruential
/// generator.
fn shuffled(text: &str, seed: u64) -> String {
    let (rest, mut tables) = parts(text);
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(1);
    for last in (1..tables.len()).rev() {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        tables.swap(last, (state >> 33) as usize % (last + 1));
    }
    format!("{rest}\n{}", tables.concat())
}

/// Values given to each solver of this workspace, for each of its models.
fn given(name: &str, text: &str, own: &[(String, Arc<Description>)]) -> Option<Vec<String>> {
    let raw = RawCase::parse(name, text).unwrap().with_folder(root().join("cases"));
    let case = validate(&raw, own, &[]).ok()?;
    let of = |(_, description): &(String, Arc<Description>)| -> Vec<String> {
        let models = description.models.iter();
        models.map(|model| case.values_for(description, &model.name).0.to_string()).collect()
    };
    Some(own.iter().flat_map(of).collect())
}

/// Shipped cases with more than one effect, by name.
fn shipped() -> BTreeMap<String, String> {
    let files = std::fs::read_dir(root().join("cases")).unwrap().flatten();
    let toml = files.filter(|file| file.path().extension().is_some_and(|end| end == "toml"));
    let read = |file: std::fs::DirEntry| {
        let text = std::fs::read_to_string(file.path()).unwrap();
        (file.file_name().into_string().unwrap(), text)
    };
    toml.map(read).filter(|(_, text)| parts(text).1.len() > 1).collect()
}

/// Every shipped case in three orders: the solvers receive the same values in the same order.
#[test]
fn every_shipped_case_gives_solvers_the_same_values_in_any_order() {
    let own: Vec<(String, Arc<Description>)> = [
        ("mech".to_owned(), Arc::new(mech_solver::MechSolver.description())),
        ("thermal".to_owned(), Arc::new(thermal_solver::ThermalSolver.description())),
    ]
    .into();
    let (mut compared, cases) = (0, shipped());
    for (name, text) in &cases {
        // Cases with one solver are validated with that one. Cases with other programs are run
        // below, or have no solver of this kind.
        let alone = [&own[..], &own[..1], &own[1..]];
        let Some((own, first)) = alone.iter().find_map(|own| Some((own, given(name, text, own)?)))
        else {
            continue;
        };
        for seed in 1..=ORDERS {
            let other = given(name, &shuffled(text, seed), own).unwrap();
            assert!(first == other, "{name}, order {seed}");
        }
        compared += 1;
    }
    assert!(compared * 10 >= cases.len() * 9, "{compared} of {} cases", cases.len());
}

/// A case with several effects in three orders: fields and figures are identical bit for bit.
fn gives_the_same_bits(name: &str, settings: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(case(name)).unwrap();
    let answer = |path: &Path| {
        let place = Place::new();
        let mut summary = place.summary(&path.display().to_string(), settings);
        let parts = ["contact", "temperature", "stress"].map(|part| summary[part].take());
        (field_files(&place.out()), parts)
    };
    let first = answer(Path::new(&case(name)));
    for seed in 1..=ORDERS {
        // Files named by a case are relative to its folder.
        let beside = ["materials", "histories", "profiles", "points"];
        let text = beside.iter().fold(shuffled(&text, seed), |text, folder| {
            text.replace(&format!("\"{folder}/"), &format!("\"{}/", case(folder)))
        });
        let path = folder.path().join(format!("{seed}-{name}"));
        std::fs::write(&path, text).unwrap();
        assert!(first == answer(&path), "{name}, order {seed}");
    }
}

table_of_tests! {
    gives_the_same_bits:
    a_layer_that_yields("yielding-layer.toml", &["--set", "mech.resolution=8"]);
    a_greased_rail("greased-rail.toml", &["--set", "mech.resolution=8"]);
    a_rough_contact("rough.toml", &["--set", "mech.resolution=8"]);
}
