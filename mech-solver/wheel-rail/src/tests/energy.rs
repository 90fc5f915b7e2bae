//! Balance of power and momentum: the friction power equals that of the forces.

use super::{STEEL, rolling, solve, standard};
use crate::contact::WheelOnRail;
use crate::rail::Side;
use crate::settings::{RigidSlip, Settings, Vertical};
use half_space::difference::Difference;

#[test]
fn friction_takes_what_the_forces_give() {
    for difference in [Difference::Fromm, Difference::Upwind] {
        for rigid_slip in [RigidSlip::Plane, RigidSlip::Surfaces] {
            let settings = Settings::new([3e-4, 3e-4], [STEEL; 2]);
            let settings = Settings { rigid_slip, difference, ..settings };
            balance(standard(Side::Right, settings), rigid_slip == RigidSlip::Plane);
        }
    }
}

fn balance(mut pair: WheelOnRail, plane: bool) {
    let positions = [(0.0, 0.0), (-3e-3, 4e-3), (-6e-3, -2e-3), (-8.5e-3, 1e-2)];
    let mut patches = 0;
    for (y, yaw) in positions {
        let solved = solve(&mut pair, &rolling(y, 0.0, yaw), Vertical::Force(50e3));
        for patch in &solved.patches {
            let [xi, eta, phi] = patch.rolling.creepage;
            let [along, across, _] = patch.load.force;
            let moment = patch.load.moment[2] - patch.fields.pivot() * across;
            let parts =
                [xi * along, eta * across, phi * moment].map(|part| patch.rolling.speed * part);
            let exchanged: f64 = parts.iter().map(|part| part.abs()).sum();
            let given = patch.power_off_plane - parts.iter().sum::<f64>();
            assert_eq!(plane, patch.power_off_plane == 0.0);
            let off = (patch.friction_power - given).abs() / exchanged;
            assert!(off < 1e-10, "{y}: {} {given}", patch.friction_power);
            assert!(patch.friction_power > 0.0);
            patches += 1;
        }
        // The whole is the sum of its parts, in both systems of axes.
        let sum: f64 = solved.patches.iter().map(|patch| patch.force().z).sum();
        assert!((sum - solved.force[2]).abs() < 1e-9 * sum);
        let size = |force: [f64; 3]| force.iter().map(|f| f * f).sum::<f64>().sqrt();
        assert!((size(solved.force) / size(solved.force_wheelset) - 1.0).abs() < 1e-12);
    }
    assert!(patches > 3);
}
