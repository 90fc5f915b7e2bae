//! What a case does not name does not exist at run time. The tests iterate the registries, so that
//! a new effect is tested by being registered.

use crate::harness::{Place, case};
use proto::description::Description;
use proto::model::Solver;
use std::collections::BTreeSet;
use std::path::Path;

fn registries() -> [Description; 2] {
    [mech_solver::MechSolver.description(), thermal_solver::ThermalSolver.description()]
}

fn effects() -> BTreeSet<String> {
    registries().iter().flat_map(|d| d.effects.iter().map(|e| e.name.clone())).collect()
}

/// Every field file of a run, byte by byte, and the participants' work.
fn answer(place: &Place) -> (Vec<(String, Vec<u8>)>, Vec<String>) {
    let folder = place.out().join("fields");
    let mut fields: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .flatten()
        .map(|e| (e.file_name().into_string().unwrap(), std::fs::read(e.path()).unwrap()))
        .collect();
    fields.sort();
    let table = std::fs::read_to_string(place.out().join("iterations.csv")).unwrap();
    let work = columns(&table, |head| head.ends_with("_work") || head.ends_with("_iterations"));
    (fields, work)
}

fn columns(table: &str, wanted: impl Fn(&str) -> bool) -> Vec<String> {
    let head: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let picked = |line: &str| {
        let cells = line.split(',').zip(&head).filter(|(_, head)| wanted(head));
        cells.map(|(cell, _)| cell.to_owned()).collect::<Vec<_>>().join(",")
    };
    table.lines().map(picked).collect()
}

/// The shipped case without any effect's section: it never named one.
fn bare_case(folder: &Path) -> String {
    let text = std::fs::read_to_string(case("wheel-rail.toml")).unwrap();
    let mut kept = String::new();
    let mut in_effect = false;
    for line in text.lines() {
        if line.starts_with('[') {
            in_effect = line.starts_with("[effects.");
        }
        if !in_effect {
            kept += line;
            kept += "\n";
        }
    }
    let path = folder.join("bare.toml");
    std::fs::write(&path, kept).unwrap();
    path.display().to_string()
}

/// The shipped case names every effect; taking one out must give what a case gives that names all
/// the others and has never heard of this one.
#[test]
fn an_effect_that_is_off_leaves_no_trace() {
    let folder = tempfile::tempdir().unwrap();
    let bare = bare_case(folder.path());
    let effects = effects();
    assert!(effects.len() >= 2);
    for off in &effects {
        let (removed, never) = (Place::new(), Place::new());
        let key = format!("effects.{off}");
        let summary = removed.summary(&case("wheel-rail.toml"), &["--unset", &key]);
        let others: Vec<String> = effects
            .iter()
            .filter(|name| *name != off)
            .map(|name| format!("effects.{name}={{}}"))
            .collect();
        let more: Vec<&str> = others.iter().flat_map(|set| ["--set", set.as_str()]).collect();
        let reference = never.summary(&bare, &more);
        assert_eq!(answer(&removed), answer(&never), "{off}");
        for part in ["contact", "temperature", "effects"] {
            assert_eq!(summary[part], reference[part], "{off}: {part}");
        }
        let inactive = summary["effects"]["inactive"].as_array().unwrap();
        assert!(inactive.iter().any(|name| name == off.as_str()));
        assert_fields_of_effect_are_absent(&removed, off);
    }
}

/// No field that only this effect provides is written or planned.
fn assert_fields_of_effect_are_absent(place: &Place, effect: &str) {
    let plan =
        place.start(&["plan", &case("wheel-rail.toml"), "--unset", &format!("effects.{effect}")]);
    let plan = plan.wait().stdout;
    for description in registries() {
        for spec in description.effects.iter().filter(|e| e.name == effect) {
            for field in &spec.provides {
                assert!(!plan.contains(field), "{field} in the plan:\n{plan}");
            }
        }
    }
    assert!(plan.contains(&format!("off {effect}")), "{plan}");
}

#[test]
fn without_friction_heat_no_thermal_process_is_started() {
    let place = Place::new();
    let summary = place.summary(&case("wheel-rail.toml"), &["--unset", "effects.friction_heat"]);
    let started: Vec<_> = place
        .log()
        .into_iter()
        .filter(|e| e["fields"]["message"] == "participant started")
        .map(|e| e["fields"]["role"].clone())
        .collect();
    assert_eq!(started, ["mech"]);
    assert!(summary.get("temperature").is_none(), "absent, never 0");
    assert_eq!(summary["cost"]["bytes_exchanged"], 8 * 4941 * 5, "pressure, traction, slip");
    assert!(summary["cost"].get("thermal_s").is_none());
}

#[test]
fn a_case_of_mechanics_alone_needs_no_thermal_section() {
    let more = ["--unset", "effects.friction_heat", "--unset", "thermal"];
    let summary = Place::new().summary(&case("wheel-rail.toml"), &more);
    assert!(summary.get("temperature").is_none());
}

#[test]
fn output_that_is_not_asked_for_is_not_computed() {
    let place = Place::new();
    let summary = place.summary(&case("wheel-rail.toml"), &["--set", "output.fields=none"]);
    assert_eq!(summary["cost"]["bytes_exchanged"], 2 * (8 * 4941 + 16), "first and last outputs");
    assert!(!place.out().join("fields").exists() || answer(&place).0.len() == 2);
}

/// The registries agree with themselves: sources are cited, names are unique, models exist, and a
/// shipped case exercises every effect.
#[test]
fn registries_are_complete() {
    let shipped: String = ["wheel-rail.toml", "full-slip.toml", "cold-start.toml"]
        .iter()
        .map(|name| std::fs::read_to_string(case(name)).unwrap())
        .collect();
    for description in registries() {
        for (index, effect) in description.effects.iter().enumerate() {
            assert!(!effect.source.is_empty() && !effect.law.is_empty(), "{}", effect.name);
            let earlier = &description.effects[..index];
            assert!(earlier.iter().all(|e| e.name != effect.name), "{} twice", effect.name);
            for model in &effect.models {
                assert!(description.models.iter().any(|m| &m.name == model), "{model}");
            }
            assert!(shipped.contains(&format!("[effects.{}]", effect.name)), "{}", effect.name);
        }
        for model in &description.models {
            assert!(!model.source.is_empty() && !model.summary.is_empty(), "{}", model.name);
            assert!(shipped.contains(&format!("\"{}\"", model.name)), "{}", model.name);
        }
    }
}
