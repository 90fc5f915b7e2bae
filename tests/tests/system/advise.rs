//! `coordinator plan CASE --advise`: importance of each effect, estimated before a run.

use crate::harness::{Place, case};
use proto::model::Solver;

fn advice(place: &Place, name: &str, more: &[&str]) -> String {
    let file = case(name);
    let mut arguments = vec!["plan", &file, "--advise"];
    arguments.extend(more);
    let ended = place.start(&arguments).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    place.assert_nothing_left();
    let (_, advice) = ended.stdout.split_once("\nadvice ").expect("a section of advice");
    advice.to_owned()
}

/// Line of an effect, with its state.
#[track_caller]
fn line<'a>(advice: &'a str, effect: &str) -> &'a str {
    let of = |line: &&str| line.split_whitespace().nth(1) == Some(effect);
    advice.lines().find(of).unwrap_or_else(|| panic!("{effect} in {advice}"))
}

/// Every registered effect has a line, whether in the case or not. Important effects come first,
/// with the setting that adds them and the cost.
#[test]
fn every_effect_is_spoken_of() {
    let advice = advice(&Place::new(), "wheel-rail.toml", &[]);
    for description in
        [mech_solver::MechSolver.description(), thermal_solver::ThermalSolver.description()]
    {
        for effect in &description.effects {
            line(&advice, &effect.name);
        }
    }
    assert!(line(&advice, "friction_heat").contains("on  friction_heat"), "{advice}");
    assert!(line(&advice, "speed_friction").contains("has no result"), "{advice}");
    assert!(
        line(&advice, "thermal_expansion").contains("hardly matters: maximum pressure"),
        "{advice}"
    );
    assert!(line(&advice, "plasticity").contains("not estimated"), "{advice}");
    let at = |text: &str| advice.find(text).unwrap_or_else(|| panic!("{text} in {advice}"));
    assert!(at("friction_heat") < at("roughness") && at("roughness") < at("convection"));
    assert!(advice.contains("--set materials.steel.thermal_expansion=1.2e-5"), "{advice}");
    assert!(advice.contains("and iterates") && advice.contains("does not support it"), "{advice}");
}

/// The thermal solver takes no part in free rolling, but still advises that heat is insignificant.
#[test]
fn free_rolling_needs_no_heat() {
    let rolls = ["--unset", "effects.friction_heat", "--set", "motion.traction_coefficient=0.001"];
    let advice = advice(&Place::new(), "wheel-rail.toml", &rolls);
    for effect in ["friction_heat", "bulk_heating", "convection", "temperature_material"] {
        let line = line(&advice, effect);
        assert!(line.contains("off") && line.contains("does not matter"), "{line}");
    }
}
