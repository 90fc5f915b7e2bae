//! Periodic contacts, against closed forms.

use super::common::{configuration, refusal, run};
use serde_json::{Value, json};
use std::f64::consts::PI;

const MODULUS: f64 = 210e9;
const WAVELENGTH: f64 = 1e-3;
/// Sum of the compliances of both bodies [1/Pa].
const COMPLIANCE: f64 = 2.0 * 0.91 / MODULUS;
const AMPLITUDE: f64 = 1e-6;

/// Two flat bodies, one of them wavy, with one wave in a cell one millimetre wide.
fn wavy(mean_pressure: f64, resolution: usize) -> Value {
    let body = |position: &str| json!({"position": position, "material": "steel"});
    json!({
        "bodies": {"block": body("upper"), "plate": body("lower")},
        "materials": {"steel": {"youngs_modulus": MODULUS, "poisson_ratio": 0.3}},
        "motion": {"speed": 2.0, "creepage": {"xi": 0.03, "eta": 0.04}},
        "load": {"normal_force": mean_pressure * WAVELENGTH * 1e-3},
        "friction": {"coefficient": 0.2},
        "mech": {"model": "periodic", "period_x": WAVELENGTH, "period_y": 1e-3, "resolution": resolution},
        "effects": {"friction_heat": {}, "roughness": {"amplitude": AMPLITUDE, "wavelength_x": WAVELENGTH}},
    })
}

/// Mean pressure that closes the wave, π E* h/λ.
fn closing() -> f64 {
    PI * AMPLITUDE / (COMPLIANCE * WAVELENGTH)
}

/// Westergaard's wave: a share 2a/λ touches under p̄ = p* sin²(πa/λ), and the largest pressure is
/// 2p̄/sin(πa/λ). Tolerances: the edge of the contact is known to one element, and the pressure at
/// the element centres.
#[test]
fn a_wave_that_is_pressed_in_part() {
    for share in [0.25, 0.5, 0.75_f64] {
        let sine = (0.5 * PI * share).sin();
        let mean = closing() * sine * sine;
        let mut errors = Vec::new();
        for resolution in [16, 64, 256] {
            let run = run(&wavy(mean, resolution));
            let element = 1.0 / resolution as f64;
            assert!((run.number("area_ratio") - share).abs() < 2.0 * element, "{share}");
            errors.push(run.number("max_pressure_pa") * sine / (2.0 * mean) - 1.0);
        }
        println!("{share} touches: {errors:.6?}");
        // Second order at least; a quarter of sixteen elements is four.
        let within = errors.iter().zip([0.02, 1e-3, 1e-4]).all(|(error, most)| error.abs() < most);
        assert!(within, "{share}: {errors:?}");
    }
}

/// Full contact: the pressure is p̄ − p* cos(2πx/λ) to rounding, since a wave of the grid is exact.
/// The traction is f p against the slip, and its power is that of the force.
#[test]
fn a_wave_that_is_pressed_flat() {
    let mean = 1.5 * closing();
    let run = run(&wavy(mean, 16));
    let grid = run.grid().as_structured().unwrap();
    for (at, pressure) in run.fields["pressure"].iter().enumerate() {
        let expected = mean - closing() * (2.0 * PI * grid.x(at) / WAVELENGTH).cos();
        assert!((pressure / expected - 1.0).abs() < 1e-8, "{at}: {pressure} {expected}");
    }
    assert_eq!(run.number("area_ratio"), 1.0);
    assert!(run.number("separation_m").abs() < 1e-15);
    assert!((run.number("pressure_deviation_pa") / (closing() / 2_f64.sqrt()) - 1.0).abs() < 1e-8);
    let (load, speed) = (run.number("normal_force_n"), 2.0 * 0.05);
    assert!((run.number("friction_power_w") / (0.2 * load * speed) - 1.0).abs() < 1e-12);
    assert!((run.number("creep_force_x_n") / (-0.2 * load * 0.6) - 1.0).abs() < 1e-12);
    assert!((run.number("creep_force_y_n") / (-0.2 * load * 0.8) - 1.0).abs() < 1e-12);
    let sum: f64 = run.fields["friction_power"].iter().sum();
    let area = grid.element_area();
    assert!((sum * area / run.number("friction_power_w") - 1.0).abs() < 1e-12);
}

/// Under a light load the tops of waves along both directions are separate paraboloids of the
/// radius λ²/(4π²h), with Hertz's pressure and load. Tolerance: elements at the edge, and the shape
/// of the top away from its middle.
#[test]
fn tops_under_a_light_load_are_hertzian() {
    let mut case = wavy(1.0, 256);
    case["effects"]["roughness"]["wavelength_y"] = json!(1e-3);
    case["mech"]["lateral_resolution"] = json!(256);
    // Half of the wave's amplitude is above the plane: cos cos has two tops in a cell.
    let curvature = (2.0 * PI / WAVELENGTH).powi(2) * AMPLITUDE;
    let radius: f64 = 0.06e-3;
    let pressure = 2.0 * radius * curvature / (PI * COMPLIANCE);
    let load = 2.0 * (2.0 / 3.0) * PI * radius * radius * pressure;
    case["load"]["normal_force"] = json!(load);
    let run = run(&case);
    let found = run.number("max_pressure_pa") / pressure;
    assert!((found - 1.0).abs() < 0.02, "{found}");
    let area = run.number("area_m2") / (2.0 * PI * radius * radius);
    assert!((area - 1.0).abs() < 0.08, "{area}");
}

/// Below a limit of the pressure the cell carries its load, from light contact to nearly every
/// element at the limit. Tolerance: the search of the approach. A load that the limit cannot carry
/// is refused.
#[test]
fn a_limited_pressure_carries_the_load() {
    let limit = 400e6;
    let limited = |mean: f64| {
        let mut case = wavy(mean, 64);
        case["effects"]["pressure_limit"] = json!({"hardness": limit});
        case
    };
    for share in [0.01, 0.2, 0.45, 0.9, 0.999] {
        let run = run(&limited(share * limit));
        let sum = run.fields["pressure"].iter().sum::<f64>() / 64.0;
        assert!((sum / (share * limit) - 1.0).abs() < 2e-9, "{share}: {sum}");
        assert!(run.fields["pressure"].iter().all(|p| (0.0..=limit).contains(p)), "{share}");
        let (load, separation) = (run.number("normal_force_n"), run.number("separation_m"));
        assert!((run.number("creep_force_x_n") / (-0.2 * load * 0.6) - 1.0).abs() < 1e-9);
        assert!((0.0..AMPLITUDE).contains(&separation), "{separation}");
        assert_eq!(run.number("limited_area_ratio") > 0.0, share > 0.3, "{share}");
    }
    for share in [1.0, 50.0] {
        let refused = refusal(&configuration(&limited(share * limit)));
        assert_eq!(refused.key, "load.normal_force");
        assert!(refused.reason.contains("effects.pressure_limit allows less than 400.00 MPa"));
    }
}

/// A self-affine surface is periodic like the contact.
#[test]
fn roughness_repeats() {
    let mut case = wavy(1e6, 64);
    case["mech"]["lateral_resolution"] = json!(64);
    case["effects"]["roughness"] =
        json!({"rms_height": 1e-7, "longest_wavelength": 0.5e-3, "shortest_wavelength": 0.1e-3});
    let run = run(&case);
    assert!(run.number("area_ratio") > 0.0 && run.number("area_ratio") < 1.0);
    case["effects"]["roughness"]["longest_wavelength"] = json!(1e-2);
    let refused = refusal(&configuration(&case));
    assert_eq!(refused.key, "effects.roughness.longest_wavelength");
    let mut odd = wavy(1e6, 64);
    odd["effects"]["roughness"]["wavelength_x"] = json!(0.7e-3);
    assert_eq!(refusal(&configuration(&odd)).key, "effects.roughness.wavelength_x");
    // Each direction has its own period: the wave is as long as the cell, which is half as wide.
    let mut narrow = wavy(1e6, 64);
    narrow["mech"]["period_y"] = json!(0.5e-3);
    assert!(super::common::run(&narrow).number("area_ratio") < 1.0);
}

#[test]
fn what_a_contact_that_repeats_does_not_have_is_refused() {
    let change = |path: &[&str], value: Value| {
        let mut case = wavy(1e6, 64);
        path.iter().fold(&mut case, |at, key| &mut at[*key]).clone_from(&value);
        refusal(&configuration(&case)).key
    };
    assert_eq!(change(&["bodies", "plate", "radius_x"], json!(1.0)), "bodies.plate.radius_x");
    assert_eq!(change(&["load"], json!({"approach": 1e-6})), "load.approach");
    assert_eq!(change(&["motion", "creepage"], json!({"phi": 0.1, "xi": 0.0})), "motion.drive");
    assert_eq!(change(&["mech", "resolution"], json!(63)), "mech.resolution");
}
