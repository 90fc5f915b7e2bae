//! Several patches, and the grid that they share.

use super::{STEEL, arc, elements, line, rolling, single, solve, standard, steel};
use crate::contact::WheelOnRail;
use crate::developed::Developed;
use crate::error::TrackError;
use crate::interface::{Constant, Elements, Interface};
use crate::outline::Outline;
use crate::pair::Pair;
use crate::patch::Patch;
use crate::rail::{Deviation, Placing, Rail, Side, Track};
use crate::region::Joining;
use crate::settings::{Settings, Vertical};
use crate::surface::Surface;
use crate::wheelset::{Motion, Wheel, Wheelset};
use half_space::friction::ElementFriction;

/// Two crowns, 12 mm apart.
fn crowns() -> Outline {
    let mut points = arc(-6e-3, 20e-3, 0.25, 30);
    points.extend(arc(6e-3, 20e-3, 0.25, 30));
    let rail = Outline::new(&points, 0.0).unwrap();
    let middle = 0.5 * rail.range()[1];
    rail.starting_at(middle)
}

#[test]
fn two_crowns_carry_half_each() {
    let (rail, wheel) = (crowns(), line(30e-3));
    let mut pair = single([&wheel, &rail], 0.46, elements(2e-4));
    let solved = solve(&mut pair, &rolling(0.0, 0.0, 0.0), Vertical::Force(40e3));
    assert_eq!(solved.patches.len(), 2);
    let [one, other] = [&solved.patches[0], &solved.patches[1]];
    assert!(one.tape < 0.0 && other.tape > 0.0);
    for patch in [one, other] {
        assert!((patch.load.force[2] / 20e3 - 1.0).abs() < 1e-3, "{}", patch.load.force[2]);
    }
    // On one half-space they push each other away: the same force needs more depth.
    let wide = Joining { distance: 20e-3, ..Joining::default() };
    let settings = Settings { joining: wide, ..Settings::new([2e-4, 2e-4], [STEEL; 2]) };
    let track = Track { placing: Placing::Origin { y: 0.0, z: 0.0 }, cant: 0.0, curvature: 0.0 };
    let wheelset =
        Wheelset { flange_back_distance: 0.0, flange_back_position: 0.0, nominal_radius: 0.46 };
    let mut joined =
        WheelOnRail::new([&wheel, &rail], Side::Left, &track, &wheelset, settings).unwrap();
    let together = solve(&mut joined, &rolling(0.0, 0.0, 0.0), Vertical::Force(40e3));
    assert_eq!(together.patches.len(), 1);
    assert!(together.z < solved.z - 3e-6, "{} {}", together.z, solved.z);
    let area = one.area + other.area;
    assert!((together.patches[0].area / area - 1.0).abs() < 0.05);
    // Patches in different planes with mutual influence behave alike: equal, mirrored, and as deep
    // as on one half-space. Tolerances: blocks as point loads, and for the pressure the position of
    // the elements under a crown.
    let settings = Settings { mutual: true, ..Settings::new([2e-4, 2e-4], [STEEL; 2]) };
    let mut mutual = single([&wheel, &rail], 0.46, settings);
    let apart = solve(&mut mutual, &rolling(0.0, 0.0, 0.0), Vertical::Force(40e3));
    let [left, right] = apart.patches.as_slice() else { panic!("{}", apart.patches.len()) };
    assert!((left.load.force[2] / right.load.force[2] - 1.0).abs() < 1e-5);
    assert!((left.max_pressure / right.max_pressure - 1.0).abs() < 1e-4);
    let [deeper, expected] = [solved.z - apart.z, solved.z - together.z];
    assert!((deeper / expected - 1.0).abs() < 0.02, "{deeper:e} {expected:e}");
    let highest = together.patches[0].max_pressure;
    assert!((left.max_pressure / highest - 1.0).abs() < 1e-2, "{} {highest}", left.max_pressure);
}

/// The mutual influence of patches decreases with the distance: E* P/(π r) of the depth. Tolerance:
/// the squared ratio of the patch size to r, and the lower load of the patches.
#[test]
fn far_patches_hardly_act_on_each_other() {
    let depth = |distance: f64, mutual: bool| {
        let mut points = arc(-0.5 * distance, 20e-3, 0.1, 20);
        points.extend(arc(0.5 * distance, 20e-3, 0.1, 20));
        let rail = Outline::new(&points, 0.0).unwrap();
        let middle = 0.5 * rail.range()[1];
        let rail = rail.starting_at(middle);
        let settings = Settings { mutual, ..Settings::new([2e-4, 2e-4], [STEEL; 2]) };
        let mut pair = single([&line(60e-3), &rail], 0.46, settings);
        solve(&mut pair, &rolling(0.0, 0.0, 0.0), Vertical::Force(4e3)).z
    };
    for distance in [12e-3, 24e-3, 72e-3] {
        let deeper = depth(distance, false) - depth(distance, true);
        let expected = steel().contact_compliance() * 2e3 / (std::f64::consts::PI * distance);
        assert!((deeper / expected - 1.0).abs() < 0.02, "{distance} {deeper:e} {expected:e}");
    }
}

/// Patches that do not settle are an error, not their last iterate. One turn is not enough for two
/// crowns, the usual limit is.
#[test]
fn patches_that_do_not_settle_are_refused() {
    let (rail, wheel) = (Surface::from(crowns()), Surface::from(line(30e-3)));
    let track = Track { placing: Placing::Origin { y: 0.0, z: 0.0 }, cant: 0.0, curvature: 0.0 };
    let wheelset =
        Wheelset { flange_back_distance: 0.0, flange_back_position: 0.0, nominal_radius: 0.46 };
    let rail = Rail::placed(&rail, Side::Left, &track).unwrap();
    let wheel = Wheel::placed(&wheel, Side::Left, &wheelset);
    let mut pair = Pair::new((rail, wheel), Side::Left, wheelset, elements(4e-4));
    let motion = Motion { z: -20e-6, ..rolling(0.0, 0.0, 0.0) };
    pair.go_to(&motion, &Deviation::default());
    pair.press(&Constant(0.3)).unwrap();
    let mut pressed = std::mem::take(&mut pair.pressed);
    assert_eq!(pressed.len(), 2);
    let error = pair.press_together(&mut pressed, 1).unwrap_err();
    assert!(matches!(error, TrackError::Patches { .. }), "{error}");
    assert!(error.to_string().contains("mech.patch_influence"), "{error}");
    assert_eq!(pair.press_together(&mut pressed, 60), Ok(()));
}

/// Tread and flange in contact at once: the elements of all patches belong to one grid along the
/// rail, and none belongs to two patches.
#[test]
fn all_patches_are_on_one_grid() {
    let sides = [3e-4, 2e-4];
    let mut pair = standard(Side::Left, Settings::new(sides, [STEEL; 2]));
    let mut most = 0;
    for k in 0..24 {
        let (y, force) = (4.9e-3 + 5e-5 * f64::from(k / 2), [30e3, 120e3][k as usize % 2]);
        let solved = solve(&mut pair, &rolling(y, 0.0, 0.0), Vertical::Force(force));
        most = most.max(solved.patches.len());
        for patch in &solved.patches {
            let fields = &patch.fields;
            for k in 0..2 {
                assert_eq!(fields.first[k] + fields.origin[k] as i64, patch.frame.element[k]);
            }
            assert_eq!(fields.sides, sides);
            assert!(
                (patch.frame.origin.x - patch.frame.element[0] as f64 * sides[0]).abs() < 1e-15
            );
            assert!(
                (patch.tape - patch.frame.element[1] as f64 * sides[1]).abs() <= 0.5 * sides[1]
            );
            // No contact on the edge of the window.
            let [nx, ny] = fields.counts;
            let edge = |at: usize| {
                at.is_multiple_of(nx) || at % nx == nx - 1 || at / nx == 0 || at / nx == ny - 1
            };
            assert!((0..nx * ny).all(|at| !edge(at) || fields.pressure[at] == 0.0));
        }
        let rows = |at: usize| {
            let fields = &solved.patches[at].fields;
            let row = |at: usize| fields.first[1] + (at / fields.counts[0]) as i64;
            let loaded = (0..fields.pressure.len()).filter(|at| fields.pressure[*at] > 0.0);
            let rows: Vec<i64> = loaded.map(row).collect();
            [rows[0], rows[rows.len() - 1]]
        };
        for at in 1..solved.patches.len() {
            assert!(rows(at - 1)[1] < rows(at)[0]);
        }
        let whole = Developed::of(&solved.patches, 2);
        let area = sides[0] * sides[1];
        let [load, power] =
            [&whole.pressure, &whole.friction_power].map(|field| field.iter().sum::<f64>() * area);
        let sum = |of: fn(&Patch) -> f64| solved.patches.iter().map(of).sum::<f64>();
        assert!((load / sum(|patch| patch.load.force[2]) - 1.0).abs() < 1e-12);
        assert!((power / sum(|patch| patch.friction_power) - 1.0).abs() < 1e-12);
    }
    assert!(most >= 2, "{most}");
}

/// Friction that increases along the tape.
struct AcrossTape;

impl Interface for AcrossTape {
    fn friction(&self, elements: &Elements<'_>) -> Result<ElementFriction, String> {
        let Elements { grid, .. } = elements;
        let coefficient = |at: usize| 0.1 + 2.5 * grid.y(at / grid.ni);
        Ok(ElementFriction::of_coefficients((0..grid.points()).map(coefficient).collect()))
    }
}

/// Friction of elements by their position, and errors without a solution.
#[test]
fn friction_follows_the_grid_and_errors_are_told() {
    let mut pair = standard(Side::Left, Settings::new([4e-4, 4e-4], [STEEL; 2]));
    let motion = rolling(0.0, 0.0, 5e-3);
    let at_rest = Deviation::default();
    let force = Vertical::Force(50e3);
    let solved = pair.solve(&motion, &at_rest, force, &AcrossTape).unwrap();
    let fields = &solved.patches[0].fields;
    for (at, p) in fields.pressure.iter().enumerate() {
        let j = fields.first[1] + (at / fields.counts[0]) as i64;
        let traction = fields.traction[0][at].hypot(fields.traction[1][at]);
        assert!(traction <= p * (0.1 + 1e-3 * j as f64) * (1.0 + 1e-12));
    }
    let lifted = solve(&mut pair, &motion, Vertical::Force(0.0));
    assert!(lifted.patches.is_empty() && lifted.force == [0.0; 3]);
    let beside = pair.solve(&rolling(0.3, 0.0, 0.0), &at_rest, force, &Constant(0.3));
    assert_eq!(beside, Err(TrackError::Beside));
    let pulled = pair.solve(&motion, &at_rest, Vertical::Force(-1.0), &Constant(0.3));
    assert_eq!(pulled, Err(TrackError::Force(-1.0)));
    let standing = crate::wheelset::Motion { velocity: [0.0; 3], ..motion };
    let standing = pair.solve(&standing, &at_rest, force, &Constant(0.3));
    assert!(matches!(standing, Err(TrackError::Rolling(_))), "{standing:?}");
}
