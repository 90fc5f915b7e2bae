//! `coordinator keys`, `fields`, `figures`: every key, every field, and every figure of a summary.

use crate::harness::{Place, case, root};
use contract::bodies::ABSOLUTE;
use contract::description::KeySpec;
use proto::model::Solver;
use serde_json::Value;

/// The page of keys agrees with the programs, and lists every key of every case that they run.
#[test]
fn every_key_of_every_shipped_case_is_listed() {
    let print = |option: &str| {
        let ended = Place::new().start(&["keys", option]).wait();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        ended.stdout
    };
    let page = std::fs::read_to_string(root().join("docs/case.md")).unwrap();
    assert!(
        page == print("--markdown"),
        "docs/case.md is stale; write it with `coordinator keys --markdown`"
    );
    let paths = known_keys();
    let mut seen = 0;
    for entry in std::fs::read_dir(root().join("cases")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let case: toml::Value = text.parse::<toml::Table>().unwrap().into();
        let mut own = Vec::new();
        flatten("", &case, &mut own);
        // Other programs have keys of their own.
        if own.iter().any(|key| key.ends_with(".command")) {
            continue;
        }
        for key in own {
            assert!(paths.iter().any(|known| fits(known, &key)), "{}: {key}", path.display());
            seen += 1;
        }
    }
    assert!(seen > 500, "{seen}");
}

/// The schema for editors agrees with the programs; every shipped case is valid, and mistakes are
/// not.
#[test]
fn the_schema_knows_what_a_case_may_have() {
    let ended = Place::new().start(&["keys", "--schema"]).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let kept = std::fs::read_to_string(root().join("docs/case.schema.json")).unwrap();
    assert!(kept == ended.stdout, "stale; write it with `coordinator keys --schema`");
    let mut schemas = boon::Schemas::new();
    let mut compiler = boon::Compiler::new();
    compiler.add_resource("case.json", serde_json::from_str(&kept).unwrap()).unwrap();
    let schema = compiler.compile("case.json", &mut schemas).unwrap();
    let judge = |text: &str| {
        let case = serde_json::to_value(text.parse::<toml::Table>().unwrap()).unwrap();
        schemas.validate(&case, schema).map_err(|error| error.to_string())
    };
    let mut seen = 0;
    for entry in std::fs::read_dir(root().join("cases")).unwrap() {
        let path = entry.unwrap().path();
        let is_case = path.extension().is_some_and(|extension| extension == "toml");
        let text = if is_case { std::fs::read_to_string(&path).unwrap() } else { continue };
        judge(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        seen += 1;
    }
    assert!(seen > 50, "{seen}");
    // A program of the reader's reads tables of its own, beside the solvers of this project too.
    let own = "[mine]\nkey = 1\n[thermal]\ncommand = [\"mine\"]";
    judge(own).unwrap_or_else(|error| panic!("{error}"));
    for wrong in [
        "[frction]\ncoefficient = 0.6",
        "[frction]\ncoefficient = 0.6\n[thermal]\nmodel = \"columns\"",
        "[motion]\nsped = 3",
        "[load]\nnormal_force = true",
        "[mech]\nmodel = \"half-space\"\nresolution = -3",
        "[bodies.wheel]\nposition = \"above\"",
        "[effects.friction_heta]",
    ] {
        assert!(judge(wrong).is_err(), "{wrong}");
    }
}

/// A pattern matches a part of a key's path or meaning; an empty result is reported.
#[test]
fn a_pattern_finds_keys() {
    let found = Place::new().start(&["keys", "semi-axis"]).wait();
    assert!(
        found.stdout.contains("mech.resolution                   elements per semi-axis"),
        "{}",
        found.stdout
    );
    assert!(found.stdout.contains("read by mech hertz-carter"), "{}", found.stdout);
    let nothing = Place::new().start(&["keys", "no such thing"]).wait();
    assert_eq!(nothing.code, Some(2), "{}", nothing.stdout);
    assert!(nothing.stderr.contains("no entry matches `no such thing`"), "{}", nothing.stderr);
}

/// Paths of all known keys.
pub(crate) fn known_keys() -> Vec<String> {
    let ended = Place::new().start(&["keys", "--json"]).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let keys: Value = serde_json::from_str(&ended.stdout).unwrap();
    let path = |key: &Value| key["path"].as_str().unwrap().to_owned();
    keys.as_array().unwrap().iter().map(path).collect()
}

/// Dotted keys of all values. A reference to a column of a file counts as one value, as does a live
/// value.
pub(crate) fn flatten(path: &str, value: &toml::Value, keys: &mut Vec<String>) {
    match value.as_table() {
        Some(table)
            if !table.contains_key("column")
                && !["at", "from", "to"].iter().all(|key| table.contains_key(*key)) =>
        {
            for (key, value) in table {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                flatten(&path, value, keys);
            }
        }
        _ => keys.push(path.to_owned()),
    }
}

pub(crate) fn fits(known: &str, key: &str) -> bool {
    let (known, key): (Vec<&str>, Vec<&str>) =
        (known.split('.').collect(), key.split('.').collect());
    let alike = |(known, key): (&&str, &&str)| *known == "*" || *known == "ROLE" || known == key;
    known.len() == key.len() && known.iter().zip(&key).all(alike)
}

/// The pages of fields, figures, models and effects agree with the programs. They list every field
/// written by a run and every figure it prints; a pattern selects entries.
#[test]
fn every_field_and_figure_is_listed() {
    let print = |arguments: &[&str]| {
        let ended = Place::new().start(arguments).wait();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        ended.stdout
    };
    let names = |what: &str, key: &str| -> Vec<String> {
        let page = std::fs::read_to_string(root().join(format!("docs/{what}.md"))).unwrap();
        let made = print(&[what, "--markdown"]);
        assert!(
            page == made,
            "docs/{what}.md is stale; write it with `coordinator {what} --markdown`"
        );
        let all: Value = serde_json::from_str(&print(&[what, "--json"])).unwrap();
        all.as_array().unwrap().iter().map(|one| one[key].as_str().unwrap().to_owned()).collect()
    };
    let (fields, figures) = (names("fields", "name"), names("figures", "key"));
    let models = std::fs::read_to_string(root().join("docs/models.md")).unwrap();
    assert!(
        models == print(&["solvers", "--markdown"]),
        "docs/models.md is stale; write it with `coordinator solvers --markdown`"
    );
    let place = Place::new();
    let summary = place.summary(&case("third-body.toml"), &[]);
    let plan: Value =
        serde_json::from_str(&print(&["plan", &case("third-body.toml"), "--json"])).unwrap();
    for field in plan["fields"].as_array().unwrap() {
        let named = field["name"].as_str().unwrap();
        let plain = named.replace("rail_", "lower_").replace("wheel_", "upper_");
        assert!(fields.contains(&plain), "{named}");
    }
    for key in ["contact", "temperature.rail"] {
        let section = summary.pointer(&format!("/{}", key.replace('.', "/"))).unwrap();
        let described =
            |name: &str| figures.contains(&format!("{key}.{name}").replace("rail", "*"));
        let shown = [
            "max_pressure_pa",
            "friction_power_w",
            "size_over_radius",
            "max_rise_k",
            "penetration_depth_m",
        ];
        for name in shown.iter().filter(|name| section.get(name).is_some()) {
            assert!(described(name), "{key}.{name}");
        }
    }
    let found = print(&["fields", "slip"]);
    assert!(found.contains("2 components [m/s]") && !found.contains("pressure"), "{found}");
    let nothing = Place::new().start(&["figures", "no such thing"]).wait();
    assert_eq!(nothing.code, Some(2));
}

/// Every key in kelvin is either a temperature difference, for which °C is not allowed, or is
/// expected to be an absolute temperature.
#[test]
fn every_temperature_is_absolute_or_a_difference() {
    let mut seen = 0;
    for description in
        [mech_solver::MechSolver.description(), thermal_solver::ThermalSolver.description()]
    {
        let models = description.models.iter().flat_map(|model| &model.keys);
        let effects = description.effects.iter().flat_map(|effect| &effect.keys);
        let is_temperature = |spec: &&KeySpec| spec.kind.unit() == "K";
        for spec in description.keys.iter().chain(models).chain(effects).filter(is_temperature) {
            let absolute = spec.plausible.as_ref().is_some_and(|expected| expected.why == ABSOLUTE);
            assert!(spec.difference != absolute, "{}", spec.path);
            seen += 1;
        }
    }
    assert!(seen >= 7, "{seen}");
}
