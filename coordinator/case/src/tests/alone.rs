//! Checks without descriptions: the coordinator's keys are checked, the others are listed.

use super::{GOOD, lines};
use crate::{Problems, RawCase, StandaloneCheck, Timing, check_without_participants};

fn alone(text: &str) -> Result<StandaloneCheck, Problems> {
    check_without_participants(&RawCase::parse("case.toml", text)?)
}

#[test]
fn the_good_case_is_good_as_far_as_can_be_checked() {
    let judged = alone(GOOD).unwrap();
    assert_eq!((judged.name.as_str(), judged.timing), ("wheel-rail", Timing::Steady));
    let roles: Vec<&str> = judged.participants.iter().map(|p| p.role.as_str()).collect();
    assert_eq!(roles, ["mech", "thermal"]);
    let expected = "wheel, rail, materials, motion, load, friction, effects.friction_heat, \
                    effects.partial_slip, mech.resolution";
    assert_eq!(judged.not_judged.join(", "), expected);
}

#[test]
fn own_keys_and_their_rules_are_judged() {
    let rows = [
        ("[mech]\nmodel = \"half-space\"", "[mech]", "mech.model: missing"),
        ("name = \"wheel-rail\"", "name = \"../x\"", "case.name: '/' is not allowed"),
        ("title = \"A test\"", "title = \"a\\u001b[2J\"", "case.title: the text `a"),
        ("title = \"A test\"", "title = \"a\\nb\"", "case.title: the text `a"),
        ("title = \"A test\"", "titel = \"a\"", "case.titel: unknown key"),
        ("[motion]", "[time]\nmode = \"transient\"\nend = 1\n[motion]", "time.window: missing"),
        ("[motion]", "[time]\nend = -1\n[motion]", "time.end: has no meaning in a steady case"),
        ("[motion]", "[coupling]\nscheme = \"x\"\n[motion]", "coupling.scheme: unknown scheme `x`"),
        ("[motion]", "[output]\nfields = \"x\"\n[motion]", "output.fields: `x` is neither"),
        ("model = \"columns\"", "model = \"c\"\ncommand = \"sh\"", "thermal.command: is the text"),
        (
            "model = \"columns\"",
            "model = \"c\"\ncommand = [\"a\\nb\"]",
            "thermal.command: the text",
        ),
    ];
    for (from, to, words) in rows {
        assert!(GOOD.contains(from), "{from}");
        let found = lines(&alone(&GOOD.replacen(from, to, 1)).expect_err(to)).join("\n");
        assert!(found.contains(words), "{to}: {found}");
        assert!(!found.contains('\u{1b}'), "{found}");
    }
    let nobody = alone("[case]\nname = \"x\"\n").unwrap_err().to_string();
    assert!(nobody.contains("the case has no participant"), "{nobody}");
}

/// A section with only a model may be a table that a participant reads: it is listed, not refused.
#[test]
fn what_only_a_participant_can_judge_is_listed() {
    let text = GOOD.replacen("[motion]", "[layer]\nmodel = \"thin\"\n[motion]", 1);
    let judged = alone(&text).unwrap();
    assert!(judged.not_judged.contains(&"layer".to_owned()), "{:?}", judged.not_judged);
    assert!(judged.participants.iter().any(|p| p.role == "layer"));
    let shown = judged.not_judged_text();
    assert!(shown.contains("the programs of layer, mech, thermal"), "{shown}");
}
