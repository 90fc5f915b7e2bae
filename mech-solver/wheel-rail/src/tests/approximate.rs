//! Approximate theories of normal and tangential contact, against closed forms and half-spaces.

use super::{STEEL, arc, line, rolling, single, solve, standard, steel};
use crate::contact::WheelOnRail;
use crate::interface::Constant;
use crate::outline::Outline;
use crate::patch::Patch;
use crate::rail::{Deviation, Side};
use crate::settings::{Normal, RigidSlip, Settings, Tangential, Vertical};
use crate::wheelset::Motion;
use elastic::fastsim::flexibility::Kind;
use elastic::hertz::{EllipticContact, elliptic_contact};
use elastic::kalker::creep_coefficients;
use std::f64::consts::PI;

const RADIUS: f64 = 0.46;
const CROWN: f64 = 0.3;
const LOAD: f64 = 80e3;

/// A cylinder on a crown.
fn crown(normal: Normal, tangential: Tangential, elements: f64) -> (WheelOnRail, EllipticContact) {
    let rail = Outline::new(&arc(0.0, CROWN, 0.08, 60), 0.0).unwrap();
    let middle = 0.5 * rail.range()[1];
    let compliance = steel().contact_compliance();
    let hertz = elliptic_contact(0.5 / RADIUS, 0.5 / CROWN, LOAD, compliance);
    let side = hertz.semi_axis_b / elements;
    let mut settings = Settings::new([side, side], [STEEL; 2]);
    (settings.normal, settings.tangential) = (normal, tangential);
    (single([&line(30e-3), &rail.starting_at(middle)], RADIUS, settings), hertz)
}

/// Both theories are exact on ellipses. Tolerances: displacements and means over elements are of
/// second order in their size, and a circle deviates from a parabola in fourth order.
#[test]
fn ellipses_are_those_of_hertz() {
    for (elements, tolerance) in [(8.0, 4e-3), (32.0, 1e-3)] {
        for normal in [Normal::Kpec, Normal::Analyn] {
            let (mut pair, hertz) = crown(normal, Tangential::HalfSpace, elements);
            let solved = solve(&mut pair, &rolling(0.0, 0.0, 0.0), Vertical::Force(LOAD));
            let patch = &solved.patches[0];
            let area = PI * hertz.semi_axis_a * hertz.semi_axis_b;
            let ratios = [
                patch.max_pressure / hertz.max_pressure,
                patch.approach / hertz.approach,
                patch.area / area,
                solved.force[2] / LOAD,
            ];
            let met = ratios.iter().all(|ratio| (ratio - 1.0).abs() < tolerance);
            assert!(met, "{normal:?} {elements}: {ratios:?}");
        }
    }
}

/// Creepages along both axes and spin.
fn creeping(xi: f64, eta: f64, phi: f64) -> Motion {
    let speed = 2.0;
    // V is the mean of both speeds, which differ by ξV.
    Motion {
        velocity: [speed * (1.0 + 0.5 * xi), speed * eta, 0.0],
        yaw_rate: speed * phi,
        angular_velocity: speed * (1.0 - 0.5 * xi) / RADIUS,
        ..Motion::default()
    }
}

/// For small creepages an ellipse has the slopes of the linear theory, each separately. Tolerance:
/// slip at the trailing edge, and the lengths of the strips at the sides.
#[test]
fn springs_have_the_slopes_of_the_linear_theory() {
    let (mut pair, hertz) = crown(Normal::Analyn, Tangential::Fastsim(Kind::Three), 20.0);
    let axes = [hertz.semi_axis_a, hertz.semi_axis_b];
    let coefficients = creep_coefficients(axes[0] / axes[1], 0.28);
    let modulus = steel().shear_compliance.recip();
    for creepage in [[1e-6, 0.0, 0.0], [0.0, -1e-6, 0.0], [0.0, 0.0, 1e-4]] {
        let [xi, eta, phi] = creepage;
        let solved = pair
            .solve(
                &creeping(xi, eta, phi),
                &Deviation::default(),
                Vertical::Force(LOAD),
                &Constant(0.3),
            )
            .unwrap();
        let patch = &solved.patches[0];
        let linear = coefficients.forces(axes, modulus, patch.rolling.creepage);
        let size = linear.force_x.hypot(linear.force_y);
        let off =
            (patch.load.force[0] - linear.force_x).hypot(patch.load.force[1] - linear.force_y);
        assert!(off < 0.01 * size, "{creepage:?}: {:?} {linear:?}", patch.load.force);
    }
}

/// Under large creepage the force is f N. Under small creepage FASTRIP has less than half the error
/// of FASTSIM.
#[test]
fn large_creepage_takes_all_of_the_friction() {
    for tangential in [Tangential::Fastsim(Kind::Single), Tangential::Fastrip(Kind::Single)] {
        let (mut pair, _) = crown(Normal::Kpec, tangential, 16.0);
        let motion = creeping(0.03, 0.04, 0.0);
        let solved = solve(&mut pair, &motion, Vertical::Force(LOAD));
        let patch = &solved.patches[0];
        let [x, y, n] = patch.load.force;
        assert!((x / (-0.6 * 0.3 * n) - 1.0).abs() < 2e-3, "{x} {y} {n}");
        assert!((y / (-0.8 * 0.3 * n) - 1.0).abs() < 2e-3, "{x} {y} {n}");
        assert!(patch.slip_area_ratio > 0.99, "{}", patch.slip_area_ratio);
    }
}

fn settings(normal: Normal, tangential: Tangential) -> Settings {
    Settings { normal, tangential, ..Settings::new([3e-4, 3e-4], [STEEL; 2]) }
}

/// The friction power equals the power of the forces on patches that are no ellipse, with yaw. Sums
/// over the elements equal those over the strips.
#[test]
fn friction_takes_what_the_forces_give() {
    for rigid_slip in [RigidSlip::Plane, RigidSlip::Surfaces] {
        for normal in [Normal::HalfSpace, Normal::Kpec, Normal::Analyn] {
            for tangential in
                [Tangential::Fastsim(Kind::Single), Tangential::Fastrip(Kind::Blended)]
            {
                let settings = Settings { rigid_slip, ..settings(normal, tangential) };
                let mut pair = standard(Side::Right, settings);
                for (y, yaw) in [(0.0, 0.0), (-3e-3, 4e-3), (-8.5e-3, 1e-2)] {
                    let solved = solve(&mut pair, &rolling(y, 0.0, yaw), Vertical::Force(50e3));
                    solved.patches.iter().for_each(balanced);
                }
            }
        }
    }
}

fn balanced(patch: &Patch) {
    let [xi, eta, phi] = patch.rolling.creepage;
    let [along, across, _] = patch.load.force;
    let parts = [xi * along, eta * across, phi * patch.load.moment[2]]
        .map(|part| patch.rolling.speed * part);
    let exchanged: f64 = parts.iter().map(|part| part.abs()).sum();
    let given = patch.power_off_plane - parts.iter().sum::<f64>();
    let off = (patch.friction_power - given).abs() / exchanged;
    assert!(off < 1e-9, "{}: {} {given}", patch.frame.angle, patch.friction_power);
    let shown = patch.fields.load();
    for k in 0..2 {
        assert!((shown.force[k] - patch.load.force[k]).abs() < 1e-9 * patch.load.force[2]);
    }
    // Upper bound f N.
    assert!(along.hypot(across) < 0.3 * patch.load.force[2] * (1.0 + 1e-6));
}

/// Exchange of left and right. Tolerance: a share of the tolerance of the force.
#[test]
fn a_mirrored_wheel_has_a_mirrored_patch() {
    for normal in [Normal::Kpec, Normal::Analyn] {
        let of = |side: Side, sign: f64| {
            let mut pair = standard(side, settings(normal, Tangential::Fastrip(Kind::Single)));
            let motion = rolling(sign * -4e-3, 0.0, sign * 3e-3);
            solve(&mut pair, &motion, Vertical::Force(50e3))
        };
        let (right, left) = (of(Side::Right, 1.0), of(Side::Left, -1.0));
        assert_eq!(right.patches.len(), left.patches.len());
        let [fx, fy, fz] = right.force;
        for (one, other) in [fx, -fy, fz].into_iter().zip(left.force) {
            assert!(
                (one - other).abs() < 1e-7 * fz,
                "{normal:?} {:?} {:?}",
                right.force,
                left.force
            );
        }
    }
}
