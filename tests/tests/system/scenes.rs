//! Pairs of bodies that are no wheel and no rail, each against a closed form.

use crate::harness::{Place, case, sets};
use mech_solver::reference::hertz;
use std::f64::consts::PI;

/// Steel of the shipped cases: effusivity [J/(m² K √s)].
fn effusivity() -> f64 {
    (50.0_f64 * 7850.0 * 419.5).sqrt()
}

/// Sum of both bodies' compliances [1/Pa].
const COMPLIANCE: f64 = 2.0 * 0.91 / 210e9;

/// Hertz's pressure and the creepage of two speeds. Tolerances: 1 % of the pressure for the grid of 20
/// elements, rounding for the creepage.
#[test]
fn twin_disc() {
    let summary = Place::new().summary(&case("twin-disc.toml"), &[]);
    let contact = &summary["contact"];
    let [gap_x, gap_y] = [1.0 / 0.0235, 0.5 / 0.1];
    let expected = hertz::elliptic_contact(gap_x, gap_y, 2e3, COMPLIANCE);
    let pressure = contact["max_pressure_pa"].as_f64().unwrap();
    assert!((pressure / expected.max_pressure - 1.0).abs() < 0.01, "{pressure}");
    let creepage = contact["creepage_xi"].as_f64().unwrap();
    assert!((creepage + 0.01 / 1.0).abs() < 1e-15, "{creepage}");
}

/// Blok's formula, 1.11 f w |V1 - V2| / ((β√V1 + β√V2) √(2a)), in the middle of a long contact whose
/// load per length is w = π a p0/2. Tolerance 0.5 %: its factor has three digits, and the elements are
/// a twentieth of the half width.
#[test]
fn gear_flank() {
    let place = Place::new();
    place.summary(&case("gear-flank.toml"), &[]);
    let columns =
        ["contact.semi_axis_a_m", "contact.max_pressure_pa", "temperature.pinion.max_rise_k"];
    let found = super::histories::rows(&place.out().join("history.csv"), &columns);
    let table = std::fs::read_to_string(case("histories/gear.csv")).unwrap();
    let speeds: Vec<[f64; 2]> = table
        .lines()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()))
        .map(|line| {
            let cells: Vec<f64> =
                line.split(',').map(|cell| cell.trim().parse().unwrap()).collect();
            [cells[4], cells[5]]
        })
        .collect();
    assert_eq!(speeds.len(), found.len());
    let mut largest = 0.0_f64;
    for ([v1, v2], row) in speeds.iter().zip(&found) {
        let [a, p0, rise] = row[..] else { panic!("{row:?}") };
        let load = 0.5 * PI * a * p0;
        let uptake = effusivity() * (v1.sqrt() + v2.sqrt());
        let blok = 1.11 * 0.06 * load * (v1 - v2).abs() / (uptake * (2.0 * a).sqrt());
        assert!((rise - blok).abs() <= 0.005 * blok + 1e-9, "{v1} {v2}: {rise} {blok}");
        largest = largest.max(rise);
    }
    assert!(largest > 50.0, "{largest}");
}

/// One place rubbed by q0 = f p0 V/2 since the start: 2 q0 √(t/π)/β. Tolerance 0.5 %: the mean over the
/// element in the middle, and what conduction along the surface would take is left out by both.
#[test]
fn a_body_at_rest_warms_with_the_root_of_time() {
    for (name, body, speed, friction, end) in [
        ("pin-on-disc.toml", "pin", 1.0, 0.5, 400e-6),
        ("locked-wheel.toml", "wheel", 5.0, 0.1, 2e-3),
    ] {
        let summary = Place::new().summary(&case(name), &[]);
        let pressure = summary["contact"]["max_pressure_pa"].as_f64().unwrap();
        let flux = 0.5 * friction * pressure * speed;
        let expected = 2.0 * flux * (end / PI).sqrt() / effusivity();
        let rise = summary["temperature"][body]["max_rise_k"].as_f64().unwrap();
        assert!((rise / expected - 1.0).abs() < 0.005, "{name}: {rise} {expected}");
    }
}

/// Under heat without end a body at rest has no steady state in one dimension: refused, and why.
#[test]
fn a_body_at_rest_has_no_steady_state_in_columns() {
    let mut more = sets(&["time.mode=steady"]);
    for key in ["time.window", "time.end"] {
        more.extend(["--unset", key]);
    }
    for (name, body) in [("pin-on-disc.toml", "pin"), ("locked-wheel.toml", "wheel")] {
        let ended = Place::new().run(&case(name), &more);
        assert_eq!(ended.code, Some(2), "{}", ended.stderr);
        let expected = format!("bodies.{body}.surface_speed: `{body}` is at rest");
        assert!(ended.stderr.contains(&expected), "{}", ended.stderr);
        assert!(ended.stderr.contains("heated without end"), "{}", ended.stderr);
    }
}
