//! Patches on a curved surface.

use super::{STEEL, arc, rolling, single, solve, standard};
use crate::contact::WheelOnRail;
use crate::error::TrackError;
use crate::interface::Constant;
use crate::outline::Outline;
use crate::patch::{Patch, Solved};
use crate::rail::{Deviation, Side};
use crate::settings::{PatchSurface, RigidSlip, Settings, Vertical};
use crate::wheelset::Motion;
use grids::Structured;
use half_space::conformal::contact::{ConformalSolver, Prescription};
use half_space::conformal::shape::Arcs;
use half_space::difference::Difference;
use half_space::normal::Prescribed;
use std::f64::consts::FRAC_PI_6;

/// Radii of the throat and of the corner [m].
const RADII: [f64; 2] = [10.2e-3, 10e-3];
/// Both arcs turn by ±30°, and continue straight.
const HALF: f64 = FRAC_PI_6;
/// Penetration of the arcs [m].
const APPROACH: f64 = 10e-6;

fn settings(side: f64, patch_surface: PatchSurface) -> Settings {
    let rigid_slip = RigidSlip::Surfaces;
    let difference = Difference::Upwind;
    Settings { patch_surface, rigid_slip, difference, ..Settings::new([side, side], [STEEL; 2]) }
}

/// A wheel of 0.46 m with the throat on the corner.
fn corner(settings: Settings) -> WheelOnRail {
    let profile = |radius: f64| {
        let mut points = arc(0.0, radius, HALF, 400);
        let [y, z] = [radius * HALF.sin(), radius * (HALF.cos() - 1.0)];
        let line = |k: i32| {
            let beyond = 1e-3 * f64::from(k);
            [y + beyond * HALF.cos(), z - beyond * HALF.sin()]
        };
        points.extend((1..=40).map(line));
        let left = (1..=40).rev().map(line).map(|[y, z]| [-y, z]);
        let points: Vec<[f64; 2]> = left.chain(points).collect();
        let outline = Outline::new(&points, 0.0).unwrap();
        let [from, to] = outline.range();
        outline.starting_at(0.5 * (from + to))
    };
    let [throat, corner] = RADII.map(profile);
    single([&throat, &corner], 0.46, settings)
}

/// Motion with the bodies pressed together by [`APPROACH`] along the vertical.
fn close() -> Motion {
    Motion {
        z: -APPROACH,
        velocity: [2.0, 0.01, 0.0],
        angular_velocity: 2.0 / 0.46 * 1.002,
        ..rolling(0.0, 0.0, 0.0)
    }
}

fn solved(patch_surface: PatchSurface) -> Solved {
    let mut pair = corner(settings(0.3e-3, patch_surface));
    solve(&mut pair, &close(), Vertical::Height)
}

fn only(solved: &Solved) -> &Patch {
    let [patch] = &solved.patches[..] else { panic!("{} patches", solved.patches.len()) };
    patch
}

/// Integrals of pressure and tractions [N].
fn sums(patch: &Patch) -> [f64; 3] {
    let ([x, s], [dx, dy]) = (&patch.fields.traction, patch.fields.sides);
    [&patch.fields.pressure, x, s].map(|field| field.iter().sum::<f64>() * dx * dy)
}

/// Arcs of a prism with its rolling curvature, by [`half_space::conformal`], which gives 1 to 3 %
/// less force than half-spaces. Tolerance: the curvature along x of a wheel about its axle, cos α
/// of that in the middle, α up to 0.25.
#[test]
fn arcs_are_those_of_prisms() {
    let solved = solved(PatchSurface::Curved);
    let patch = only(&solved);
    let curvatures = RADII.map(|radius| -1.0 / radius);
    let arcs = Arcs { curvatures, rolling_curvature: 1.0 / 0.46 };
    let (side, count) = (0.3e-3, 41);
    let first = -20.0 * side;
    let grid = Structured::contact_plane(first, first, side, side, count, count);
    let mut solver = ConformalSolver::new(
        &[STEEL; 2],
        (arcs, 2.0 * HALF),
        &grid,
        [3e-3, 2.5e-3],
        Difference::Upwind,
    );
    let prescription = Prescription {
        load: Prescribed::Approach(APPROACH),
        creepage: patch.rolling.creepage,
        normal_creepage: 0.0,
        in_plane: false,
        friction: 0.3,
        adheres: true,
    };
    let found = solver.solve(&prescription).unwrap();
    let [x, s] = &found.state.traction;
    let expected = [&found.pressure, x, s].map(|field| field.iter().sum::<f64>() * side * side);
    let plane = self::solved(PatchSurface::Plane);
    let pairs = sums(patch).into_iter().zip(expected).zip(sums(only(&plane)));
    for ((value, expected), plane) in pairs {
        assert!((value / expected - 1.0).abs() < 2e-3, "{value} instead of {expected}");
        assert!((plane / expected - 1.0).abs() > 1e-2, "{plane} beside {expected}");
    }
}

/// The friction power equals the work of the tractions on the rigid slip plus the work of the
/// pressure on the normal displacement of the passing particles, which is minus the undeformed
/// distance. Tolerance: the reciprocity of the influence numbers.
#[test]
fn friction_takes_what_the_rigid_slip_gives() {
    let solved = solved(PatchSurface::Curved);
    let patch = only(&solved);
    let (fields, grid) = (&patch.fields, patch.fields.grid());
    let [xi, eta, phi] = patch.rolling.creepage;
    let [px, ps] = &fields.traction;
    let (mut creep, mut normal) = (0.0, 0.0);
    for at in (0..grid.points()).filter(|at| !(at + 1).is_multiple_of(grid.ni)) {
        let mean = |field: &[f64]| 0.5 * (field[at] + field[at + 1]);
        let x = grid.x(at % grid.ni) + grid.dx() / 6.0;
        let t = grid.y(at / grid.ni);
        creep -= mean(px) * (xi - phi * t) + mean(ps) * (eta + phi * x);
        normal += mean(&fields.pressure) * (fields.distance[at + 1] - fields.distance[at]);
    }
    let creep = creep * grid.element_area() * patch.rolling.speed;
    let normal = normal * grid.dy() * patch.rolling.speed;
    let given = creep + patch.power_off_plane + normal;
    let off = (patch.friction_power - given).abs() / patch.friction_power;
    assert!(off < 1e-3, "{off:e}: {} of {creep} {normal}", patch.friction_power);
    assert!(
        patch.power_off_plane.abs() > 3e-3 * creep,
        "{} {creep} {normal}",
        patch.power_off_plane
    );
}

/// A wheel in the corner of a rail under a force, reached from any position and mirrored on the
/// other side. Tolerances: the force is met to 1e-5.
#[test]
fn a_force_is_met_from_any_position_and_on_either_side() {
    let mut pairs = [Side::Left, Side::Right]
        .map(|side| standard(side, settings(0.5e-3, PatchSurface::Curved)));
    let motion = |y: f64| Motion { velocity: [2.0, 0.002, 0.0], ..rolling(y, 0.0, 2e-3) };
    let (force, y) = (Vertical::Force(80e3), 4.5e-3);
    let fresh = solve(&mut pairs[0], &motion(y), force);
    assert!((fresh.force[2] / 80e3 - 1.0).abs() < 1e-5);
    solve(&mut pairs[0], &motion(1e-3), Vertical::Force(40e3));
    let again = solve(&mut pairs[0], &motion(y), force);
    let mirrored = Motion { y: -y, yaw: -2e-3, velocity: [2.0, -0.002, 0.0], ..motion(y) };
    let other = solve(&mut pairs[1], &mirrored, force);
    let [x, side, up] = fresh.force;
    for (found, sign) in [(&again, 1.0), (&other, -1.0)] {
        let off = [found.force[0] - x, sign * found.force[1] - side, found.force[2] - up];
        assert!(off.iter().all(|off| off.abs() < 3e-5 * up), "{off:?} of {:?}", fresh.force);
        assert_eq!(found.patches.len(), fresh.patches.len());
    }
}

#[test]
fn too_many_rows_are_refused() {
    let fine = Settings { sides: [1e-5, 2e-5], ..settings(1e-5, PatchSurface::Curved) };
    let found =
        corner(fine).solve(&close(), &Deviation::default(), Vertical::Height, &Constant(0.3));
    let error = found.unwrap_err();
    assert!(matches!(error, TrackError::Rows { .. }), "{error}");
    assert!(error.to_string().contains("mech.lateral_resolution"));
}
