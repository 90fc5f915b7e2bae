//! Explicit elements: a wheel that rolls on a rail until steady, as in the paper, against the
//! half-space; plastic material; hot steel.

use serde_json::Value;
use tests::harness::{Place, case, field_files, sets};

fn number(summary: &Value, pointer: &str) -> f64 {
    summary.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("no {pointer}"))
}

/// A body at a uniform temperature where stiffness and yield stress are halved equals a body with
/// half the modulus, half the yield stress and half the hardening: identical fields and figures,
/// bit for bit. The second body has no thermal expansion, so that it too continues from the cold
/// state. A flash temperature of 300 K softens the surface of hot steel by less than 1 %, because
/// elements of 3 mm average over their depth (docs/effects.md).
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

/// Elements of 1.6 mm, five per semi-axis, against the half-space at a/40: pressure, creepage and
/// hottest point. Tolerances: the first-order error at that size, measured in
/// docs/theory/explicit-fe.md. The power balance closes up to the power of damping and the error of
/// a measurement over half a semi-axis; hourglass modes contain less than 1 % of the elastic
/// energy.
#[test]
fn coarse_elements_roll_as_half_spaces_do() {
    let place = Place::new();
    let elements = place.summary(&case("wheel-rail-fe-quick.toml"), &[]);
    let other = Place::new();
    let exact = other.summary(&case("wheel-rail.toml"), &sets(&["thermal.model=columns"]));
    for (pointer, tolerance) in [
        ("/contact/max_pressure_pa", 0.04),
        ("/contact/semi_axis_a_m", 0.05),
        ("/contact/semi_axis_b_m", 0.05),
        ("/contact/normal_force_n", 1e-3),
        ("/contact/traction_coefficient", 2e-3),
        ("/contact/creepage_xi", 0.05),
        ("/temperature/rail/max_rise_k", 0.08),
    ] {
        let (one, other) = (number(&elements, pointer), number(&exact, pointer));
        println!(
            "{pointer}: {one:.6e}, half-space {other:.6e}, {:+.2} %",
            100.0 * (one / other - 1.0)
        );
        assert!((one / other - 1.0).abs() < tolerance, "{pointer}: {one} {other}");
    }
    let [friction, given] =
        ["friction", "given"].map(|name| number(&elements, &format!("/contact/{name}_power_w")));
    assert!((friction / given - 1.0).abs() < 3e-3, "{friction} {given}");
    assert!(number(&elements, "/contact/hourglass_energy_ratio") < 0.01);
}

/// Plastic material: the work of the rigid motion that friction does not dissipate goes into
/// plastic flow, except for residual stresses. A yield stress that is not reached causes no flow.
/// Tolerance: the elastic energy of residual stresses, a seventh of the plastic work with these
/// coarse elements, a twentieth with five per semi-axis.
#[test]
fn material_that_yields_takes_work_and_pressure() {
    let of = |settings: &[&str]| Place::new().summary(&case("yielding.toml"), &sets(settings));
    let (soft, hard) = (of(&[]), of(&["materials.steel.yield_stress=3000 MPa"]));
    let figure = |summary: &Value, name: &str| number(summary, &format!("/contact/{name}"));
    let [given, friction, plastic] =
        ["given", "friction", "plastic"].map(|name| figure(&soft, &format!("{name}_power_w")));
    println!("given {given:.1} W, friction {friction:.1} W, plastic {plastic:.1} W");
    assert!(plastic > friction);
    let residual = given - friction - plastic;
    assert!((0.0..0.2 * plastic).contains(&residual), "{given} {friction} {plastic}");
    assert!(figure(&soft, "max_pressure_pa") < 0.9 * figure(&hard, "max_pressure_pa"));
    assert!(figure(&soft, "max_plastic_strain") > 1e-3);
    assert_eq!(figure(&hard, "plastic_power_w"), 0.0);
}
