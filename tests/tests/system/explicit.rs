//! The paper's own method on coarse elements: a wheel that rolls on a rail until that is steady.

use crate::harness::{Place, case, sets};
use serde_json::Value;

fn number(summary: &Value, pointer: &str) -> f64 {
    summary.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("no {pointer}"))
}

/// Elements of 1.6 mm, five in a semi-axis, beside the half-space's a/40: pressure, creepage and the hottest place. Tolerances:
/// what remains of first order at that size, measured in docs/theory/explicit-fe.md; power closes to what the damping takes and
/// a measurement of half a semi-axis leaves; hourglass modes have less than a hundredth of the elastic energy.
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

/// Material that yields: what the rigid motion gives and friction does not take flows, but for residual stresses that go along;
/// a yield stress that is not reached makes nothing flow. Tolerance: the elastic energy of residual stresses, a seventh of the
/// plastic work with elements as coarse as these, a twentieth with five to a semi-axis.
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

/// Temperatures that a table does not have end the run where they arise, with what to write; shares that rise, or a table without the
/// initial temperature, are refused before it.
#[test]
fn a_table_that_does_not_suit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |lines: &str, words: &[&str]| {
        let table = folder.path().join(format!("{}.csv", words[0].len()));
        std::fs::write(&table, lines).unwrap();
        let place = Place::new();
        let table = format!("materials.steel.softening_table={}", table.display());
        let ended = place.start(&["run", &case("softening.toml"), "--set", &table]).wait();
        let said: String = ended.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_ne!(ended.code, Some(0));
        assert!(words.iter().all(|word| said.contains(word)), "{words:?}: {said}");
    };
    refused("300 1 1\n674 0.5 0.5\n", &["beyond their softening_table", "hold"]);
    refused(
        "300 0.5 1\n1500 0.6 1\n",
        &["rises with the temperature", "materials.steel.softening_table"],
    );
    refused("300 1 1\n600 0.6 1\n", &["673.15 K, at which the body begins", "materials.steel"]);
    refused("300 1 1.5\n600 0.6 1\n", &["in line 1", "above 0 and 1 at most"]);
}
