//! Invariance of the contact under changes of axes and of the path to a position.

use super::{STEEL, arc, elements, line, rolling, single, solve, standard};
use crate::interface::Constant;
use crate::outline::Outline;
use crate::patch::Solved;
use crate::rail::{Deviation, Side};
use crate::settings::{Settings, Vertical};
use crate::wheelset::Motion;

fn near(one: f64, other: f64, size: f64, tolerance: f64, what: &str) {
    assert!((one - other).abs() <= tolerance * size, "{what}: {one} {other}");
}

/// Positions from the tread to the flange.
const POSITIONS: [(f64, f64); 4] = [(0.0, 0.0), (2e-3, -5e-3), (5e-3, 1e-2), (9e-3, -1e-2)];

/// The left wheel at (y, roll, yaw) and the right one at (−y, −roll, −yaw).
#[test]
fn left_and_right_are_mirror_images() {
    let settings = Settings::new([4e-4, 4e-4], [STEEL; 2]);
    let [mut left, mut right] = [Side::Left, Side::Right].map(|side| standard(side, settings));
    for (y, yaw) in POSITIONS {
        let force = Vertical::Force(60e3);
        let one = solve(&mut left, &rolling(y, 1e-3, yaw), force);
        let other = solve(&mut right, &rolling(-y, -1e-3, -yaw), force);
        near(one.z, other.z, 1e-3, 1e-9, "z");
        for (k, sign) in [1.0, -1.0, 1.0].into_iter().enumerate() {
            near(one.force[k], sign * other.force[k], 60e3, 1e-8, "force");
            near(one.moment[k], -sign * other.moment[k], 60e3, 1e-8, "moment");
        }
        assert_eq!(one.patches.len(), other.patches.len());
        for (a, b) in one.patches.iter().zip(other.patches.iter().rev()) {
            near(a.frame.angle, -b.frame.angle, 1.0, 1e-9, "angle");
            near(a.friction_power, b.friction_power, 1e3, 1e-7, "power");
            assert_eq!(a.frame.element[1], -b.frame.element[1]);
            let [nx, ny] = a.fields.counts;
            for j in 0..ny {
                for i in 0..nx {
                    let (here, there) = (j * nx + i, (ny - 1 - j) * nx + i);
                    near(a.fields.pressure[here], b.fields.pressure[there], 1e9, 1e-7, "p");
                    let [along, across] = [0, 1].map(|k| &a.fields.traction[k][here]);
                    near(*along, b.fields.traction[0][there], 1e9, 1e-6, "px");
                    near(*across, -b.fields.traction[1][there], 1e9, 1e-6, "py");
                }
            }
        }
    }
}

/// Rail and wheelset turned together about the origin of the track, up to the inclination of a
/// flank.
#[test]
fn a_turned_pair_has_the_same_contact() {
    let rail = Outline::new(&arc(0.0, 60e-3, 0.4, 80), 0.0).unwrap();
    let middle = 0.5 * rail.range()[1];
    let rail = rail.starting_at(middle);
    let wheel = line(30e-3);
    let upright =
        Motion { y: 1e-3, z: -40e-6, velocity: [2.0, 3e-3, 0.0], ..rolling(0.0, 0.02, 5e-3) };
    let mut pair = single([&wheel, &rail], 0.4, elements(3e-4));
    let straight = solve(&mut pair, &upright, Vertical::Height);
    for angle in [0.3_f64, -1.1] {
        let (sin, cos) = angle.sin_cos();
        let (y, z) = (upright.y, 0.4 + upright.z);
        let motion = Motion {
            y: cos * y - sin * z,
            z: sin * y + cos * z - 0.4,
            roll: upright.roll + angle,
            velocity: [2.0, 3e-3 * cos, 3e-3 * sin],
            ..upright
        };
        let deviation = Deviation { roll: angle, ..Deviation::default() };
        let turned = pair.solve(&motion, &deviation, Vertical::Height, &Constant(0.3)).unwrap();
        let (a, b) = (&straight.patches[0], &turned.patches[0]);
        near(b.frame.angle - a.frame.angle, angle, 1.0, 1e-6, "angle");
        near(a.tape, b.tape, 1e-3, 1e-4, "tape");
        near(a.approach, b.approach, a.approach, 1e-5, "approach");
        for k in 0..3 {
            near(a.load.force[k], b.load.force[k], a.load.force[2], 1e-4, "force");
            near(a.rolling.creepage[k], b.rolling.creepage[k], 1e-2, 1e-5, "creepage");
        }
    }
}

/// A flank touches ahead of the axle or behind it by (r tan δ − y) yaw to first order.
#[test]
fn yaw_moves_the_contact_along_the_rail() {
    let mut pair = standard(Side::Left, Settings::new([4e-4, 4e-4], [STEEL; 2]));
    for yaw in [2e-3, -4e-3] {
        let solved = solve(&mut pair, &rolling(9e-3, 0.0, yaw), Vertical::Force(20e3));
        let flank = solved.patches.iter().min_by(|a, b| a.tape.total_cmp(&b.tape)).unwrap();
        assert!(flank.frame.angle > 0.7, "{}", flank.frame.angle);
        let reference = flank.frame.reference;
        let (y, z) = (reference.y, reference.z);
        let radius = 0.46 + solved.z - z;
        let expected = (radius * flank.frame.angle.tan() - y) * yaw;
        near(reference.x, expected, expected.abs(), 0.05, "x");
    }
}

/// Solving the height found under a force gives the same force again, independent of earlier
/// positions.
#[test]
fn the_way_to_a_position_does_not_matter() {
    let settings = Settings::new([3e-4, 3e-4], [STEEL; 2]);
    let same = |one: &Solved, other: &Solved, tolerance: f64| {
        for k in 0..3 {
            near(one.force[k], other.force[k], 60e3, tolerance, "force");
        }
        assert_eq!(one.patches.len(), other.patches.len());
    };
    let mut sequence = standard(Side::Left, settings);
    for (y, yaw) in POSITIONS {
        let motion = rolling(y, 0.0, yaw);
        let warm = solve(&mut sequence, &motion, Vertical::Force(60e3));
        assert!((warm.force[2] - 60e3).abs() <= 1e-5 * 60e3);
        let mut fresh = standard(Side::Left, settings);
        same(&warm, &solve(&mut fresh, &motion, Vertical::Force(60e3)), 5e-5);
        let high = Motion { z: warm.z, ..motion };
        same(&warm, &solve(&mut standard(Side::Left, settings), &high, Vertical::Height), 5e-5);
    }
    let alone = solve(&mut sequence, &rolling(0.0, 0.0, 0.0), Vertical::Force(60e3));
    sequence.forget();
    same(&alone, &solve(&mut sequence, &rolling(0.0, 0.0, 0.0), Vertical::Force(60e3)), 5e-5);
}
