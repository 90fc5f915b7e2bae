//! A wheel of finite elements turns on a radius that its load makes smaller.

use super::common::{paper, run};
use serde_json::json;

/// The creepage without a force, of bodies with these radii of rolling [m].
fn creepage(wheel: f64, rail: Option<f64>) -> f64 {
    let mut case = paper();
    case["materials"]["steel"]["density"] = json!(7850.0);
    case["bodies"]["wheel"]["radius_x"] = json!(wheel);
    if let Some(radius) = rail {
        case["bodies"]["rail"]["radius_x"] = json!(radius);
    }
    case["motion"] = json!({"speed": 38.889, "traction_coefficient": 1e-9});
    case["mech"] = json!({"model": "explicit-fe", "resolution": 3});
    run(&case).number("creepage_xi")
}

/// A wheel on a rail has to turn faster without a force, as if its radius were some of its approach
/// smaller: 18 of 117 µm, the radius being 0.46 m, with 5 and 8 elements to a semi-axis. Two like
/// rollers with the same relative curvature are each other's mirror image, and have no creepage.
/// Tolerances: half of it on grids of 3 elements, and the force, which is met to 3e-4 of f N, 2e-6 of creepage.
#[test]
fn a_pressed_wheel_turns_on_a_smaller_radius() {
    let [wheel, rollers] = [creepage(0.46, None), creepage(0.92, Some(0.92))];
    println!("wheel on rail {wheel:.3e}, like rollers {rollers:.3e}");
    assert!((-5e-5..-1.5e-5).contains(&wheel), "{wheel:e}");
    assert!(rollers.abs() < 1e-5, "{rollers:e}");
}
