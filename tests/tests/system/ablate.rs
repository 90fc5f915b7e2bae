//! `coordinator ablate`: switches off every effect of a case in turn.

use crate::cost::finished_runs;
use crate::harness::{Place, case, wait_until};
use rustix::process::Signal;
use serde_json::Value;
use std::fs;

fn study(place: &Place, name: &str, more: &[&str]) -> Value {
    let out = place.out().display().to_string();
    let file = case(name);
    let mut arguments = vec!["ablate", &file, "--out", &out];
    arguments.extend(more);
    let ended = place.start(&arguments).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    place.assert_nothing_left();
    serde_json::from_slice(&fs::read(place.out().join("ablate.json")).unwrap()).unwrap()
}

fn without<'a>(study: &'a Value, effect: &str) -> &'a Value {
    let runs = study["without"].as_array().unwrap();
    runs.iter().find(|run| run["effect"] == effect).unwrap_or_else(|| panic!("{effect}"))
}

const RISE: &str = "temperature.rail.max_rise_k";

/// If friction does not fall with temperature, the contact is hotter and one pass suffices. If
/// there is no friction heat, there is no temperature. A run without an effect equals the run of a
/// case that does not name the effect.
#[test]
fn each_effect_is_worth_what_it_changes() {
    let place = Place::new();
    let coarse = ["--set", "mech.resolution=10"];
    let study = study(&place, "falling-friction.toml", &coarse);
    let effects: Vec<&str> = study["without"]
        .as_array()
        .unwrap()
        .iter()
        .map(|run| run["effect"].as_str().unwrap())
        .collect();
    let mut expected = ["friction_heat", "partial_slip", "temperature_friction"];
    expected.sort_unstable();
    assert_eq!(
        {
            let mut effects = effects;
            effects.sort_unstable();
            effects
        },
        expected
    );
    let whole = &study["whole"];
    let constant = without(&study, "temperature_friction");
    assert!(constant["changes"][RISE].as_f64().unwrap() > 0.5, "{constant}");
    let iterations = |run: &Value| run["cost"]["iterations"].as_u64().unwrap();
    assert!(iterations(constant) == 1 && iterations(whole) > 1);
    let options = [&coarse[..], &["--unset", "effects.temperature_friction"]].concat();
    let alone = Place::new().summary(&case("falling-friction.toml"), &options);
    assert_eq!(constant["values"][RISE], alone["temperature"]["rail"]["max_rise_k"]);
    // Friction that falls with temperature needs a temperature, and the message says so.
    let cold = without(&study, "friction_heat");
    let why = cold["failed"].as_str().unwrap();
    assert!(why.contains("needs the field") && why.contains("_temperature"), "{why}");
    let page = fs::read_to_string(place.out().join("report.html")).unwrap();
    assert!(page.contains("Influence of each effect"));
}

/// A figure that disappears with its effect is not reported as a change of 100 %.
#[test]
fn a_figure_that_goes_with_an_effect_has_no_change() {
    let place = Place::new();
    let study = study(&place, "wheel-rail.toml", &["--set", "mech.resolution=10"]);
    let cold = without(&study, "friction_heat");
    assert!(cold["values"].get(RISE).is_none() && cold["changes"].get(RISE).is_none());
    assert_eq!(cold["changes"]["contact.max_pressure_pa"], 0.0);
    // Full sliding produces more heat than partial slip.
    let sliding = without(&study, "partial_slip");
    assert!(sliding["failed"].is_null(), "{sliding}");
    assert!(sliding["changes"][RISE].as_f64().unwrap() > 0.05, "{sliding}");
}

/// Advice given before a run agrees with the runs. Effects that the advice recommends to add are
/// run as well: here a third-body layer and roughness change the contact, and with falling friction
/// the force could not be transmitted.
#[test]
fn advice_is_held_against_the_runs() {
    let place = Place::new();
    let study = study(&place, "wheel-rail.toml", &["--set", "mech.resolution=20"]);
    let judged = study["advice"].as_array().unwrap();
    let of = |effect: &str| {
        judged.iter().find(|one| one["effect"] == effect).unwrap_or_else(|| panic!("{effect}"))
    };
    for effect in [
        "friction_heat",
        "partial_slip",
        "bulk_heating",
        "third_body_layer",
        "roughness",
        "temperature_friction",
    ] {
        assert_eq!(of(effect)["agrees"], true, "{}", of(effect));
    }
    let added: Vec<&str> = study["with"]
        .as_array()
        .unwrap()
        .iter()
        .map(|run| run["effect"].as_str().unwrap())
        .collect();
    assert!(added.contains(&"third_body_layer") && !added.contains(&"convection"), "{added:?}");
    let page = fs::read_to_string(place.out().join("report.html")).unwrap();
    assert!(page.contains("Advice compared with measurement"));
}

/// A stopped study keeps its finished runs, and the same command continues with them.
#[test]
fn a_study_that_is_stopped_goes_on() {
    let place = Place::new();
    let (out, file) = (place.out().display().to_string(), case("wheel-rail.toml"));
    let arguments =
        ["ablate", &file, "--out", &out, "--repeat", "1", "--set", "mech.resolution=30"];
    let running = place.start(&arguments);
    wait_until("a finished run", || !finished_runs(&place).is_empty());
    running.signal(Signal::INT);
    let ended = running.wait();
    assert_eq!(ended.code, Some(130), "{}", ended.stderr);
    let kept = finished_runs(&place);
    let told = format!("{} finished runs are kept", kept.len());
    assert!(ended.stderr.contains(&told), "{told}: {}", ended.stderr);
    // An incomplete line belongs to a run that is repeated.
    let path = place.out().join("unfinished.jsonl");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, format!("{text}{{\"options\":[\"--unset\"")).unwrap();
    let ended = place.start(&arguments).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let told = format!("{} runs of the interrupted study are reused", kept.len());
    assert!(ended.stderr.contains(&told), "{told}: {}", ended.stderr);
    let study = std::fs::read_to_string(place.out().join("ablate.json")).unwrap();
    let study: serde_json::Value = serde_json::from_str(&study).unwrap();
    assert_eq!(study["whole"]["cost"], kept[0]["spent"], "it is that very run");
    assert!(!path.exists());
    place.assert_nothing_left();
}
