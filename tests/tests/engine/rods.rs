//! Barber's rod: growth and decay of disturbances.

use crate::harness::{Place, case, sets};

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
