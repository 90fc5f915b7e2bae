//! Tests of the case crate, with two small participants that have every kind of key.

mod alone;
mod errors;
mod options;
mod robustness;
mod syntax;
mod values;

use super::{Case, Problems, RawCase, validate};
use contract::accuracy::Accuracy;
use contract::description::{Description, EffectSpec, KeySpec, ModelSpec};
use std::sync::Arc;

/// A case without errors.
const GOOD: &str = r#"[case]
name = "wheel-rail"
title = "A test"

[wheel]
radius = 0.46
material = "steel"
[rail]
crown_radius = "300 mm"
material = "steel"
[materials.steel]
youngs_modulus = "210 GPa"
density = 7850

[motion]
speed = "140 km/h"
traction_coefficient = 0.58
[load]
normal_force = "134 kN"
[friction]
coefficient = 0.6

[effects.friction_heat]
partition = "equal"
[effects.partial_slip]

[mech]
model = "half-space"
resolution = 40
[thermal]
model = "columns"
"#;

fn model(name: &str, transient: bool, keys: Vec<KeySpec>) -> ModelSpec {
    ModelSpec {
        name: name.to_owned(),
        summary: format!("the {name} model"),
        source: "test".to_owned(),
        steady: name != "moving-source",
        transient,
        rewinds: true,
        varies_step: true,
        consumes: Vec::new(),
        provides: vec!["pressure".to_owned()],
        keys,
        accuracy: Accuracy::default(),
    }
}

fn effect(name: &str, models: &[&str], keys: Vec<KeySpec>) -> EffectSpec {
    EffectSpec {
        figures: Vec::new(),
        name: name.to_owned(),
        law: "q = f".to_owned(),
        source: "test".to_owned(),
        models: models.iter().map(|m| (*m).to_owned()).collect(),
        consumes: Vec::new(),
        provides: vec!["friction_power".to_owned()],
        keys,
    }
}

fn description(role: &str, standalone: bool) -> Description {
    Description {
        protocol: contract::PROTOCOL_VERSION,
        name: format!("{role}-test"),
        version: "1".to_owned(),
        role: role.to_owned(),
        standalone,
        estimates: false,
        advises: false,
        reusable: true,
        build: None,
        models: Vec::new(),
        effects: Vec::new(),
        keys: Vec::new(),
        fields: Vec::new(),
        figures: Vec::new(),
        diagrams: Vec::new(),
        renamed: Vec::new(),
    }
}

fn mech() -> Description {
    let creepage = |name: &str, unit: &str| {
        KeySpec::quantity(&format!("motion.creepage.{name}"), unit, "creepage")
            .one_of("motion.drive")
    };
    let contact = |name: &str, unit: &str| {
        KeySpec::quantity(&format!("contact.{name}"), unit, "contact")
            .above(0.0)
            .together("contact")
    };
    let creep_law = KeySpec::choice("motion.creep_law", &["linear", "simplified"], "creep law");
    let radius = |path: &str| KeySpec::quantity(path, "m", "radius").required().above(0.0);
    let material = |path: &str| KeySpec::name_in(path, "materials", "material").required();
    Description {
        models: vec![
            model("hertz-carter", false, vec![creep_law.default_value("linear")]),
            model("half-space", true, Vec::new()),
        ],
        effects: vec![
            effect("friction_heat", &["hertz-carter", "half-space"], Vec::new()),
            effect("partial_slip", &["half-space"], Vec::new()),
        ],
        keys: vec![
            radius("wheel.radius"),
            radius("rail.crown_radius"),
            material("wheel.material"),
            material("rail.material"),
            KeySpec::quantity("materials.*.youngs_modulus", "Pa", "stiffness")
                .required()
                .above(0.0),
            KeySpec::number("materials.*.poisson_ratio", "Poisson's ratio")
                .default_value(0.3)
                .above(-1.0)
                .at_most(0.5),
            KeySpec::quantity("motion.speed", "m/s", "rolling speed").required().above(0.0),
            KeySpec::number("motion.traction_coefficient", "traction")
                .one_of("motion.drive")
                .magnitude_below(&["friction.coefficient"]),
            KeySpec::quantity("motion.tangential_force", "N", "force")
                .one_of("motion.drive")
                .magnitude_below(&["friction.coefficient", "load.normal_force"]),
            creepage("xi", "1").required(),
            creepage("eta", "1").default_value(0),
            creepage("phi", "rad/m").default_value(0),
            KeySpec::quantity("load.normal_force", "N", "load").required().above(0.0),
            KeySpec::number("friction.coefficient", "friction").required().above(0.0),
            KeySpec::quantity("friction.decay_temperature", "K", "a rise")
                .default_value(200.0)
                .of_differences(),
            contact("semi_axis_a", "m"),
            contact("semi_axis_b", "m"),
            contact("max_pressure", "Pa"),
            KeySpec::integer("mech.resolution", "elements").default_value(20).at_least(1.0),
            KeySpec::flag("mech.symmetric", "use symmetry").default_value(false),
        ],
        ..description("mech", true)
    }
}

fn thermal() -> Description {
    let partition =
        KeySpec::choice("effects.friction_heat.partition", &["equal", "by-effusivity"], "share");
    Description {
        models: vec![model("columns", true, Vec::new()), model("moving-source", true, Vec::new())],
        effects: vec![EffectSpec {
            figures: Vec::new(),
            consumes: vec!["friction_power".to_owned()],
            ..effect(
                "friction_heat",
                &["columns", "moving-source"],
                vec![partition.default_value("equal")],
            )
        }],
        keys: vec![
            KeySpec::quantity("motion.speed", "m/s", "rolling speed").required().above(0.0),
            KeySpec::name_in("rail.material", "materials", "material").required(),
            KeySpec::quantity("materials.*.density", "kg/m3", "density").required().above(0.0),
        ],
        ..description("thermal", false)
    }
}

fn descriptions() -> Vec<(String, Arc<Description>)> {
    vec![("mech".to_owned(), mech().into()), ("thermal".to_owned(), thermal().into())]
}

/// Reads and validates a case.
fn case(text: &str) -> Result<Case, Problems> {
    validate(&RawCase::parse("case.toml", text)?, &descriptions(), &[])
}

/// Reads and validates a case with `--set` options.
fn case_with(text: &str, set: &[&str]) -> Result<Case, Problems> {
    let mut raw = RawCase::parse("case.toml", text)?;
    raw.apply(set, &[])?;
    validate(&raw, &descriptions(), &[])
}

/// Formats each error on one line: "12:1 key: reason | fix", or "option | ..." for options.
fn lines(problems: &Problems) -> Vec<String> {
    let line = |p: &super::Problem| {
        let place = p.place.to_string();
        let place = place.strip_prefix("case.toml:").unwrap_or(&place);
        format!("{place} {}: {} | {}", p.key, p.reason, p.fix)
    };
    problems.list().iter().map(line).collect()
}
