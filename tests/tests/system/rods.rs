//! Barber's rod: several steady states, their stability, and growth or decay of disturbances.

use crate::harness::{Place, case, sets};
use serde_json::Value;

const CONDUCTIVITY: f64 = 50.0;
const DIFFUSIVITY: f64 = CONDUCTIVITY / (7850.0 * 419.5);
const EXPANSION: f64 = 1.2e-5;
const LENGTH: f64 = 0.1;
const JUMP: f64 = 1e-6;
/// Gap plus jump distance at which the gas conducts as well as the rod [m].
const MATCHED: f64 = 0.026 * LENGTH / CONDUCTIVITY;

/// Growth rate of a disturbance, times L²/κ, about the steady state in which the gas conducts as
/// well as the rod; `gain` is the gain δ of the loop.
fn growth(gain: f64, window: f64) -> f64 {
    // δ = B α ΔT L/(2(1 + B)(g + j)) with B = 1.
    let across = 4.0 * gain * MATCHED / (EXPANSION * LENGTH);
    let gap = MATCHED - JUMP + 0.5 * EXPANSION * across * LENGTH;
    let seconds = LENGTH * LENGTH / DIFFUSIVITY;
    let windows = (0.5 / window).round();
    let settings = [
        format!("bodies.wall.initial_temperature={:?}", 293.15 + 2.0 * across),
        format!("bodies.rod.start_rise={:?}", across * (1.0 + 1e-6)),
        format!("mech.gap={gap:?}"),
        format!("time.window={:?}", window * seconds),
        format!("time.end={:?}", windows * window * seconds),
        "time.mode=transient".to_owned(),
        "coupling.relative=1e-14".to_owned(),
        "output.fields=none".to_owned(),
    ];
    let settings: Vec<&str> = settings.iter().map(String::as_str).collect();
    let place = Place::new();
    place.summary(&case("thermo-elastic-rod.toml"), &sets(&settings));
    let rows = place.table("history.csv").numbers("temperature.rod.max_rise_k");
    // Mean over the last third, where higher modes have decayed.
    let (first, last) = (rows[2 * rows.len() / 3], rows[rows.len() - 1]);
    let ratio = (last - across) / (first - across);
    ratio.ln() / (window * (rows.len() - 1 - 2 * rows.len() / 3) as f64)
}

/// Leading rates at δ = 0.96 and 1.02, from λ cosh λ + B sinh λ = 2δ(1 + B)(cosh λ − 1)/λ with B =
/// 1 and b = λ², to 0.1 %. Their error is of first order in the window. Near δ = 1 it is some fifty
/// times bΔt/2: the delay of the loop by half a window, over 1 − δ.
#[test]
fn disturbances_grow_and_decay_at_the_leading_rates() {
    for (gain, expected) in [(0.96, -0.160_143_570_7), (1.02, 0.079_964_610_8)] {
        let [coarse, fine] = [4e-3, 5e-4].map(|window| growth(gain, window) / expected - 1.0);
        println!(
            "gain {gain}: rate {:.6}, errors {coarse:.2e}, {fine:.2e}",
            expected * (1.0 + fine)
        );
        assert!(fine.abs() < 1e-3, "{gain}: {fine}");
        assert!((coarse / fine - 8.0).abs() < 2.0, "{gain}: {coarse} {fine}");
    }
}

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
