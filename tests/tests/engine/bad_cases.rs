//! Invalid cases: all errors listed, each with its place, reason and fix.

use crate::harness::{Ended, Place, case, checked};
use tests::harness::changed;

/// Asserts that a case is rejected, with all of these parts in the message.
fn refused(text: &str, parts: &[&str]) {
    assert_refused(&checked("bad.toml", text), parts);
}

fn assert_refused(ended: &Ended, parts: &[&str]) {
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    for part in [parts, &["fix: "]].concat() {
        assert!(ended.stderr.contains(part), "`{part}` is missing in:\n{}", ended.stderr);
    }
}

/// The message about a table of version 0.1 gives the present form.
#[test]
fn old_tables_are_told_what_to_write() {
    let text = changed(&[
        ("[bodies.wheel]\nposition = \"upper\"\nradius_x", "[wheel]\nradius"),
        ("[bodies.rail]\nposition = \"lower\"\nradius_y", "[rail]\ncrown_radius"),
    ]);
    let wheel = "write [bodies.wheel] with position = \"upper\", radius_x for radius";
    let rail = "write [bodies.rail] with position = \"lower\", radius_y for crown_radius";
    refused(&text, &["wheel: is a name from an earlier version", wheel, rail]);
}

#[test]
fn there_is_one_body_at_each_position() {
    let twice = changed(&[("position = \"lower\"", "position = \"upper\"")]);
    refused(&twice, &["are both the upper body", "write one table [bodies.NAME]"]);
    let nowhere = changed(&[("position = \"lower\"\n", "")]);
    refused(&nowhere, &["bodies.rail.position: missing"]);
}

#[test]
fn unknown_keys_get_a_suggestion() {
    let text = changed(&[("speed = 38.889 ", "sped = 38.889 ")]);
    refused(&text, &["bad.toml:24:1: motion.sped: unknown key", "write `motion.speed`"]);
}

#[test]
fn missing_sections_are_named() {
    let text = changed(&[("[load]\nnormal_force = \"134 kN\"\n", "")]);
    refused(&text, &["missing section [load]", "normal_force"]);
}

#[test]
fn wrong_units_and_ranges() {
    refused(&changed(&[("134 kN", "134 kPa")]), &["load.normal_force", "kPa"]);
    refused(&changed(&[("\"134 kN\"", "-134e3")]), &["load.normal_force", "is not above 0 N"]);
    refused(&changed(&[("= 0.58 ", "= 0.6 ")]), &["traction_coefficient", "friction.coefficient"]);
    refused(&changed(&[("= 0.58 ", "= 0.75 ")]), &["traction_coefficient", "0.75 is not below"]);
}

#[test]
fn unknown_models_and_effects() {
    refused(&changed(&[("\"half-space\"", "\"halfspace\"")]), &["mech.model", "half-space"]);
    let magnetism = changed(&[("[effects.partial_slip]", "[effects.magnetism]")]);
    refused(&magnetism, &["effects.magnetism: unknown effect", "partial_slip (mech)"]);
}

#[test]
fn a_solver_refuses_what_only_it_can_judge() {
    let spin = changed(&[
        ("traction_coefficient = 0.58 ", "creepage = { xi = -0.01, phi = 1 } "),
        ("\"half-space\"", "\"hertz-carter\""),
    ]);
    refused(&spin, &["motion.creepage.phi", "hertz-carter"]);
    let steady_only = changed(&[
        ("model = \"columns\"", "model = \"ertz-knothe\""),
        ("mode = \"steady\"", "mode = \"transient\"\nwindow = 1e-5\nend = 1e-3"),
    ]);
    refused(&steady_only, &["ertz-knothe", "transient"]);
}

/// Values that would fail later, in services, labels or arithmetic, are rejected with the case.
#[test]
fn values_that_would_break_the_machinery() {
    let left = case("exchange.toml");
    let set = |set: &str, part: &str| {
        assert_refused(&Place::new().plan(&left, &["--set", set]), &[part]);
    };
    for key in ["solve_deadline", "start_deadline", "heartbeat_deadline"] {
        set(&format!("coupling.{key}=1e20"), key);
    }
    set("time.window=1e-300", "windows");
    let left = std::fs::read_to_string(left).unwrap();
    let second = format!("{left}\n[left2]\nmodel = \"increment\"\ncommand = [\"toy\", \"left\"]\n");
    refused(&second, &["its program plays the role `left`"]);
}
