//! The registry: the description agrees with `configure`.

use crate::common::*;
use mech_solver::MechSolver;
use proto::configuration::Mode;
use proto::description::{Description, KeyKind, KeySpec};
use proto::model::Solver;
use serde_json::{Value, json};
use std::collections::BTreeSet;

fn description() -> Description {
    MechSolver.description()
}

fn assert_unique<'a>(names: impl Iterator<Item = &'a String>) {
    let mut seen = BTreeSet::new();
    for name in names {
        assert!(seen.insert(name), "{name} occurs twice");
    }
}

#[test]
fn names_are_unique_and_sources_are_cited() {
    let description = description();
    assert_eq!(description.role, "mech");
    assert_eq!(description.name, "mech-solver");
    assert!(description.standalone && description.estimates);
    assert_unique(description.models.iter().map(|model| &model.name));
    assert_unique(description.effects.iter().map(|effect| &effect.name));
    for model in &description.models {
        assert!(!model.source.trim().is_empty() && !model.summary.trim().is_empty());
        assert!(model.steady || model.transient);
        assert_unique(description.keys.iter().chain(&model.keys).map(|key| &key.path));
    }
    for effect in &description.effects {
        assert!(!effect.source.trim().is_empty() && !effect.law.trim().is_empty());
    }
}

#[test]
fn fields_and_models_that_are_named_exist() {
    let description = description();
    let models: BTreeSet<_> = description.models.iter().map(|model| &model.name).collect();
    let known = |field: &String| proto::field::find(field).is_some();
    for model in &description.models {
        assert!(model.consumes.iter().chain(&model.provides).all(known));
    }
    for effect in &description.effects {
        assert!(!effect.models.is_empty());
        assert!(effect.models.iter().all(|model| models.contains(model)), "{}", effect.name);
        assert!(effect.consumes.iter().chain(&effect.provides).all(known));
    }
}

/// Accuracy entries of a model name an existing key, existing effects and a source.
#[test]
fn every_model_says_how_accurate_it_is() {
    let description = description();
    assert_eq!(description.check(), Ok(()));
    let effects: BTreeSet<_> = description.effects.iter().map(|effect| &effect.name).collect();
    for model in &description.models {
        // Rods have one element.
        let Some(refinement) = &model.accuracy.refinement else {
            assert_eq!(model.name, "rod");
            continue;
        };
        let keys = description.keys.iter().chain(&model.keys);
        assert!(keys.into_iter().any(|key| key.path == refinement.key), "{}", model.name);
        assert!(!refinement.source.is_empty());
        for one in &model.accuracy.simplifications {
            assert!(one.with_effects.iter().all(|effect| effects.contains(effect)));
            assert!(!one.what.is_empty() && !one.source.is_empty());
        }
    }
}

/// Every model with every effect, steady or in time: accepted exactly if the effect declares
/// support of the model; then all fields promised by either are laid out.
#[test]
fn support_agrees_with_configure() {
    let description = description();
    for model in &description.models {
        for effect in &description.effects {
            // Creepage, because some effects carry no force at rest.
            let mut case = fitted(driven(paper(), "creepage", -0.002), &model.name);
            case["effects"] = json!({ effect.name.clone(): {} });
            // Properties that an effect may need of a material.
            case["materials"]["steel"]["yield_stress"] = json!(1e9);
            case["materials"]["steel"]["thermal_expansion"] = json!(1e-5);
            case["materials"]["steel"]["wear_per_joule"] = json!(1e-12);
            case["materials"]["steel"]["delayed_compliance_ratio"] = json!(0.1);
            case["materials"]["steel"]["retardation_time"] = json!(1e-4);
            let softer =
                concat!(env!("CARGO_MANIFEST_DIR"), "/../cases/materials/steel-softening.csv");
            case["materials"]["steel"]["softening_table"] = json!(softer);
            // Required parameters of an effect are quantities, and one of each set of alternatives:
            // 1 GPa for a pressure, a small positive number for any other unit.
            let needed = |key: &&KeySpec| key.required || key.one_of.is_some();
            for key in effect.keys.iter().filter(needed) {
                let KeyKind::Quantity { unit } = &key.kind else { continue };
                let name = key.path.rsplit('.').next().unwrap();
                let value = if unit == "Pa" { 1e9 } else { 1e-14 };
                case["effects"][&effect.name][name] = json!(value);
            }
            if effect.name == "stress_at_points" {
                case["effects"]["stress_at_points"]["axis"] = json!({"body": "rail", "z": -1e-3});
            }
            if effect.name == "plastic_layer" {
                case["effects"]["partial_slip"] = json!({});
            }
            if effect.name == "friction_bands" {
                let bands = "/../cases/profiles/greased-gauge-side.csv";
                let bands = format!("{}{bands}", env!("CARGO_MANIFEST_DIR"));
                case["effects"]["friction_bands"]["table"] = json!(bands);
            }
            let mut configuration = configuration(&case);
            configuration.model = model.name.clone();
            configuration.outputs = model.provides.clone();
            configuration.observed = effect.provides.clone();
            let mut setup = MechSolver.configure(&configuration);
            if setup.is_err() {
                configuration.mode = Mode::Transient;
                setup = MechSolver.configure(&configuration);
            }
            assert_eq!(setup.is_ok(), effect.models.contains(&model.name), "{}", effect.name);
            if let Ok(setup) = setup {
                for field in model.provides.iter().chain(&effect.provides) {
                    assert!(setup.layout().grid_of(field).is_some(), "{field}");
                }
            }
        }
    }
}

#[test]
fn description_survives_the_wire() {
    let description = description();
    let text = serde_json::to_string(&description).unwrap();
    assert_eq!(serde_json::from_str::<Description>(&text).unwrap(), description);
}

/// Required keys in the description are required by the solver.
#[test]
fn every_required_key_is_required() {
    let keys = description().keys;
    let required = |key: &&KeySpec| key.required;
    for key in keys.iter().filter(required) {
        let name = if key.path.starts_with("bodies.") { "wheel" } else { "steel" };
        let path = key.path.replace('*', name);
        let mut case = paper();
        let (table, name) = path.rsplit_once('.').unwrap();
        let pointer = format!("/{}", table.replace('.', "/"));
        case.pointer_mut(&pointer).unwrap().as_object_mut().unwrap().remove(name).unwrap();
        let refusal = refusal(&configuration(&case));
        assert_eq!((refusal.key.as_str(), refusal.reason.as_str()), (path.as_str(), "missing"));
    }
}

/// A case without the optional keys runs with the defaults that the description publishes.
#[test]
fn defaults_are_those_of_the_description() {
    let description = description();
    let keys: Vec<_> = description.keys.iter().chain(&description.models[0].keys).collect();
    let default = |path: &str| {
        let key = keys.iter().find(|key| key.path == path).unwrap();
        key.default.clone().unwrap()
    };
    let mut spelled = paper();
    spelled["mech"]["resolution"] = default("mech.resolution");
    spelled["motion"]["creep_law"] = default("motion.creep_law");
    let mut silent = paper();
    silent.as_object_mut().unwrap().remove("mech");
    silent["motion"].as_object_mut().unwrap().remove("creep_law");
    let (spelled, silent) = (run(&spelled), run(&silent));
    assert_eq!(spelled.contact, silent.contact);
    assert_eq!(spelled.layout, silent.layout);
}

#[track_caller]
fn assert_refused(case: &Value, key: &str, reason: &str) {
    let refusal = refusal(&configuration(case));
    assert_eq!(refusal.key, key);
    assert!(refusal.reason.contains(reason), "{refusal}");
    assert!(!refusal.fix.is_empty());
}

#[test]
fn what_hertz_carter_cannot_take_is_refused() {
    let set = |path: &str, value: Value| {
        let mut case = paper();
        let (table, key) = path.rsplit_once('.').unwrap();
        let table = case.pointer_mut(&format!("/{}", table.replace('.', "/"))).unwrap();
        table[key] = value;
        case
    };
    for key in ["eta", "phi"] {
        let mut case = driven(paper(), "creepage", -0.01);
        case["motion"]["creepage"][key] = json!(1e-3);
        let path = format!("motion.creepage.{key}");
        assert_refused(&case, &path, "supports longitudinal creepage only");
    }
    for radius in [-0.3, -0.2] {
        assert_refused(
            &set("bodies.wheel.radius_y", json!(radius)),
            "bodies.wheel.radius_y",
            "no closed elliptic contact",
        );
    }
    assert_refused(&set("motion.creep_law", json!("linear")), "motion.creep_law", "linear");
    assert_refused(
        &driven(paper(), "traction_coefficient", 0.61),
        "motion.traction_coefficient",
        "friction limit of 0.6",
    );
    assert_refused(
        &driven(paper(), "tangential_force", -80.5e3),
        "motion.tangential_force",
        "friction limit of 80400 N",
    );
    // The limit follows from the force that the given ellipse carries.
    let given = driven(paper_table_2(), "tangential_force", 81.5e3);
    assert_refused(&given, "motion.tangential_force", "friction limit of 81");
    assert!(MechSolver.configure(&configuration(&driven(given, "tangential_force", 81e3))).is_ok());
    for path in ["bodies.rail.radius_y", "bodies.wheel.radius_x"] {
        for radius in [1e13, 1e300] {
            assert_refused(&set(path, json!(radius)), path, "a line, not an ellipse");
        }
    }
    // Too small for a number, too small for the area of an element, and larger than a body.
    for (force, part) in [(1e-320, "not a number"), (1e-300, "not a number"), (1e12, "on a body")] {
        assert_refused(&set("load.normal_force", json!(force)), "load.normal_force", part);
    }
    let mut thin = paper_table_2();
    thin["contact"]["semi_axis_b"] = json!(1000.0);
    assert_refused(&thin, "mech.resolution", "elements in all");
}

#[test]
fn unknown_names_are_refused() {
    let mut unknown = configuration(&paper());
    unknown.model = "herz-carter".to_owned();
    let refused = refusal(&unknown);
    assert_eq!(refused.key, "mech.model");
    assert!(refused.fix.contains("hertz-carter"));

    let mut case = paper();
    case["effects"]["magnetism"] = json!({});
    assert_refused(&case, "effects.magnetism", "no such effect");

    let mut field = configuration(&paper());
    field.observed.push("lower_temperature".to_owned());
    assert_eq!(refusal(&field).key, "mech.model");
}

/// For every model, the share of friction power that does not become heat reduces the provided heat
/// and nothing else. Tolerance: rounding of a product.
#[test]
fn the_heat_is_a_share_of_the_friction_power() {
    for model in description().models.into_iter().filter(|model| model.name != "rod") {
        let mut case = paper();
        case["mech"] = json!({"resolution": 3});
        case = fitted(case, &model.name);
        if model.name == "periodic" {
            case = without(case, "partial_slip");
        }
        if model.name == "explicit-fe" {
            case = driven(case, "creepage", -0.002);
        }
        let whole = run(&case);
        case["effects"]["friction_heat"] = json!({"heat_share": 0.9});
        let part = run(&case);
        assert_eq!(part.contact, whole.contact, "{}", model.name);
        for (part, whole) in
            part.fields["friction_power"].iter().zip(&whole.fields["friction_power"])
        {
            assert_eq!(*part, 0.9 * whole, "{}", model.name);
        }
        for field in ["pressure", "traction", "slip_velocity", "surface_speed"] {
            assert_eq!(part.fields[field], whole.fields[field], "{}: {field}", model.name);
        }
        case["effects"]["friction_heat"] = json!({"heat_share": 1.1});
        let mut beyond = configuration(&case);
        beyond.model.clone_from(&model.name);
        assert_eq!(refusal(&beyond).key, "effects.friction_heat.heat_share");
    }
}

/// The guide shows the source of the effect that runs.
#[test]
fn the_guide_to_effects_shows_the_code_that_runs() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let read = |path: &str| std::fs::read_to_string(format!("{root}/{path}")).unwrap();
    let guide = read("docs/add-an-effect.md");
    let (_, after) = guide.split_once("<!-- ").unwrap();
    let (path, after) = after.split_once(" -->\n```rust\n").unwrap();
    let (code, _) = after.split_once("```").unwrap();
    assert!(code.lines().count() > 20, "{code}");
    assert!(read(path).ends_with(code), "{path} is another than the guide has");
}
