//! Temperatures behind the contact: the heat left on the surface by a passage.

use crate::harness::{Place, Table, case};

const CONDUCTIVITY: f64 = 50.0;
const CAPACITY: f64 = 7850.0 * 419.5;
const SPEED: f64 = 38.889;

/// Coordinates and values along the row that contains the largest value.
fn along(place: &Place, file: &str, name: &str) -> Vec<[f64; 2]> {
    let table = Table::read(&place.out().join("fields").join(file));
    table.columns(["x [m]", name])
}

/// Rise behind the contact: heat that enters at x′ leaves q/(β√(πVs)) dx′ at the distance s behind,
/// summed over the elements of the contact.
fn left_behind(heat: &[[f64; 2]], x: f64) -> f64 {
    let step = heat[1][0] - heat[0][0];
    let effusivity = (CONDUCTIVITY * CAPACITY).sqrt();
    let share = |[at, power]: &[f64; 2]| {
        0.5 * power * step / (effusivity * (std::f64::consts::PI * SPEED * (at - x)).sqrt())
    };
    heat.iter().map(share).sum()
}

#[test]
fn the_surface_behind_the_contact_cools_as_what_has_entered_spreads() {
    for model in ["columns", "moving-source"] {
        let model = format!("thermal.model={model}");
        let contact = Place::new();
        let narrow = contact.summary(&case("wheel-rail.toml"), &["--set", &model]);
        let place = Place::new();
        let more = ["--set", &model, "--set", "thermal.wake=40 mm"];
        let summary = place.summary(&case("wheel-rail.toml"), &more);
        let peak =
            |summary: &serde_json::Value| summary["temperature"]["rail"]["max_rise_k"].as_f64();
        let [wide, narrow] = [&summary, &narrow].map(|one| peak(one).unwrap());
        assert!((wide / narrow - 1.0).abs() < 1e-9, "{model}: {wide} K beside {narrow} K");
        let heat = along(&place, "mech_passage_000000.csv", "friction_power [W/m2]");
        let rail = along(&place, "thermal_contact_000000.csv", "rail_temperature [K]");
        let first = rail[0][0];
        assert!((-0.0402..-0.0398).contains(&first), "{first}");
        for [x, rise] in rail.iter().filter(|[x, _]| *x < -0.012) {
            // More than half the length of the contact behind it; conduction along and across is of
            // order 1/Pe.
            let expected = left_behind(&heat, *x);
            assert!(
                (rise / expected - 1.0).abs() < 2e-3,
                "{model}: {rise} K at {x} m, not {expected}"
            );
        }
    }
}

#[test]
fn a_wake_without_end_is_refused() {
    let place = Place::new();
    let ended = place.run(&case("wheel-rail.toml"), &["--set", "thermal.wake=1 km"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("make it shorter"), "{}", ended.stderr);
}
