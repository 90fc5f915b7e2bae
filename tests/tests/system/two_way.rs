//! Physics that closes a loop: friction that falls with temperature.

use crate::harness::{Place, case, completed, number, sets};
use serde_json::Value;

fn run(settings: &[&str]) -> Value {
    completed("falling-friction.toml", settings).1
}

/// The loop's gain is above one: what goes in comes back larger, and turned. Plain iteration ends in a
/// cycle between cold and hot, and says so.
#[test]
fn plain_iteration_diverges_and_is_told() {
    let place = Place::new();
    let ended = place.run(&case("falling-friction.toml"), &["--set", "coupling.acceleration=none"]);
    assert_eq!(ended.code, Some(3), "{}", ended.stderr);
    assert!(ended.stderr.contains("diverged in window 0"), "{}", ended.stderr);
    place.assert_nothing_left();
}

/// Aitken's and the quasi-Newton method find the same state, to the tolerance asked for times the
/// gain; the counts are bounds on the work.
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

/// Friction that does not fall gives what a case without the effect gives. Tolerance: that of the
/// tractions, which a loop is asked to settle further.
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

/// A steady rolling contact that slips in part only, with a prescribed force: the loop is found too.
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

/// A contact that cannot carry its force at the temperatures that it has: the iteration settles with
/// all of it slipping, which is no solution, and the run says so with the window and both forces. It
/// ended with the first iterate beyond f N before, as if that had been the state.
fn refused_where_it_would_be_accepted(model: &str) {
    let place = Place::new();
    let settings = [model, "mech.resolution=10", "motion.traction_coefficient=0.5"];
    let more = sets(&settings);
    let ended = place.run(&case("falling-friction.toml"), &more);
    assert_eq!(ended.code, Some(1), "{model}: {}", ended.stderr);
    for part in [
        "mech (mech-solver) failed while accepting window 0",
        "window 0 has no answer: the contact is too hot for the force",
        "of 67.000 kN that are prescribed friction carries",
    ] {
        assert!(ended.stderr.contains(part), "`{part}` is missing in: {}", ended.stderr);
    }
    place.assert_nothing_left();
}

table_of_tests! { refused_where_it_would_be_accepted:
    strips_too_hot_for_their_force_are_refused("mech.model=hertz-carter");
    half_spaces_too_hot_for_their_force_are_refused("mech.model=half-space");
}

/// A table that ends below the temperature is refused, unless the case says what holds beyond.
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
