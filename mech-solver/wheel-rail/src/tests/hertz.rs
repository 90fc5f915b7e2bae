//! A cylinder on a crown, against Hertz.

use super::{arc, elements, line, rolling, single, solve, steel};
use crate::outline::Outline;
use crate::settings::Vertical;
use crate::wheelset::Motion;
use elastic::hertz::elliptic_contact;

/// Tolerances: the elements, 12 on the shorter semi-axis, and the fourth order of circles,
/// (a/R)²/4.
#[test]
fn a_cylinder_on_a_crown_is_hertzs_contact() {
    let (radius, crown, load) = (0.46, 0.3, 80e3);
    let rail = Outline::new(&arc(0.0, crown, 0.08, 60), 0.0).unwrap();
    let middle = 0.5 * rail.range()[1];
    let rail = rail.starting_at(middle);
    let hertz = elliptic_contact(0.5 / radius, 0.5 / crown, load, steel().contact_compliance());
    let wheel = line(30e-3);
    let mut pair = single([&wheel, &rail], radius, elements(hertz.semi_axis_b / 12.0));
    let solved = solve(&mut pair, &rolling(0.0, 0.0, 0.0), Vertical::Force(load));
    let patch = &solved.patches[0];
    assert_eq!(solved.patches.len(), 1);
    assert!((solved.force[2] / load - 1.0).abs() < 1e-5);
    assert!((patch.max_pressure / hertz.max_pressure - 1.0).abs() < 2e-3, "{}", patch.max_pressure);
    assert!((patch.approach / hertz.approach - 1.0).abs() < 2e-3, "{}", patch.approach);
    let area = std::f64::consts::PI * hertz.semi_axis_a * hertz.semi_axis_b;
    assert!((patch.area / area - 1.0).abs() < 3e-3, "{}", patch.area / area);
    assert!((solved.z + patch.approach).abs() < 1e-9);
    // A cylinder that rolls with the speed of its rim has no creepage and no tangential force.
    assert!(patch.rolling.creepage.iter().all(|c| c.abs() < 1e-12), "{:?}", patch.rolling);
    assert!(patch.load.force[0].abs() < 1e-6 * load && patch.friction_power.abs() < 1e-6);
    assert!((patch.rolling.speed - 2.0).abs() < 1e-12);
}

/// Faster than its rim by 1 %, to the left by 0.2 %, and turning: signs and magnitudes of all three
/// creepages.
#[test]
fn creepages_are_of_the_wheel_over_the_rail() {
    let rail = Outline::new(&arc(0.0, 0.3, 0.08, 60), 0.0).unwrap();
    let middle = 0.5 * rail.range()[1];
    let mut pair = single([&line(30e-3), &rail.starting_at(middle)], 0.46, elements(1e-3));
    let motion =
        Motion { velocity: [2.02, 4e-3, 0.0], yaw_rate: 0.1, z: -50e-6, ..rolling(0.0, 0.0, 0.0) };
    let solved = solve(&mut pair, &motion, Vertical::Height);
    let [xi, eta, phi] = solved.patches[0].rolling.creepage;
    let speed = solved.patches[0].rolling.speed;
    assert!((speed - 2.01).abs() < 1e-9, "{speed}");
    for (found, expected) in [(xi, 0.02 / 2.01), (eta, 4e-3 / 2.01), (phi, 0.1 / 2.01)] {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
    // The wheel is braked and pushed to the right.
    let force = solved.force;
    assert!(force[0] < 0.0 && force[1] < 0.0, "{force:?}");
    assert!(solved.moment_wheelset[1] > 0.0);
}
