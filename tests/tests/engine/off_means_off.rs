//! An effect that a case does not name does not exist at run time. The tests iterate over the
//! registries, so that a new effect is tested as soon as it is registered.

use crate::harness::{Place, Table, case, field_files, fleet, planned, root};
use proto::description::Description;
use proto::model::Solver;
use run::plan::Plan;
use serde_json::{Value, json};
use std::collections::BTreeSet;

fn registries() -> [Description; 2] {
    [mech_solver::MechSolver.description(), thermal_solver::ThermalSolver.description()]
}

fn effects() -> BTreeSet<String> {
    registries().iter().flat_map(|d| d.effects.iter().map(|e| e.name.clone())).collect()
}

/// All field files of a run, and the work of the participants.
fn answer(place: &Place) -> (Vec<(String, Vec<u8>)>, Table) {
    let work = |head: &str| head.ends_with("_work") || head.ends_with("_iterations");
    (field_files(&place.out()), place.table("iterations.csv").of(work))
}

/// Elements of the shipped case: 83 × 63, the ellipse with a margin of one element.
const POINTS: u64 = 5229;

/// Text of a case with the section of one effect removed.
fn without(text: &str, effect: &str) -> String {
    let mut in_effect = false;
    let keep = |line: &&str| {
        if line.starts_with('[') {
            let tables = [format!("[effects.{effect}]"), format!("[effects.{effect}.")];
            in_effect = tables.iter().any(|table| line.starts_with(table));
        }
        !in_effect
    };
    text.lines().filter(keep).map(|line| format!("{line}\n")).collect()
}

/// Effects named in a case, except those required by other effects of the case.
fn switchable(text: &str, needed: &[&str]) -> BTreeSet<String> {
    let named = |e: &String| text.contains(&format!("[effects.{e}]"));
    effects().into_iter().filter(|e| named(e) && !needed.contains(&e.as_str())).collect()
}

/// Removing an effect from a case gives the plan of a case that never named it: the participants
/// receive the same configuration and return the same answers.
fn leaves_no_trace(name: &str, needed: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    // Files named by a case are relative to its folder.
    let text = std::fs::read_to_string(case(name)).unwrap();
    let beside = |text: String, folder: &str| {
        text.replace(&format!("\"{folder}/"), &format!("\"{}/", case(folder)))
    };
    let text = ["materials", "histories", "profiles", "points"].into_iter().fold(text, beside);
    let plan = |file: &str, changes: &[&str]| planned(file, changes, &mut fleet()).unwrap().plan;
    let with_all = plan(&case(name), &[]);
    for off in switchable(&text, needed) {
        let never_named = folder.path().join(format!("{off}-{name}"));
        std::fs::write(&never_named, without(&text, &off)).unwrap();
        let removed = plan(&case(name), &["--unset", &format!("effects.{off}")]);
        let never = plan(&never_named.display().to_string(), &[]);
        assert_eq!(decisions(&removed), decisions(&never), "{name} without {off}");
        assert_fields_of_effect_are_absent(&with_all, &removed, &off);
    }
}

/// All parts of a plan that determine the results: configuration and estimate of each participant,
/// and the settings of the coordinator.
fn decisions(plan: &Plan) -> (Value, String) {
    let participants = plan.participants.iter();
    let given = participants.map(|one| json!([one.role, one.configuration, one.estimate]));
    let Plan { fields, live, windows, scheme, implicit, interpolation, mappings, effects, .. } =
        plan;
    let rest = format!(
        "{fields:?} {live:?} {windows:?} {scheme:?} {implicit:?} {interpolation:?} {mappings:?} \
         {effects:?} {:?} {:?} {:?}",
        plan.mode, plan.bodies, plan.skips
    );
    (given.collect(), rest)
}

/// Compares the runs of a case, not only its plans.
fn runs_leave_no_trace(name: &str, off: &str) {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(case(name)).unwrap();
    let never_named = folder.path().join(name);
    std::fs::write(&never_named, without(&text, off)).unwrap();
    let (removed, never) = (Place::new(), Place::new());
    let summary = removed.summary(&case(name), &["--unset", &format!("effects.{off}")]);
    let reference = never.summary(&never_named.display().to_string(), &[]);
    assert_eq!(answer(&removed), answer(&never), "{name} without {off}");
    for part in ["contact", "temperature", "effects"] {
        assert_eq!(summary[part], reference[part], "{name} without {off}: {part}");
    }
    let inactive = summary["effects"]["inactive"].as_array().unwrap();
    assert!(inactive.iter().any(|name| name == off));
}

table_of_tests! { runs_leave_no_trace:
    a_run_without_partial_slip_has_never_heard_of_it("wheel-rail.toml", "partial_slip");
    a_run_without_friction_heat_has_never_heard_of_it("wheel-rail.toml", "friction_heat");
    a_run_without_a_third_body_has_never_heard_of_it("third-body.toml", "third_body_layer");
    a_run_without_friction_that_falls_has_never_heard_of_it("falling-friction.toml", "temperature_friction");
}

/// Defines a test for each shipped case that is compared, with the effects required by other
/// effects of the case.
macro_rules! an_effect_that_is_off_leaves_no_trace {
    ($($test:ident($name:expr, $needed:expr);)+) => {
        table_of_tests! { leaves_no_trace: $($test($name, $needed);)+ }

        #[test]
        fn every_registered_effect_is_switched_off_in_some_case() {
            let of = |name: &str, needed: &[&str]| {
                switchable(&std::fs::read_to_string(case(name)).unwrap(), needed)
            };
            let tested: BTreeSet<String> = [$(of($name, $needed)),+].into_iter().flatten().collect();
            assert_eq!(tested, effects());
        }
    };
}

an_effect_that_is_off_leaves_no_trace! {
    an_effect_that_is_off_leaves_no_trace_in_rolling("wheel-rail.toml", &[]);
    an_effect_that_is_off_leaves_no_trace_in_a_third_body("third-body.toml", &[]);
    an_effect_that_is_off_leaves_no_trace_on_rough_surfaces("rough.toml", &[]);
    an_effect_that_is_off_leaves_no_trace_in_yielding("rough-limited.toml", &[]);
    an_effect_that_is_off_leaves_no_trace_in_a_loop("falling-friction.toml", &["friction_heat"]);
    an_effect_that_is_off_leaves_no_trace_in_hot_steel("hot-steel.toml", &["friction_heat"]);
    an_effect_that_is_off_leaves_no_trace_in_steel_that_expands("wheel-spin.toml", &["friction_heat"]);
    an_effect_that_is_off_leaves_no_trace_between_rough_surfaces("locked-wheel-steady.toml", &["friction_heat"]);
    an_effect_that_is_off_leaves_no_trace_near_the_maximum_of_adhesion("slip-friction.toml", &["friction_heat"]);
    an_effect_that_is_off_leaves_no_trace_in_a_film("viscous-layer.toml", &[]);
    an_effect_that_is_off_leaves_no_trace_on_a_greased_rail("greased-rail.toml", &["friction_heat"]);
    an_effect_that_is_off_leaves_no_trace_in_a_polymer_tyre("polymer-tyre.toml", &["partial_slip"]);
    an_effect_that_is_off_leaves_no_trace_in_a_layer_that_yields("yielding-layer.toml", &["friction_heat"]);
    an_effect_that_is_off_leaves_no_trace_in_a_layer_that_hardens("plastic-layer.toml", &["friction_heat", "partial_slip"]);
    an_effect_that_is_off_leaves_no_trace_under_a_block("brake-block.toml", &["friction_heat"]);
    an_effect_that_is_off_leaves_no_trace_before_a_hot_wall("thermo-elastic-rod.toml", &["friction_heat"]);
    an_effect_that_is_off_leaves_no_trace_in_worn_profiles("worn-profile.toml", &[]);
    an_effect_that_is_off_leaves_no_trace_under_a_train("train.toml", &["friction_heat"]);
    an_effect_that_is_off_leaves_no_trace_in_a_white_layer("white-etching-layer.toml", &["friction_heat"]);
    an_effect_that_is_off_leaves_no_trace_in_a_resting_contact("electric-contact.toml", &["friction_heat", "partial_slip"]);
    an_effect_that_is_off_leaves_no_trace_at_points("stress-at-points.toml", &["partial_slip"]);
    an_effect_that_is_off_leaves_no_trace_over_a_joint("rail-joint.toml", &["friction_heat", "partial_slip"]);
    an_effect_that_is_off_leaves_no_trace_in_steel_that_softens("softening.toml", &["friction_heat", "partial_slip", "plasticity"]);
    an_effect_that_is_off_leaves_no_trace_in_steel_that_flows("yielding.toml", &["friction_heat", "partial_slip"]);
}

/// Names of the fields of a plan.
fn fields(plan: &Plan) -> BTreeSet<String> {
    plan.fields.iter().map(|field| field.kind.name.clone()).collect()
}

/// Asserts that a plan contains no field provided by this effect only; with the effect there is
/// one, if the effect provides any.
fn assert_fields_of_effect_are_absent(with_all: &Plan, plan: &Plan, effect: &str) {
    let name = &plan.name;
    let [on, off] = [with_all, plan].map(fields);
    let descriptions = registries();
    let specs = descriptions.iter().flat_map(|description| &description.effects);
    let provided: BTreeSet<String> =
        specs.filter(|spec| spec.name == effect).flat_map(|spec| spec.provides.clone()).collect();
    assert!(off.is_disjoint(&provided), "{name} without {effect}: {off:?}");
    assert!(provided.is_empty() || !on.is_disjoint(&provided), "{name} with {effect}: {on:?}");
    let text = plan.to_string();
    // `plan` lists effects that are off by name in one list; an effect that is on has its own line.
    let off = text.lines().skip_while(|line| line.get(11..15) != Some("off "));
    let off = off.take_while(|line| !line.is_empty()).map(|line| &line[11..]);
    let told: BTreeSet<&str> = off.flat_map(|line| line.split([',', ' '])).collect();
    assert!(told.contains(effect), "{text}");
    assert!(!text.contains(&format!(" on  {effect} ")), "{text}");
}

#[test]
fn without_friction_heat_no_thermal_process_takes_part() {
    let place = Place::new();
    let summary = place.summary(&case("wheel-rail.toml"), &["--unset", "effects.friction_heat"]);
    let plan: Value =
        serde_json::from_str(&std::fs::read_to_string(place.out().join("plan.json")).unwrap())
            .unwrap();
    let roles: Vec<_> =
        plan["participants"].as_array().unwrap().iter().map(|one| &one["role"]).collect();
    assert_eq!(roles, ["mech"]);
    assert!(summary.get("temperature").is_none(), "absent, never 0");
    let bytes = 8 * (POINTS * 5 + 3);
    assert_eq!(
        summary["cost"]["bytes_exchanged"], bytes,
        "pressure, traction, slip, and the force"
    );
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
    assert_eq!(summary["cost"]["bytes_exchanged"], 2 * (8 * POINTS + 16), "first and last outputs");
    assert!(!place.out().join("fields").exists());
}

#[test]
fn only_the_fields_asked_for_are_written() {
    let place = Place::new();
    place.summary(&case("wheel-rail.toml"), &["--set", "output.fields=[\"pressure\"]"]);
    let (files, _) = answer(&place);
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let contact = ["mech_contact.pvd", "mech_contact_000000.csv", "mech_contact_000000.vti"];
    assert_eq!(names, [&["last.bin"], &contact[..], &["open.py"]].concat());
    let image = String::from_utf8_lossy(&files[3].1);
    let arrays: Vec<&str> = image.lines().filter(|line| line.contains("offset=")).collect();
    assert!(arrays.len() == 1 && arrays[0].contains("\"pressure [Pa]\""), "{arrays:?}");
}

/// Consistency of the registries: sources are cited, names are unique, models exist, and some
/// shipped case uses every effect.
#[test]
fn registries_are_complete() {
    let shipped: String = std::fs::read_dir(root().join("cases"))
        .unwrap()
        .flatten()
        .filter_map(|entry| std::fs::read_to_string(entry.path()).ok())
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
