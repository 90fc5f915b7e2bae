//! The figures that a run has to print: PHYSICS §2 and §3 through the whole of three processes.

use crate::harness::{Place, case};
use serde_json::Value;

/// The contact ellipse of the paper's Table 2.
const TABLE_2: [&str; 6] = [
    "--set",
    "contact.semi_axis_a=7.98 mm",
    "--set",
    "contact.semi_axis_b=6.01 mm",
    "--set",
    "contact.max_pressure=1352 MPa",
];

fn number(summary: &Value, pointer: &str) -> f64 {
    let value = summary.pointer(pointer).and_then(Value::as_f64);
    value.unwrap_or_else(|| panic!("{pointer} is missing in {summary}"))
}

fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) {
    let off = (found - expected).abs();
    assert!(off <= tolerance, "{what}: {found}, expected {expected} ± {tolerance}");
}

/// PHYSICS §3, third column; 0.2 % is the rounding of the table and the grid's error together.
#[test]
fn carter_strips_on_table_2() {
    let rows = [
        (0.58, 298.2, -0.829, -0.01149),
        (0.50, 209.0, -0.857, -0.00832),
        (0.40, 137.8, -0.886, -0.00594),
        (0.20, 44.3, -0.943, -0.00258),
    ];
    for (traction, rise, place_over_a, creepage) in rows {
        let place = Place::new();
        let traction = format!("motion.traction_coefficient={traction}");
        let mut more = TABLE_2.to_vec();
        more.extend(["--set", "mech.model=hertz-carter"]);
        more.extend(["--set", "motion.creep_law=carter-pressure", "--set", &traction]);
        let summary = place.summary(&case("wheel-rail.toml"), &more);
        let rail = number(&summary, "/temperature/rail/max_rise_k");
        assert_close(rail, rise, 2e-3 * rise, "rail peak");
        let at = number(&summary, "/temperature/rail/x_over_a");
        assert_close(at, place_over_a, 5e-3, "its place");
        // The table gives five decimals.
        assert_close(number(&summary, "/contact/creepage_xi"), creepage, 5e-6, "creepage");
        let wheel = number(&summary, "/temperature/wheel/max_rise_k");
        assert!(wheel < rail, "the driving wheel's surface is the faster one");
        assert!(number(&summary, "/coupling/energy_imbalance") <= 1e-12);
        let power = number(&summary, "/contact/friction_power_w");
        let of_creepage = -38.889
            * number(&summary, "/contact/creepage_xi")
            * number(&summary, "/contact/creep_force_x_n");
        assert_close(power, of_creepage, 1e-9 * power, "friction power = V·ξ·F (rounding)");
    }
}

/// The tolerance is that of the reference figures' own digits.
#[test]
fn hertz_patch_of_the_shipped_case() {
    let summary = Place::new().summary(&case("wheel-rail.toml"), &[]);
    let figures = [
        ("/contact/semi_axis_a_m", 7.8956e-3),
        ("/contact/semi_axis_b_m", 5.9392e-3),
        ("/contact/max_pressure_pa", 1364.38e6),
        ("/contact/approach_m", 126.551e-6),
        ("/contact/normal_force_n", 134e3),
    ];
    for (pointer, expected) in figures {
        assert_close(number(&summary, pointer), expected, 1e-4 * expected, pointer);
    }
    assert_eq!(summary["status"], "completed");
    assert_eq!(summary["schema"], 1);
    assert_eq!(summary["coupling"]["iterations"], 1);
    assert_eq!(summary["effects"]["active"], serde_json::json!(["friction_heat", "partial_slip"]));
}

/// PHYSICS §2: the paper's own inputs through its own formulas, and through the exact ellipse.
/// Tolerances: the last digit of the reference figures.
#[test]
fn full_slip_by_polynomial_and_by_columns() {
    let rows = [("ertz-knothe", 261.9, -0.647), ("columns", 260.9, -0.652)];
    for (model, rise, place_over_a) in rows {
        let model = format!("thermal.model={model}");
        let summary = Place::new().summary(&case("full-slip.toml"), &["--set", &model]);
        assert_close(number(&summary, "/temperature/rail/max_rise_k"), rise, 0.06, &model);
        assert_close(number(&summary, "/temperature/rail/x_over_a"), place_over_a, 1e-3, &model);
        assert!(number(&summary, "/coupling/energy_imbalance") <= 1e-12);
    }
}

/// Rolling on from cold over 5 a: the steady field is reached when the contact has once passed
/// over its own length, 2 a; from then on the two differ by rounding only.
#[test]
fn a_cold_start_reaches_the_steady_peak() {
    let transient = Place::new().summary(&case("cold-start.toml"), &[]);
    let steady = ["--unset", "time", "--unset", "output"];
    let steady = Place::new().summary(&case("cold-start.toml"), &steady);
    let peak = |summary| number(summary, "/temperature/rail/max_rise_k");
    assert_close(peak(&transient), peak(&steady), 1e-9 * peak(&steady), "steady peak");
    assert!(number(&transient, "/coupling/energy_imbalance") <= 1e-12);
    assert_eq!(transient["coupling"]["windows"], 51);
}

/// Before the contact has passed over its own length it is colder.
#[test]
fn a_cold_start_is_cold_at_first() {
    let short = Place::new().summary(&case("cold-start.toml"), &["--set", "time.end=100 us"]);
    let long = Place::new().summary(&case("cold-start.toml"), &[]);
    let peak = |summary| number(summary, "/temperature/rail/max_rise_k");
    assert!(peak(&short) < 0.8 * peak(&long), "{} against {}", peak(&short), peak(&long));
}

#[test]
fn the_two_creep_laws_differ_as_they_must() {
    let creepage = |law: &str| {
        let law = format!("motion.creep_law={law}");
        let mut more = TABLE_2.to_vec();
        more.extend(["--set", &law]);
        number(&Place::new().summary(&case("wheel-rail.toml"), &more), "/contact/creepage_xi")
    };
    // 1.149 % and 0.851 %: the paper's equation 18 equates the two.
    assert_close(creepage("carter-pressure"), -0.011494, 1e-6, "carter-pressure");
    assert_close(creepage("carter-radius"), -0.008508, 1e-6, "carter-radius");
}

/// Equal materials: the partition by effusivity differs from one half only by the surface speeds.
#[test]
fn partition_by_effusivity_gives_the_faster_body_more() {
    let more = ["--set", "effects.friction_heat.partition=effusivity"];
    let summary = Place::new().summary(&case("wheel-rail.toml"), &more);
    let rail = number(&summary, "/temperature/rail/max_rise_k");
    let wheel = number(&summary, "/temperature/wheel/max_rise_k");
    // With this share both surfaces have the same temperature everywhere; the tolerance is rounding.
    assert_close(rail, wheel, 1e-9 * rail, "rail and wheel");
}
