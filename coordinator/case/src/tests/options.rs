//! `--set` and `--unset`.

use super::{GOOD, case, case_with, descriptions, lines};
use crate::{Place, RawCase, validate};
use serde_json::json;

const FILE_CREEPAGE: (&str, &str) =
    ("traction_coefficient = 0.58", "creepage = { xi = -0.01, eta = 0.002 }");

fn creepage_case() -> String {
    GOOD.replace(FILE_CREEPAGE.0, FILE_CREEPAGE.1)
}

#[test]
fn values_are_toml_or_bare_texts() {
    let rows = [
        ("mech.resolution=64", "mech.resolution", json!(64)),
        (" wheel.radius = 0.5", "wheel.radius", json!(0.5)),
        ("load.normal_force=100 kN", "load.normal_force", json!(1e5)),
        ("load.normal_force=\"100 kN\"", "load.normal_force", json!(1e5)),
        ("load.normal_force='100 kN'", "load.normal_force", json!(1e5)),
        ("mech.symmetric=true", "mech.symmetric", json!(true)),
        ("case.title=a = b", "case.title", json!("a = b")),
        ("case.title=2024-01-01", "case.title", json!("2024-01-01")),
        ("case.title=\"\"", "case.title", json!("")),
        ("materials.'steel'.density=7800", "materials.steel.density", json!(7800.0)),
        ("output.fields=[\"pressure\"]", "output.fields", json!(["pressure"])),
        ("materials.soft={youngs_modulus=1e9, density=1}", "effects.partial_slip", json!({})),
    ];
    for (option, key, value) in rows {
        let case = case_with(GOOD, &[option]).unwrap_or_else(|e| panic!("{option}: {e}"));
        assert_eq!(case.values.get(key), Some(&value), "{option}");
    }
}

#[test]
fn a_model_and_an_effect_can_be_switched() {
    let raw = |set: &[&str], unset: &[&str]| {
        let mut raw = RawCase::parse("case.toml", GOOD).unwrap();
        raw.apply(set, unset).unwrap();
        validate(&raw, &descriptions(), &[]).unwrap_or_else(|e| panic!("{e}"))
    };
    let switched = raw(&["mech.model=hertz-carter"], &["effects.partial_slip"]);
    assert_eq!(switched.participants[0].model, "hertz-carter");
    assert_eq!(switched.effects, ["friction_heat"]);
    assert_eq!(switched.values.get("motion.creep_law"), Some(&json!("linear")));
    let without = raw(&[], &["effects.friction_heat"]);
    assert_eq!(without.idle, ["thermal"]);
    assert_eq!(without.participants.len(), 1);
    let again = raw(&["effects.friction_heat={}"], &[]);
    assert_eq!(again.values.get("effects.friction_heat.partition"), Some(&json!("equal")));
}

#[test]
fn an_alternative_that_is_set_replaces_those_of_the_file() {
    let table = case_with(GOOD, &["motion.creepage={xi=-0.01}"]).unwrap();
    assert_eq!(
        table.values.get("motion"),
        Some(&json!({"speed": 140.0 / 3.6, "creepage": {"xi": -0.01, "eta": 0.0, "phi": 0.0}}))
    );
    let key = case_with(GOOD, &["motion.creepage.xi=-0.01"]).unwrap();
    assert_eq!(key.values, table.values);
    let other = case_with(&creepage_case(), &["motion.tangential_force=10 kN"]).unwrap();
    assert_eq!(
        other.values.get("motion"),
        Some(&json!({"speed": 140.0 / 3.6, "tangential_force": 1e4}))
    );
    assert!(!other.text().contains("creepage"), "{}", other.text());
    let one_key = case_with(&creepage_case(), &["motion.creepage.xi=-0.02"]).unwrap();
    assert_eq!(one_key.values.get("motion.creepage.eta"), Some(&json!(0.002)));
}

#[test]
fn the_last_of_equal_options_wins_and_two_alternatives_do_not() {
    let last = case_with(GOOD, &["wheel.radius=1", "wheel.radius=2"]).unwrap();
    assert_eq!(last.values.get("wheel.radius"), Some(&json!(2.0)));
    let options = ["motion.traction_coefficient=0.3", "motion.creepage.xi=-0.01"];
    let error = case_with(GOOD, &options).expect_err("two alternatives");
    assert_eq!(
        lines(&error),
        ["--set motion.traction_coefficient=0.3 motion.traction_coefficient: excludes \
          `motion.creepage` at --set motion.creepage.xi=-0.01 | keep exactly one of \
          motion.creepage and motion.traction_coefficient"]
    );
}

#[test]
fn errors_of_options_name_the_option() {
    let rows = [
        (
            "motion.sped=3",
            "--set motion.sped=3 motion.sped: unknown key; not read by the coordinator, mech \
          and thermal | write `motion.speed`",
        ),
        (
            "wheel.radius=5 kg",
            "--set wheel.radius=5 kg wheel.radius: unit `kg` cannot be \
          converted to m | write a number in m or a text with a unit, for example \"0.5 m\"",
        ),
        (
            "wheel.radius.x=5",
            "--set wheel.radius.x=5 wheel.radius.x: `wheel.radius` is not a \
          table | set `wheel.radius` itself",
        ),
        (
            "effects.magic={}",
            "--set effects.magic={} effects.magic: unknown effect `magic` | \
          remove it; available effects: friction_heat (mech, thermal) and partial_slip (mech)",
        ),
        (
            "mech.model=half",
            "--set mech.model=half mech.model: unknown model `half` | write \
          \"hertz-carter\" or \"half-space\"",
        ),
        (
            "wheel.radius",
            "--set wheel.radius : has no `=` | write `--set key=value`, such as \
          `--set motion.speed=30`",
        ),
        (
            "=3",
            "--set =3 : `` is not a key | write `--set key=value`, such as `--set \
          motion.speed=30`",
        ),
        (
            "[a]\nb=3",
            "--set [a]\u{fffd}b=3 : `[a]\nb` is not a key | write `--set key=value`, \
          such as `--set motion.speed=30`",
        ),
        (
            "wheel.radius=",
            "--set wheel.radius= wheel.radius: has no value | write a value, \
          `\"\"` for an empty text, or use --unset",
        ),
        (
            "effects.a={",
            "--set effects.a={ effects.a: the value is not TOML: unclosed inline \
          table, expected `}` | the shell removes quotes; write --set 'key=\"value\"'",
        ),
    ];
    for (option, expected) in rows {
        let error = case_with(GOOD, &[option]).expect_err(option);
        assert_eq!(lines(&error), [expected], "{option}");
    }
}

#[test]
fn all_bad_options_are_reported_at_once() {
    let mut raw = RawCase::parse("case.toml", GOOD).unwrap();
    let error = raw.apply(&["a", "b=", "wheel.radius=1"], &["motion.sped", "zzzzzzzz"]);
    let error = error.expect_err("four bad options");
    assert_eq!(error.list().len(), 4);
    let unset = error.list().iter().find(|p| p.key == "motion.sped").unwrap();
    assert_eq!(unset.place, Place::Argument { text: "--unset motion.sped".into() });
    assert_eq!(unset.fix, "write `--unset motion.speed`");
    assert!(error.to_string().ends_with("4 errors in case.toml"));
}

#[test]
fn the_text_gives_the_same_case_again() {
    let raw = RawCase::parse("case.toml", GOOD).unwrap();
    assert_eq!(raw.text(), GOOD, "an unchanged case is the very text of the file");
    let options = [
        "effects.partial_slip={}",
        "motion.creepage={xi=-0.01}",
        "case.title=say \"hi\"\\",
        "output.fields=[\"pressure\"]",
        "materials.\"soft steel\".density=7",
    ];
    let changed = case_with(GOOD, &options).unwrap();
    let text = changed.text();
    assert!(text.starts_with("# case.toml, changed by\n#   --set effects.partial_slip={}\n"));
    let again = case(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(again.values, changed.values);
    assert_eq!(again.effects, changed.effects);
}

#[test]
fn tables_keep_their_order_in_the_text() {
    let text = "[effects.b]\n[effects]\na = {}\nc = { d = { e = [1, 0x1f, inf] } }\n";
    let mut raw = RawCase::parse("x", text).unwrap();
    raw.set("\"x y\".z=1e3").unwrap();
    let body = raw.text();
    let body = body.split_once("\n\n").unwrap().1;
    let expected = "[effects.b]\n\n[effects.a]\n\n[effects.c]\nd = { e = [1, 0x1f, inf] }\n\n\
                    [\"x y\"]\nz = 1e3\n";
    assert_eq!(body, expected);
}
