//! Physics that closes a loop: friction that falls with temperature.

use crate::harness::{Place, case, completed, number, sets};
use serde_json::Value;

fn run(settings: &[&str]) -> Value {
    completed("falling-friction.toml", settings).1
}

/// The gain of the loop is below −1: a disturbance returns larger and with the opposite sign. Plain
/// iteration ends in a cycle between cold and hot, and the run reports it.
#[test]
fn plain_iteration_diverges_and_is_told() {
    let place = Place::new();
    let ended = place.run(&case("falling-friction.toml"), &["--set", "coupling.acceleration=none"]);
    assert_eq!(ended.code, Some(3), "{}", ended.stderr);
    assert!(ended.stderr.contains("diverged in window 0"), "{}", ended.stderr);
}

/// Aitken's and the quasi-Newton method find the same state, to the tolerance times the gain. The
/// iteration counts are upper bounds.
#[test]
fn accelerated_iterations_agree() {
    for model in ["mech.model=hertz-carter", "mech.model=half-space"] {
        let of = |method: &str, most: u64| {
            let method = format!("coupling.acceleration={method}");
            let summary = run(&[model, "mech.resolution=20", &method]);
            assert_eq!(summary["status"], "converged");
            let iterations = summary["coupling"]["iterations"].as_u64().unwrap();
            assert!(iterations <= most, "{model} {method}: {iterations} iterations");
            summary
        };
        let (aitken, newton) = (of("aitken", 25), of("iqn-ils", 30));
        for pointer in ["/temperature/rail/max_rise_k", "/contact/friction_power_w"] {
            let (one, other) = (number(&aitken, pointer), number(&newton, pointer));
            assert!((one / other - 1.0).abs() < 1e-8, "{model} {pointer}: {one} {other}");
        }
    }
}

/// Secant columns of the cold first window mislead the second one, in which friction already falls.
/// The default settings converge.
#[test]
fn a_cold_start_converges_with_finite_elements() {
    let time = ["time.mode=transient", "time.window=20 us", "time.end=100 us"];
    let summary = run(&[&["thermal.model=fe"], &time[..]].concat());
    assert_eq!(summary["status"], "converged");
    let iterations = summary["coupling"]["iterations"].as_u64().unwrap();
    assert!(iterations <= 60, "{iterations} iterations in 5 windows");
}

/// Constant friction gives the same result as a case without the effect. Tolerance: that of the
/// tractions, which a loop solves more accurately.
#[test]
fn constant_friction_changes_nothing() {
    for model in ["mech.model=hertz-carter", "mech.model=half-space"] {
        let with = run(&[model, "mech.resolution=20", "effects.temperature_friction.limit=0.6"]);
        let place = Place::new();
        let more = [
            "--set",
            model,
            "--set",
            "mech.resolution=20",
            "--unset",
            "effects.temperature_friction",
        ];
        let without = place.summary(&case("falling-friction.toml"), &more);
        for pointer in ["/temperature/rail/max_rise_k", "/contact/friction_power_w"] {
            let (one, other) = (number(&with, pointer), number(&without, pointer));
            assert!((one / other - 1.0).abs() < 1e-4, "{model} {pointer}: {one} {other}");
        }
    }
}

/// Steady rolling in partial slip with a prescribed force: the loop converges as well.
#[test]
fn partial_slip_with_a_prescribed_force() {
    let summary = run(&[
        "mech.model=half-space",
        "mech.resolution=16",
        "motion.traction_coefficient=0.3",
        "effects.temperature_friction.decay_temperature=400",
        "effects.temperature_friction.limit=0.2",
    ]);
    assert_eq!(summary["status"], "converged");
    assert!((number(&summary, "/contact/traction_coefficient") / 0.3 - 1.0).abs() < 1e-6);
    let power = -38.889
        * number(&summary, "/contact/creepage_xi")
        * number(&summary, "/contact/creep_force_x_n");
    assert!((number(&summary, "/contact/friction_power_w") / power - 1.0).abs() < 1e-9);
}

/// A contact that cannot transmit the prescribed force at its temperatures: the iteration converges
/// to complete sliding, which is no solution. The run reports this with the window and both forces.
/// An earlier version ended with the first iterate beyond f N and treated it as the solution.
fn refused_where_it_would_be_accepted(model: &str) {
    let place = Place::new();
    let settings = [model, "mech.resolution=10", "motion.traction_coefficient=0.5"];
    let more = sets(&settings);
    let ended = place.run(&case("falling-friction.toml"), &more);
    assert_eq!(ended.code, Some(1), "{model}: {}", ended.stderr);
    for part in [
        "mech (mech-solver) failed while accepting window 0",
        "window 0 has no answer: the contact is too hot for the force",
        "of the prescribed 67.000 kN friction carries",
    ] {
        assert!(ended.stderr.contains(part), "`{part}` is missing in: {}", ended.stderr);
    }
}

table_of_tests! { refused_where_it_would_be_accepted:
    strips_too_hot_for_their_force_are_refused("mech.model=hertz-carter");
    half_spaces_too_hot_for_their_force_are_refused("mech.model=half-space");
}

/// A temperature beyond the end of the table is rejected, unless the case defines an extrapolation.
#[test]
fn beyond_the_table() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("friction.csv");
    std::fs::write(&file, "# rise [K], friction\n0, 0.6\n50, 0.5\n").unwrap();
    let table = format!("effects.temperature_friction.table={}", file.display());
    let place = Place::new();
    let more = ["--set", table.as_str()];
    let ended = place.run(&case("falling-friction.toml"), &more);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("beyond the table"), "{}", ended.stderr);
    let clamped = run(&[&table, "effects.temperature_friction.beyond=hold"]);
    assert!((number(&clamped, "/contact/traction_coefficient") - 0.5).abs() < 0.02);
}
