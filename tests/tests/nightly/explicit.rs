//! Explicit elements in hot steel, three runs to their steady state.

use serde_json::Value;
use tests::harness::{Place, case, field_files, sets};

fn number(summary: &Value, pointer: &str) -> f64 {
    summary.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("no {pointer}"))
}

/// A body all of which is at a temperature at which half of the stiffness and of the yield stress are left, as at any other, is one of
/// half the modulus, half the yield stress and half the hardening: the same fields and figures to the bit. The other one expands by
/// nothing, so that it too rolls on from where it was cold. What a flash of 300 K takes of the surface of hot steel is less than a
/// hundredth, as elements of 3 mm have its mean over their depth (docs/effects.md).
#[test]
fn a_body_that_is_half_as_stiff() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("half.csv");
    std::fs::write(&table, "250 0.5 0.5\n1500 0.5 0.5\n").unwrap();
    let table = format!("materials.steel.softening_table={}", table.display());
    let (soft, stiff, hot) = (Place::new(), Place::new(), Place::new());
    let one = soft.summary(&case("softening.toml"), &["--set", &table]);
    let halves = [
        "materials.steel.youngs_modulus=105 GPa",
        "materials.steel.yield_stress=300 MPa",
        "materials.steel.kinematic_hardening=5 GPa",
        "materials.steel.thermal_expansion=0",
        "effects.thermal_expansion={}",
    ];
    let off = ["--unset", "effects.thermal_softening"].map(str::to_owned);
    let more: Vec<String> = sets(&halves).iter().map(ToString::to_string).chain(off).collect();
    let more: Vec<&str> = more.iter().map(String::as_str).collect();
    let other = stiff.summary(&case("softening.toml"), &more);
    assert_eq!(field_files(&soft.out()), field_files(&stiff.out()));
    for name in ["max_pressure_pa", "friction_power_w", "max_plastic_strain", "approach_m"] {
        assert_eq!(one["contact"][name], other["contact"][name], "{name}");
    }
    assert_eq!(one["contact"]["least_stiffness_share"], 1.0);
    let warm = hot.summary(&case("softening.toml"), &[]);
    let left = number(&warm, "/contact/least_stiffness_share");
    let rise = number(&warm, "/temperature/rail/max_rise_k");
    println!("{rise:.1} K, {left:.5} of the stiffness is left");
    assert!((0.99..1.0).contains(&left) && rise > 250.0);
    assert!(
        number(&warm, "/contact/max_pressure_pa") > 1.3 * number(&one, "/contact/max_pressure_pa")
    );
}
