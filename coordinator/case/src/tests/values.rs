//! Values of a valid case.

use super::{GOOD, case, case_with, descriptions, effect, lines, mech, thermal};
use crate::schema::{ROLE, own_keys};
use crate::{Control, Coupling, Limits, OutputFields, Place, RawCase, Timing, validate};
use contract::description::KeySpec;
use contract::field;
use coupling::map::{Basis, Kernel, Method};
use coupling::settings::{Acceleration, Predictor, Scheme, Tolerances};
use serde_json::json;
use std::sync::Arc;

#[test]
fn settings_have_their_values_and_defaults() {
    let plain = case(GOOD).unwrap();
    assert_eq!(plain.title.as_deref(), Some("A test"));
    assert_eq!(plain.timing, Timing::Steady);
    assert_eq!(plain.coupling, Coupling::default(), "the schema has the defaults of the structure");
    assert_eq!(plain.coupling.scheme, Scheme::Auto);
    let deadlines = [
        plain.coupling.solve_deadline,
        plain.coupling.start_deadline,
        plain.coupling.heartbeat_deadline,
    ];
    assert_eq!(deadlines, [3600.0, 30.0, 30.0]);
    assert_eq!((plain.output.fields, plain.output.every), (OutputFields::All, None));
    assert_eq!(plain.limits, Limits { shared_memory: None, threads: None });
    assert_eq!(plain.effects, ["friction_heat", "partial_slip"]);
    let set = case_with(
        GOOD,
        &[
            "time={mode=\"transient\", window=\"1 ms\", end=0.5}",
            "coupling={scheme=\"serial-explicit\", solve_deadline=\"2 min\"}",
            "limits={shared_memory=\"64 MB\", threads=3}",
            "output={fields=[\"pressure\"], every=3}",
            "thermal.command=[\"python3\", \"t.py\"]",
            "mech.attach=true",
        ],
    )
    .unwrap();
    let control = Control::Fixed;
    assert_eq!(set.timing, Timing::Transient { window: 0.001, end: 0.5, control });
    assert_eq!(set.coupling.scheme, Scheme::SerialExplicit);
    assert_eq!(set.coupling.solve_deadline, 120.0);
    assert_eq!(set.limits, Limits { shared_memory: Some(64_000_000), threads: Some(3) });
    assert_eq!(set.output.fields, OutputFields::Named(vec!["pressure".to_owned()]));
    assert_eq!(set.output.every, Some(3));
    assert_eq!(set.participants[1].command.as_ref().map(Vec::len), Some(2));
    assert!(set.participants[0].attach && !set.participants[1].attach);
}

#[test]
fn settings_of_an_implicit_scheme() {
    let plain = case(GOOD).unwrap().coupling.implicit;
    assert_eq!(plain.acceleration, Acceleration::IqnIls);
    assert_eq!((plain.min_iterations, plain.max_iterations, plain.strict), (1, 100, true));
    assert_eq!((plain.relaxation, plain.filter), (0.5, 1e-6));
    assert_eq!((plain.reuse_windows, plain.max_columns), (10, 100));
    let relative = Tolerances { relative: Some(1e-6), ..Tolerances::default() };
    assert_eq!(plain.tolerances_of("pressure"), relative);
    let set = case_with(
        GOOD,
        &[
            "coupling={acceleration=\"aitken\", absolute=1e-3, strict=false, predictor=\"linear\"}",
            "coupling.fields.pressure.residual_relative=0.1",
        ],
    );
    let set = set.unwrap().coupling.implicit;
    assert_eq!((set.acceleration, set.strict), (Acceleration::Aitken, false));
    assert_eq!(set.predictor, Predictor::Linear);
    let absolute = Tolerances { absolute: Some(1e-3), ..Tolerances::default() };
    assert_eq!(
        set.tolerances_of("friction_power"),
        absolute,
        "a measure given replaces the default"
    );
    let own = Tolerances { residual_relative: Some(0.1), ..Tolerances::default() };
    assert_eq!(set.tolerances_of("pressure"), own);
}

#[test]
fn methods_of_mapping_are_left_open_unless_chosen() {
    let [consistent, conservative] = [field::LOWER_TEMPERATURE, field::FRICTION_POWER];
    let methods = |sets: &[&str]| {
        let mappings = case_with(GOOD, sets).unwrap().mappings;
        [consistent, conservative].map(|field| mappings.method_of(&field.kind()))
    };
    assert_eq!(methods(&[]), [None; 2]);
    assert_eq!(methods(&["mapping.method=radial-basis"]), [Some(Method::RadialBasis); 2]);
    let own = ["mapping.method=nearest-neighbour", "mapping.fields.friction_power.method=auto"];
    assert_eq!(methods(&own), [Some(Method::NearestNeighbour), None]);
}

#[test]
fn radial_basis_functions_have_a_radius_where_they_need_one() {
    let [consistent, conservative] = [field::LOWER_TEMPERATURE, field::FRICTION_POWER];
    let sets = [
        "mapping.method=radial-basis",
        "mapping.basis=wendland-c6",
        "mapping.radius=5 mm",
        "mapping.fields.friction_power.method=radial-basis",
        "mapping.fields.friction_power.basis=thin-plate-splines",
    ];
    let mappings = case_with(GOOD, &sets).unwrap().mappings;
    let kernel = |basis, radius| Some(Method::Kernel(Kernel { basis, radius }));
    assert_eq!(
        mappings.method_of(&consistent.kind()),
        kernel(Basis::WendlandC6, Some(5e-3)),
        "the general function"
    );
    let own = mappings.method_of(&conservative.kind());
    assert_eq!(own, kernel(Basis::ThinPlateSplines, None), "the field's own function");
}

#[test]
fn own_keys_are_declared_soundly() {
    let keys = own_keys();
    for (at, key) in keys.iter().enumerate() {
        assert!(keys[..at].iter().all(|k| k.spec.path != key.spec.path), "{}", key.spec.path);
        let section = key.spec.path.split('.').next().unwrap();
        let own = crate::schema::SECTIONS.contains(&section);
        assert!(own || section == ROLE, "{}", key.spec.path);
    }
    assert!(Scheme::WORDS.iter().all(|word| Scheme::from_word(word).is_some()));
}

#[test]
fn a_participant_gets_what_it_reads_and_nothing_else() {
    let case = case(&GOOD.replace("[load]", "[materials.unused]\ndensity = 1\n[load]")).unwrap();
    assert_eq!(
        case.values_for(&thermal(), "columns").0,
        json!({
            "motion": {"speed": 140.0 / 3.6},
            "rail": {"material": "steel"},
            "materials": {"steel": {"density": 7850.0}},
            "effects": {"friction_heat": {"partition": "equal"}},
        })
    );
    let half_space = case.values_for(&mech(), "half-space");
    assert_eq!(half_space.get("effects"), Some(&json!({"friction_heat": {}, "partial_slip": {}})));
    assert_eq!(
        half_space.get("materials"),
        Some(&json!({"steel": {"youngs_modulus": 210e9, "poisson_ratio": 0.3}}))
    );
    assert_eq!(half_space.get("mech"), Some(&json!({"resolution": 40, "symmetric": false})));
    assert!(!half_space.has("motion.creep_law") && !half_space.has("motion.creepage"));
    let carter = case.values_for(&mech(), "hertz-carter");
    assert_eq!(carter.get("motion.creep_law"), Some(&json!("linear")), "defaults of any model");
}

#[test]
fn keys_of_other_models_and_idle_participants_may_stay() {
    let text = GOOD
        .replace("[load]", "creep_law = \"simplified\"\n[load]")
        .replace("[effects.friction_heat]\npartition = \"equal\"\n", "")
        .replace("density = 7850\n", "");
    let case = case(&text).unwrap();
    assert_eq!(case.idle, ["thermal"]);
    assert_eq!(case.values.get("motion.creep_law"), Some(&json!("simplified")));
    assert!(!case.values_for(&mech(), "half-space").has("motion.creep_law"));
    let wrong = super::case(&text.replace("simplified", "simplifyed")).unwrap_err();
    assert_eq!(
        lines(&wrong),
        ["17:13 motion.creep_law: unknown creep_law `simplifyed`; did you mean `simplified`? | \
          write \"linear\" or \"simplified\""]
    );
}

#[test]
fn a_refusal_of_a_participant_gets_its_place() {
    let case = case(GOOD).unwrap();
    let place = |key: &str| case.problem_at(key, "r", "f").place.to_string();
    assert_eq!(place("wheel.radius"), "case.toml:6:10");
    assert_eq!(place("materials.steel.poisson_ratio"), "case.toml:11:1", "a default");
    assert_eq!(place("effects.partial_slip"), "case.toml:25:1");
    assert_eq!(place("nothing.of.this"), "case.toml");
    let set = case_with(GOOD, &["wheel.radius=1"]).unwrap();
    let problem = set.problem_at("wheel.radius", "is too large for the grid", "lower it");
    assert_eq!(problem.place, Place::Argument { text: "--set wheel.radius=1".into() });
    let shown = set.report(vec![problem]).unwrap().to_string();
    assert!(shown.starts_with(
        "error: --set wheel.radius=1: wheel.radius: is too large for the grid\n  fix: lower it\n"
    ));
    assert!(set.report(Vec::new()).is_none());
}

/// An effect whose keys use a wildcard in a group, a product and a name.
#[test]
fn groups_and_products_work_within_each_entry_of_a_table() {
    let mut descriptions = descriptions();
    let layer = |name: &str| KeySpec::number(&format!("layers.*.{name}"), "layer");
    Arc::make_mut(&mut descriptions[0].1).effects.push(effect(
        "layers",
        &["half-space"],
        vec![
            layer("stiffness").one_of("layer"),
            layer("flexibility").one_of("layer").magnitude_below(&["layers.*.limit"]),
            layer("limit").default_value(1.0),
        ],
    ));
    let text = format!(
        "{GOOD}[effects.layers]\n[layers.a]\nstiffness = 1\n[layers.b]\n[layers.c]\nflexibility = -2\n"
    );
    let raw = RawCase::parse("case.toml", &text).unwrap();
    let error = validate(&raw, &descriptions, &[]).unwrap_err();
    assert_eq!(
        lines(&error),
        [
            "35:1 layers.b: missing; mech needs exactly one of layers.b.stiffness or \
             layers.b.flexibility | add one of `stiffness = 0.3` or `flexibility = 0.3` to \
             [layers.b]",
            "37:15 layers.c.flexibility: -2 is not below layers.c.limit = 1 in magnitude | lower \
             it, or raise layers.c.limit",
        ]
    );
}

#[test]
fn an_alternative_that_the_chosen_model_does_not_read_is_reported() {
    let mut descriptions = descriptions();
    let keys = &mut Arc::make_mut(&mut descriptions[0].1).keys;
    let force = keys.iter().position(|k| k.path == "motion.tangential_force").unwrap();
    let force = keys.remove(force);
    Arc::make_mut(&mut descriptions[0].1).models[0].keys.push(force);
    let text = GOOD.replace("traction_coefficient = 0.58", "tangential_force = 1000");
    let raw = RawCase::parse("case.toml", &text).unwrap();
    let error = validate(&raw, &descriptions, &[]).unwrap_err();
    assert_eq!(
        lines(&error),
        ["17:1 motion.tangential_force: the chosen models do not read it | write \
          motion.traction_coefficient or motion.creepage instead"]
    );
}

#[test]
fn a_case_of_one_participant_of_ones_own() {
    let mut own = mech();
    own.role = "track".to_owned();
    own.keys.clear();
    let text = "[case]\nname = \"x\"\n[track]\nmodel = \"half-space\"\ncommand = [\"t\"]\n";
    let raw = RawCase::parse("case.toml", text).unwrap();
    let case = validate(&raw, &[("track".to_owned(), own.into())], &[]).unwrap();
    assert_eq!(case.participants[0].role, "track");
    let idle = "[case]\nname = \"x\"\n[thermal]\n";
    let error = super::case(idle).unwrap_err();
    assert_eq!(
        lines(&error),
        ["3:1 thermal: nothing would run: no active effect needs thermal | add an effect, \
          or another participant"]
    );
}

/// The case replaces the thermal program by a simpler one: keys of the default program are no
/// error.
#[test]
fn keys_of_the_program_that_is_replaced_are_noted() {
    let usual = descriptions();
    let mut descriptions = descriptions();
    let simple = &mut descriptions[1].1;
    let mut own = simple.keys.clone();
    own.retain(|key| !key.path.starts_with("thermal."));
    let simple = Arc::make_mut(simple);
    (simple.keys, simple.models[0].keys) = (own, Vec::new());
    let more = ["thermal.resolution=3", "thermal.mesh.size=2"];
    let mut usual = vec![usual[1].clone()];
    Arc::make_mut(&mut usual[0].1).models[0].keys.extend([
        KeySpec::integer("thermal.resolution", "elements"),
        KeySpec::number("thermal.mesh.*", "any of them"),
    ]);
    let mut raw = RawCase::parse("case.toml", GOOD).unwrap();
    raw.apply(&more, &[]).unwrap();
    let case = validate(&raw, &descriptions, &usual).unwrap();
    let unread: Vec<_> = case.unread.iter().map(|unread| unread.key.as_str()).collect();
    assert_eq!(unread, ["thermal.resolution", "thermal.mesh.size"]);
    let readers = |unread: &super::super::Unread| unread.readers.clone();
    let usual_name = format!("{} as thermal", usual[0].1.name);
    assert!(case.unread.iter().all(|unread| readers(unread) == [usual_name.as_str()]));
    assert!(!case.values.has("thermal.resolution"), "nobody has checked it");
    // Keys that neither program knows, and a case without the default program, give errors as
    // usual.
    assert_eq!(validate(&raw, &descriptions, &[]).unwrap_err().list().len(), 2);
    raw.apply(&["thermal.resolutoin=3", "effects.radiation={}"], &[]).unwrap();
    let error = validate(&raw, &descriptions, &usual).unwrap_err();
    let keys: Vec<&str> = error.list().iter().map(|problem| problem.key.as_str()).collect();
    assert_eq!(keys, ["effects.radiation", "thermal.resolutoin"]);
}

#[test]
fn a_participant_started_by_hand_has_a_command_too() {
    let text = format!("{GOOD}[track]\nmodel = \"beam\"\nattach = true\n");
    let error = super::case(&text).unwrap_err();
    assert_eq!(
        lines(&error),
        [
            "32:1 track: the participant of this section has not described itself | name the program \
          that you start by hand as `track.command`: it is asked what it is, and not started"
        ]
    );
}
