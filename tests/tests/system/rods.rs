//! Barber's rod: several steady states and their stability.

use crate::harness::{Place, case, sets};
use serde_json::Value;

const CONDUCTIVITY: f64 = 50.0;
const EXPANSION: f64 = 1.2e-5;
const LENGTH: f64 = 0.1;
const JUMP: f64 = 1e-6;
/// Gap plus jump distance at which the gas conducts as well as the rod [m].
const MATCHED: f64 = 0.026 * LENGTH / CONDUCTIVITY;

/// Three steady states of the shipped case, with gaps that solve g₀ − g = ½ αL(T_w − T₀) B/(1 + B),
/// where B = kL/(K(g + j)), and with the gains of their loops. The middle state is unstable: a rod
/// released near it moves to the others.
#[test]
fn states_are_found_with_their_stability() {
    let place = Place::new();
    let out = place.out().display().to_string();
    let file = case("thermo-elastic-rod.toml");
    let start = "bodies.rod.start_rise=0..330/12";
    let ended = place.start(&["states", &file, "--start", start, "--out", &out]).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    place.assert_nothing_left();
    let study = std::fs::read_to_string(place.out().join("states.json")).unwrap();
    let study: Value = serde_json::from_str(&study).unwrap();
    let states = study["states"].as_array().unwrap();
    assert_eq!(states.len(), 3, "{study}");
    let rise = 0.5 * EXPANSION * LENGTH * 333.0;
    // (g₀ − g)(g + j + kL/K) = rise · kL/K.
    let (free, matched) = (156e-6 + JUMP, MATCHED);
    let half = 0.5 * (free - matched);
    let root = (half * half + matched * (free - rise)).sqrt();
    let mut found = Vec::new();
    for (state, whole) in states[..2].iter().zip([half + root, half - root]) {
        let gap = state["values"]["contact.gap_m"].as_f64().unwrap();
        assert!((gap / (whole - JUMP) - 1.0).abs() < 1e-4, "{gap} {whole}");
        let biot = matched / whole;
        let gain = biot * rise / ((1.0 + biot).powi(2) * whole);
        let measured = state["loop_gain"].as_f64().unwrap();
        assert!((measured / gain - 1.0).abs() < 0.01, "{measured} {gain}");
        assert_eq!(state["stable"], gain < 1.0);
        found.push(gap);
    }
    assert_eq!(
        (states[2]["stable"].as_bool(), states[2]["loop_gain"].as_f64()),
        (Some(true), Some(0.0))
    );
    assert!(states[2]["values"]["contact.max_pressure_pa"].as_f64().unwrap() > 0.0);
    let page = std::fs::read_to_string(place.out().join("report.html")).unwrap();
    assert!(page.contains("unstable"), "{page}");
    let unstable = states[1]["values"]["temperature.rod.max_rise_k"].as_f64().unwrap();
    let times = ["time.mode=transient", "time.window=20", "time.end=8000", "output.fields=none"];
    for (factor, opens) in [(0.99, true), (1.01, false)] {
        let beside = format!("bodies.rod.start_rise={}", unstable * factor);
        let summary = Place::new().summary(&file, &sets(&[&times[..], &[&beside]].concat()));
        let gap = summary["contact"]["gap_m"].as_f64().unwrap();
        let expected = if opens { found[0] } else { 0.0 };
        assert!((gap - expected).abs() < 0.01 * found[0], "{factor}: {gap} {expected}");
    }
}

/// The message about a case with a single state says why.
#[test]
fn a_case_without_a_loop_has_one_state() {
    let place = Place::new();
    let start = "load.normal_force=1e4..2e4/3";
    let ended = place.start(&["states", &case("wheel-rail.toml"), "--start", start]).wait();
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("close no feedback loop"), "{}", ended.stderr);
}
