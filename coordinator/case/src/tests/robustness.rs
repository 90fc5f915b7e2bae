//! No input makes the case crate panic, and every error has a fix.

use super::{GOOD, descriptions};
use crate::{Problems, RawCase, check_without_participants, validate};
use proptest::prelude::*;

/// Validates any readable input, and formats the errors.
fn survive(bytes: &[u8], set: &[String]) -> Result<(), TestCaseError> {
    let checked = RawCase::parse_bytes("case.toml", bytes).and_then(|mut raw| {
        let applied = raw.apply(set, &[]);
        let roles = raw.participants().len();
        assert!(roles < 50);
        if let Err(problems) = check_without_participants(&raw) {
            assert!(!problems.list().is_empty());
        }
        let validated = validate(&raw, &descriptions(), &[]);
        applied.and(validated)
    });
    match checked {
        Err(problems) => complete(&problems),
        Ok(case) => {
            let again = RawCase::parse("again", &case.text());
            let again = again.and_then(|raw| validate(&raw, &descriptions(), &[]));
            let again = again.map_err(|e| TestCaseError::fail(format!("{e}\n{}", case.text())))?;
            prop_assert_eq!(again.values, case.values, "the text gives the same case");
            prop_assert_eq!(again.effects, case.effects);
            Ok(())
        }
    }
}

fn complete(problems: &Problems) -> Result<(), TestCaseError> {
    prop_assert!(!problems.list().is_empty());
    for problem in problems.list() {
        prop_assert!(!problem.reason.is_empty() && !problem.fix.is_empty(), "{problem:?}");
    }
    let shown = problems.render(false);
    prop_assert!(!shown.contains('\x1b') && !shown.contains('\r'));
    Ok(())
}

/// Fragments of cases, inserted at wrong places.
const PIECES: &[&str] = &[
    "[",
    "]",
    "{",
    "}",
    "=",
    "\"",
    "'",
    "\n",
    ".",
    ",",
    "#",
    "[[",
    "0x",
    "-",
    "nan",
    "inf",
    "1e999",
    "9223372036854775808",
    "2024-01-01",
    "\u{feff}",
    "\u{e9}",
    "\r",
    "\0",
    "steel",
    "[motion]",
    "[effects]",
    "[effects.partial_slip]",
    "motion.creepage = {}",
    "creepage = { xi = 0, phi = \"1 rad/m\" }",
    "[materials]",
    "[time]\nmode = \"transient\"",
    "tangential_force = 1",
    "*",
    "[\"\"]",
    "\"a.b\" = 1",
    "[mech.model]",
    "[case.name]",
    "motion = 3",
    "[load.normal_force.x]",
    "material = []",
];

fn piece() -> impl Strategy<Value = String> {
    prop_oneof![
        4 => (0..PIECES.len()).prop_map(|at| PIECES[at].to_owned()),
        1 => any::<char>().prop_map(String::from),
        1 => Just(String::new()),
    ]
}

/// The good case with some ranges replaced; a position is a fraction of the length.
fn mutated() -> impl Strategy<Value = String> {
    let edit = (0.0..1.0_f64, 0_usize..12, piece());
    proptest::collection::vec(edit, 1..6).prop_map(|edits| {
        let mut chars: Vec<char> = GOOD.chars().collect();
        for (share, length, piece) in edits {
            let start = (share * chars.len() as f64) as usize;
            let end = (start + length).min(chars.len());
            chars.splice(start..end, piece.chars());
        }
        chars.into_iter().collect()
    })
}

/// The good case with whole lines removed, doubled or swapped.
fn shuffled() -> impl Strategy<Value = String> {
    let count = GOOD.lines().count();
    proptest::collection::vec((0..count, 0..3_u8), 0..6).prop_map(|edits| {
        let mut lines: Vec<&str> = GOOD.lines().collect();
        for (at, kind) in edits {
            let at = at.min(lines.len() - 1);
            match kind {
                0 if lines.len() > 1 => drop(lines.remove(at)),
                1 => lines.insert(at, lines[at]),
                _ => lines.swap(at, 0),
            }
        }
        lines.join("\n")
    })
}

fn key() -> impl Strategy<Value = String> {
    let known = [
        "motion.speed",
        "motion.creepage",
        "motion.creepage.xi",
        "motion.traction_coefficient",
        "effects.partial_slip",
        "effects",
        "mech.model",
        "mech",
        "materials.steel",
        "materials",
        "materials.*.density",
        "time.mode",
        "time",
        "output.fields",
        "case",
        "wheel.material",
        "",
        "a.b.c.d.e.f.g.h.i.j",
        "\"a.b\"",
        "limits.shared_memory",
        "thermal.command",
    ];
    prop_oneof![
        3 => (0..known.len()).prop_map(move |at| known[at].to_owned()),
        1 => ".{0,12}",
    ]
}

fn value() -> impl Strategy<Value = String> {
    let known = [
        "1",
        "-1",
        "1e999",
        "nan",
        "true",
        "{}",
        "{xi=1}",
        "[]",
        "[\"a\"]",
        "steel",
        "\"steel\"",
        "100 kN",
        "transient",
        "half-space",
        "{ a = { b = [ {} ] } }",
        "[[[[[[[[[[[[[[[1]]]]]]]]]]]]]]]",
        "2024-01-01",
        "",
        "0x1f",
        "{",
        "\"",
    ];
    prop_oneof![
        3 => (0..known.len()).prop_map(move |at| known[at].to_owned()),
        1 => ".{0,12}",
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn any_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        survive(&bytes, &[])?;
    }

    #[test]
    fn any_text(text in "[\\[\\]{}=\"'a-c.,#\n 0-9*]{0,80}") {
        survive(text.as_bytes(), &[])?;
    }

    #[test]
    fn any_mutation(text in mutated()) {
        survive(text.as_bytes(), &[])?;
    }

    #[test]
    fn any_lines(text in shuffled()) {
        survive(text.as_bytes(), &[])?;
    }

    #[test]
    fn any_options(options in proptest::collection::vec((key(), value()), 0..4), any in ".{0,24}") {
        let mut set: Vec<String> = options.iter().map(|(key, value)| format!("{key}={value}")).collect();
        survive(GOOD.as_bytes(), &set)?;
        set.push(any.clone());
        survive(GOOD.as_bytes(), &set)?;
        let mut raw = RawCase::parse("case.toml", GOOD).map_err(|e| TestCaseError::fail(e.to_string()))?;
        let keys: Vec<String> = options.into_iter().map(|(key, _)| key).chain([any]).collect();
        let _ = raw.apply(&[], &keys);
        let _ = validate(&raw, &descriptions(), &[]);
    }
}
