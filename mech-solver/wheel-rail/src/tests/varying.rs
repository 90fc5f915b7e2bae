//! Bodies that vary along the rolling direction, against closed forms and against bodies that do
//! not vary.

use super::{STEEL, arc, line, rolling, steel};
use crate::contact::WheelOnRail;
use crate::interface::Constant;
use crate::outline::Outline;
use crate::patch::Solved;
use crate::rail::{Deviation, Placing, Side, Track};
use crate::settings::{RigidSlip, Settings, Vertical};
use crate::slices::{Along, Slice, Slices};
use crate::standard::{rail_60e1, wheel_s1002};
use crate::surface::Surface;
use crate::wheelset::{Motion, Wheelset};
use elastic::axle::{Form, Irregularity};
use elastic::hertz::elliptic_contact;
use std::f64::consts::TAU;

const RADIUS: f64 = 0.46;

/// Slices of a raised profile, at these positions.
fn raised(profile: &Outline, positions: &[f64], height: impl Fn(f64) -> f64) -> Vec<Slice> {
    let slice = |at: &f64| Slice {
        at: *at,
        outline: profile.placed(0.0, [0.0, height(*at)]),
        features: Vec::new(),
    };
    positions.iter().map(slice).collect()
}

/// Equidistant positions.
fn places(from: f64, to: f64, count: i32) -> Vec<f64> {
    (0..=count).map(|k| from + (to - from) * f64::from(k) / f64::from(count)).collect()
}

/// A wheel above a rail with these surfaces.
fn single(surfaces: [Surface; 2], side: f64) -> WheelOnRail {
    let track = Track { placing: Placing::Origin { y: 0.0, z: 0.0 }, cant: 0.0, curvature: 0.0 };
    let wheelset =
        Wheelset { flange_back_distance: 0.0, flange_back_position: 0.0, nominal_radius: RADIUS };
    let settings = Settings::new([side, side], [STEEL; 2]);
    WheelOnRail::of_surfaces(&surfaces, Side::Left, &track, &wheelset, settings).unwrap()
}

/// S1002 on 60E1 at 1:40.
fn standard(surfaces: &[Surface; 2], side: Side, settings: Settings) -> WheelOnRail {
    let gauge = Placing::Gauge { width: 1.435, height: 14e-3 };
    let track = Track { placing: gauge, cant: 0.025, curvature: 0.0 };
    let wheelset = Wheelset {
        flange_back_distance: 1.36,
        flange_back_position: -0.07,
        nominal_radius: RADIUS,
    };
    WheelOnRail::of_surfaces(surfaces, side, &track, &wheelset, settings).unwrap()
}

fn solve(pair: &mut WheelOnRail, motion: &Motion, force: f64) -> Solved {
    pair.solve(motion, &Deviation::default(), Vertical::Force(force), &Constant(0.3)).unwrap()
}

/// Rail with a crown of 0.3 m.
fn crown() -> Outline {
    let rail = Outline::new(&arc(0.0, 0.3, 0.08, 60), 0.0).unwrap();
    let middle = 0.5 * rail.range()[1];
    rail.starting_at(middle)
}

/// Slices that all equal one profile, of the wheel or of the rail, from the tread to the flange.
/// The reference of a patch is a mean. Its weights use the true gap, and for round wheels circles
/// of one radius. On a patch of the tread 28 mm wide this shifts the reference by 4 µm. On the
/// throat, where circles across the normal are far from parabolas, it shifts by 12 µm, which turns
/// the patch by 1 mrad.
#[test]
fn equal_slices_have_the_contact_of_their_profile() {
    let settings = Settings::new([4e-4, 4e-4], [STEEL; 2]);
    let (wheel, rail) = (wheel_s1002().unwrap(), rail_60e1().unwrap());
    let sliced = |profile: &Outline, period| {
        let slices = raised(profile, &places(-0.3, 0.4, 7), |_| 0.0);
        Surface::from(Slices::new(&slices, Along::Through, period).unwrap())
    };
    let round = [wheel.clone().into(), rail.clone().into()];
    let kinds = [
        [sliced(&wheel, Some(TAU)), rail.clone().into()],
        [wheel.clone().into(), sliced(&rail, None)],
        [sliced(&wheel, Some(TAU)), sliced(&rail, None)],
    ];
    for kind in kinds {
        let [mut expected, mut found] =
            [&round, &kind].map(|surfaces| standard(surfaces, Side::Left, settings));
        for (y, yaw, tape, force) in
            [(0.0, 0.0, 5e-6, 3e-5), (2e-3, -5e-3, 5e-6, 3e-5), (9e-3, 1e-2, 15e-6, 4e-3)]
        {
            let motion = Motion { way: 0.05, pitch: 0.7, ..rolling(y, 1e-3, yaw) };
            let [one, other] = [&mut expected, &mut found].map(|pair| solve(pair, &motion, 60e3));
            assert_eq!(one.patches.len(), other.patches.len());
            for k in 0..3 {
                let off = (one.force[k] - other.force[k]).abs();
                assert!(off < force * 60e3, "{y} {k}: {:?} {:?}", one.force, other.force);
            }
            for (a, b) in one.patches.iter().zip(&other.patches) {
                assert!((a.tape - b.tape).abs() < tape, "{} {}", a.tape, b.tape);
                assert!((a.max_pressure / b.max_pressure - 1.0).abs() < 10.0 * force);
            }
        }
    }
}

/// A wheel of the radius 0.3 m about a point 0.16 m beside the axle, in slices over the angle. At
/// its lowest point it is a cylinder of 0.3 m. Tolerances: those of a cylinder on a crown.
#[test]
fn an_eccentric_wheel_has_hertzs_contact_of_its_own_radius() {
    let (own, load) = (0.3, 80e3);
    let aside = RADIUS - own;
    let radius = |theta: f64| {
        let (sin, cos) = theta.sin_cos();
        aside * cos + (own * own - aside * aside * sin * sin).sqrt()
    };
    let slices = raised(&line(30e-3), &places(-0.4, 0.4, 80), |theta| RADIUS - radius(theta));
    let wheel = Slices::new(&slices, Along::Through, Some(TAU)).unwrap();
    let hertz = elliptic_contact(0.5 / own, 0.5 / 0.3, load, steel().contact_compliance());
    let mut pair = single([wheel.into(), crown().into()], hertz.semi_axis_b / 12.0);
    let solved = solve(&mut pair, &rolling(0.0, 0.0, 0.0), load);
    let patch = &solved.patches[0];
    assert!((patch.max_pressure / hertz.max_pressure - 1.0).abs() < 2e-3, "{}", patch.max_pressure);
    assert!((patch.approach / hertz.approach - 1.0).abs() < 2e-3, "{}", patch.approach);
    assert!((solved.z + patch.approach).abs() < 1e-8, "{} {}", solved.z, patch.approach);
    // Turned slightly, it stands beside its lowest point, and the axle is lower.
    let turned = Motion { pitch: 0.02, ..rolling(0.0, 0.0, 0.0) };
    let solved = solve(&mut pair, &turned, load);
    let patch = &solved.patches[0];
    assert!((patch.frame.reference.x + aside * 0.02_f64.sin()).abs() < 2e-6);
    let height = own + aside * 0.02_f64.cos() - RADIUS - patch.approach;
    assert!((solved.z - height).abs() < 1e-8, "{} {height}", solved.z);
}

/// A wheel on rail waves of the wavelength L. On a crest the curvature ½d(2π/L)² of the waves adds
/// to that of the wheel, in a trough it subtracts, and in between the contact is ahead of or behind
/// the axle. Tolerance: the fourth order of the waves, (2πa/L)²/4 of their curvature, besides that
/// of a cylinder on a crown.
#[test]
fn waves_of_the_rail_change_hertzs_contact() {
    let (depth, length, load) = (0.2e-3, 0.15, 60e3);
    let waves = Irregularity { form: Form::Corrugation, depth, length, at: -10.0 * length };
    let wave = TAU / length;
    let curvature = 0.5 * depth * wave * wave;
    let surfaces = || [line(30e-3).into(), Surface::from(crown()).hollow_rail(waves)];
    let table = || {
        let positions = places(-0.4, 0.4, 400);
        let slices = raised(&crown(), &positions, |way| -waves.hollow(way, f64::INFINITY));
        [line(30e-3).into(), Slices::new(&slices, Along::Through, None).unwrap().into()]
    };
    for surfaces in [surfaces(), table()] {
        for (way, sign) in [(0.0, 1.0), (0.5 * length, -1.0)] {
            let along = 1.0 / RADIUS + sign * curvature;
            let hertz =
                elliptic_contact(0.5 * along, 0.5 / 0.3, load, steel().contact_compliance());
            let mut pair =
                single(surfaces.clone(), hertz.semi_axis_b.min(hertz.semi_axis_a) / 12.0);
            let motion = Motion { way, ..rolling(0.0, 0.0, 0.0) };
            let solved = solve(&mut pair, &motion, load);
            let patch = &solved.patches[0];
            let ratio = patch.max_pressure / hertz.max_pressure;
            assert!((ratio - 1.0).abs() < 3e-3, "{way} {ratio}");
            assert!((patch.approach / hertz.approach - 1.0).abs() < 3e-3, "{}", patch.approach);
            let low = if sign > 0.0 { 0.0 } else { depth };
            assert!((solved.z + low + patch.approach).abs() < 1e-7, "{}", solved.z);
        }
        // On a slope: the contact is where both slopes are equal, h'(x) = −x/R to first order.
        let mut pair = single(surfaces, 4e-4);
        let motion = Motion { way: 0.25 * length, ..rolling(0.0, 0.0, 0.0) };
        let solved = solve(&mut pair, &motion, load);
        let slope = 0.5 * depth * wave;
        let expected = slope / (1.0 / RADIUS);
        let x = solved.patches[0].frame.reference.x;
        assert!((x / expected + 1.0).abs() < 0.05, "{x} {expected}");
        // The reference is on the rail there.
        let height = -waves.hollow(motion.way + x, f64::INFINITY);
        let z = solved.patches[0].frame.reference.z;
        assert!((z - height).abs() < 1e-8, "{z} {height}");
    }
}

/// A flat away from the rail has no effect.
#[test]
fn a_flat_on_the_other_side_is_none() {
    let settings = Settings::new([4e-4, 4e-4], [STEEL; 2]);
    let flat = Irregularity { form: Form::Flat, depth: 0.9e-3, length: 58e-3, at: 0.2 };
    let wheel = wheel_s1002().unwrap();
    let rail: Surface = rail_60e1().unwrap().into();
    let worn = Surface::from(wheel.clone()).hollow_wheel(flat, RADIUS, None);
    let mut round = standard(&[wheel.into(), rail.clone()], Side::Left, settings);
    let mut pair = standard(&[worn, rail], Side::Left, settings);
    for pitch in [0.0, 3.0, 0.2 / RADIUS + 0.2] {
        let motion = Motion { pitch, ..rolling(3e-3, 0.0, 0.0) };
        let [one, other] = [&mut round, &mut pair].map(|pair| solve(pair, &motion, 60e3));
        assert!((one.z - other.z).abs() < 1e-9);
        assert!((one.force[0] - other.force[0]).abs() < 1e-5 * 60e3);
    }
    // On the flat the axle is lower.
    let motion = Motion { pitch: 0.2 / RADIUS, ..rolling(3e-3, 0.0, 0.0) };
    let [one, other] = [&mut round, &mut pair].map(|pair| solve(pair, &motion, 60e3));
    assert!(other.z < one.z - 0.4e-3, "{} {}", one.z, other.z);
}

/// Energy balance and mirror image on a flat halfway under the wheel; the same flat in slices.
#[test]
fn a_flat_keeps_energy_and_has_a_mirror_image() {
    let flat = Irregularity { form: Form::Flat, depth: 0.3e-3, length: 60e-3, at: 0.1 };
    let profile = wheel_s1002().unwrap();
    let rail: Surface = rail_60e1().unwrap().into();
    let wheel = Surface::from(profile.clone()).hollow_wheel(flat, RADIUS, None);
    let circumference = TAU * RADIUS;
    let depth = |theta: f64| flat.hollow(RADIUS * theta, circumference);
    let slices = raised(&profile, &places(0.1, 0.4, 300), depth);
    let slices = Surface::from(Slices::new(&slices, Along::Through, Some(TAU)).unwrap());
    for rigid_slip in [RigidSlip::Plane, RigidSlip::Surfaces] {
        let settings = Settings { rigid_slip, ..Settings::new([4e-4, 4e-4], [STEEL; 2]) };
        let of = |wheel: &Surface, side| standard(&[wheel.clone(), rail.clone()], side, settings);
        let mut left = of(&wheel, Side::Left);
        let mut right = of(&wheel, Side::Right);
        let mut sliced = of(&slices, Side::Left);
        for at in [0.08, 0.1, 0.115] {
            let motion = |sign: f64| Motion {
                pitch: at / RADIUS,
                ..rolling(sign * 2e-3, sign * 1e-3, sign * 3e-3)
            };
            let one = solve(&mut left, &motion(1.0), 60e3);
            let other = solve(&mut right, &motion(-1.0), 60e3);
            let third = solve(&mut sliced, &motion(1.0), 60e3);
            assert!((one.z - other.z).abs() < 1e-9);
            // Splines of 0.46 mm over a cosine.
            assert!((one.z - third.z).abs() < 1e-7, "{} {}", one.z, third.z);
            for (k, sign) in [1.0, -1.0, 1.0].into_iter().enumerate() {
                assert!((one.force[k] - sign * other.force[k]).abs() < 1e-7 * 60e3);
                assert!((one.force[k] - third.force[k]).abs() < 2e-3 * 60e3);
            }
            for patch in &one.patches {
                let [xi, eta, phi] = patch.rolling.creepage;
                let [along, across, _] = patch.load.force;
                let moment = patch.load.moment[2] - patch.fields.pivot() * across;
                let given = -patch.rolling.speed * (xi * along + eta * across + phi * moment)
                    + patch.power_off_plane;
                let size = patch.friction_power.abs() + patch.power_off_plane.abs();
                assert!((patch.friction_power - given).abs() < 1e-9 * size, "{given}");
                assert!(patch.friction_power > 0.0);
            }
        }
    }
}

/// Both ends of a flat at once: the wheel stands on two places, each of which carries half.
#[test]
fn a_short_deep_flat_stands_on_its_ends() {
    let flat = Irregularity { form: Form::Flat, depth: 0.5e-3, length: 20e-3, at: 0.0 };
    let wheel = Surface::from(line(30e-3)).hollow_wheel(flat, RADIUS, None);
    let mut pair = single([wheel, crown().into()], 4e-4);
    let solved = solve(&mut pair, &rolling(0.0, 0.0, 0.0), 40e3);
    let patch = &solved.patches[0];
    let [nx, ny] = patch.fields.counts;
    let column = |i: usize| (0..ny).map(|j| patch.fields.pressure[j * nx + i]).sum::<f64>();
    let x = |i: usize| 4e-4 * (patch.fields.first[0] + i as i64) as f64;
    let sum = |on: &dyn Fn(f64) -> bool| {
        (0..nx).filter(|i| on(x(*i))).map(column).sum::<f64>() * 4e-4 * 4e-4
    };
    let [behind, under, ahead] =
        [sum(&|x| x < -2e-3), sum(&|x| x.abs() <= 2e-3), sum(&|x| x > 2e-3)];
    assert_eq!(under, 0.0);
    assert!((behind / ahead - 1.0).abs() < 1e-3 && (behind / 20e3 - 1.0).abs() < 1e-2);
}

/// The contact on a flat converges with the elements.
#[test]
fn the_contact_on_a_flat_converges() {
    let flat = Irregularity { form: Form::Flat, depth: 0.3e-3, length: 60e-3, at: 0.0 };
    let wheel = Surface::from(line(30e-3)).hollow_wheel(flat, RADIUS, None);
    let motion = Motion { pitch: 15e-3 / RADIUS, ..rolling(0.0, 0.0, 0.0) };
    let of = |side: f64| {
        let mut pair = single([wheel.clone(), crown().into()], side);
        let solved = solve(&mut pair, &motion, 60e3);
        (solved.z, solved.patches[0].max_pressure)
    };
    let [coarse, middle, fine, finest] = [8e-4, 4e-4, 2e-4, 1e-4].map(of);
    let (first, second) = (coarse.0 - finest.0, middle.0 - finest.0);
    assert!(first.abs() > 2.0 * second.abs(), "{coarse:?} {middle:?} {fine:?} {finest:?}");
    assert!((fine.0 - finest.0).abs() < 3e-8, "{fine:?} {finest:?}");
    assert!((fine.1 / finest.1 - 1.0).abs() < 3e-3, "{fine:?} {finest:?}");
}

/// After [`WheelOnRail::forget`], a solver reproduces the bits of a new one: windows of a history
/// are solved on any thread, in any order.
#[test]
fn what_is_forgotten_leaves_no_trace() {
    let settings = Settings::new([4e-4, 4e-4], [STEEL; 2]);
    let (wheel, rail) = (wheel_s1002().unwrap(), rail_60e1().unwrap());
    let waves = raised(&rail, &places(-0.3, 0.4, 14), |x| 2e-5 * (20.0 * x).sin());
    let waves = Surface::from(Slices::new(&waves, Along::Through, None).unwrap());
    for surfaces in [[wheel.clone().into(), rail.clone().into()], [wheel.into(), waves]] {
        let positions = [(0.0, 0.0), (2e-3, 0.05), (5e-3, 0.1), (0.0, 0.1)];
        let at = |(y, way)| Motion { way, ..rolling(y, 0.0, 2.0 * y) };
        let mut used = standard(&surfaces, Side::Left, settings);
        for before in positions {
            for position in positions {
                used.forget();
                solve(&mut used, &at(before), 80e3);
                let outlines =
                    |of: &WheelOnRail| of.outlines(&at(position), &Deviation::default(), 50);
                assert_eq!(outlines(&used), outlines(&standard(&surfaces, Side::Left, settings)));
                used.forget();
                let found = solve(&mut used, &at(position), 50e3);
                let fresh = standard(&surfaces, Side::Left, settings);
                let expected = solve(&mut { fresh }, &at(position), 50e3);
                assert_eq!(found.force, expected.force, "{position:?} after {before:?}");
                assert_eq!(found.work, expected.work, "{position:?} after {before:?}");
            }
        }
    }
}
