//! Profiles of public standards, from their formulae: the head of the rail 60E1 and the wheel
//! S1002.
//!
//! Rail 60E1 (EN 13674-1, formerly UIC 60): arcs that meet without a corner, with radii of 300, 80
//! and 13 mm. The chords of the first two are 20.456 mm and 52.053 mm wide. Flanks of 1:20 follow
//! below.
//!
//! Wheel S1002 (EN 13715, UIC 510-2), for flanges 28 mm high and 32.5 mm thick: a straight line,
//! two polynomials, the arcs of throat and flange and a flank of 70°, each on its own part of −70
//! mm < y < 60 mm. The standard measures depths, with y from the tape circle to the field side. The
//! printed parts meet within 0.12 µm.
//!
//! Both are in the axes of a profile ([`super::profile`]). Their points are so dense that a spline
//! through them agrees with the formula within half a micrometre.

use super::outline::{Outline, OutlineError};
use super::profile::orientation::Body;
use super::profile::read::from_origin;

/// Points on each arc and on each flank of a rail.
const POINTS: usize = 80;
/// Largest spacing of the points of a wheel, along y or along an arc [mm].
const STEP: f64 = 0.25;

/// Radii of the head's arcs [mm], and half-widths where the first two end [mm].
const HEAD: ([f64; 3], [f64; 2]) = ([300.0, 80.0, 13.0], [10.228, 26.0265]);
/// Slope of the flanks, width per height.
const FLANK: f64 = 1.0 / 20.0;
/// Length of the flanks [mm].
const FLANK_LENGTH: f64 = 20.0;

/// Head of the rail 60E1, upright.
///
/// # Errors
/// Never fails: the points of the standard form a valid curve.
pub fn rail_60e1() -> Result<Outline, OutlineError> {
    let mut half = vec![[0.0, 0.0]];
    let ([crown, shoulder, corner], ends) = HEAD;
    let mut angle = 0.0_f64;
    for (radius, end) in [(crown, ends[0]), (shoulder, ends[1]), (corner, f64::INFINITY)] {
        let [y, z] = half[half.len() - 1];
        let centre = [y - radius * angle.sin(), z - radius * angle.cos()];
        let steepest = std::f64::consts::FRAC_PI_2 - FLANK.atan();
        let last = if end.is_finite() { ((end - centre[0]) / radius).asin() } else { steepest };
        half.extend((1..=POINTS).map(|k| {
            let at = angle + (last - angle) * k as f64 / POINTS as f64;
            [centre[0] + radius * at.sin(), centre[1] + radius * at.cos()]
        }));
        angle = last;
    }
    let [y, z] = half[half.len() - 1];
    let down = [angle.cos(), -angle.sin()];
    half.extend((1..=POINTS).map(|k| {
        let along = FLANK_LENGTH * k as f64 / POINTS as f64;
        [y + along * down[0], z + along * down[1]]
    }));
    let left = half.iter().rev().map(|[y, z]| [-y, *z]);
    let points: Vec<[f64; 2]> = left.chain(half[1..].iter().copied()).collect();
    let points: Vec<[f64; 2]> = points.into_iter().map(|point| point.map(|x| 1e-3 * x)).collect();
    Ok(from_origin(Outline::new(&points, 0.0)?, Body::Rail))
}

/// Ends of the parts of the wheel S1002, from the back of the flange to the field side [mm].
const PARTS: [f64; 9] = [
    -70.0,
    -62.764705882,
    -49.662510381,
    -39.764473993,
    -38.426669071,
    -35.0,
    -26.0,
    32.15796,
    60.0,
];
/// Coefficients of the tread from −26 mm on, in ascending order.
const TREAD: [f64; 9] = [
    0.0,
    -3.358537058e-2,
    1.565681624e-3,
    -2.810427944e-5,
    5.844240864e-8,
    -1.562379023e-8,
    5.309217349e-15,
    -5.957839843e-12,
    2.646656573e-13,
];
/// Coefficients of the part next to the throat.
const ROOT: [f64; 8] = [
    -4.320221063e3,
    -1.038384026e3,
    -1.065501873e2,
    -6.051367875,
    -2.054332446e-1,
    -4.169739389e-3,
    -4.687195829e-5,
    -2.252755540e-7,
];

/// Circular parts: depth of the centre, radius, y of the centre [mm], and the side of the centre.
const ARCS: [([f64; 3], f64); 4] = [
    ([9.519259302, 20.5, -49.5], 1.0),
    ([16.0, 12.0, -55.0], 1.0),
    ([8.834924130, 20.0, -58.558326413], 1.0),
    ([16.446, 13.0, -26.210665], -1.0),
];

/// Depth of the wheel S1002 below its tape circle over y, both in mm, from −70 mm to 60 mm.
#[must_use]
pub fn s1002_depth(y: f64) -> f64 {
    let polynomial =
        |of: &[f64]| of.iter().rev().fold(0.0, |sum, coefficient| sum * y + coefficient);
    let arc = |([depth, radius, at], side): ([f64; 3], f64)| {
        depth + side * (radius * radius - (y - at).powi(2)).max(0.0).sqrt()
    };
    match PARTS.partition_point(|end| *end < y) {
        0 | 1 => arc(ARCS[0]),
        2 => arc(ARCS[1]),
        3 => arc(ARCS[2]),
        4 => -93.576667419 - 2.747477419 * y,
        5 => arc(ARCS[3]),
        6 => polynomial(&ROOT),
        7 => polynomial(&TREAD),
        _ => 1.364323640 - 0.066666667 * y,
    }
}

/// Wheel S1002.
///
/// # Errors
/// Never fails: the points of the standard form a valid curve.
pub fn wheel_s1002() -> Result<Outline, OutlineError> {
    let mut points = Vec::new();
    for (part, pair) in PARTS.windows(2).enumerate() {
        let places: Box<dyn Fn(f64) -> f64> =
            match [0, 1, 2, 9, 3].get(part).and_then(|k| ARCS.get(*k)) {
                // On an arc, at equal angles.
                Some(([_, radius, at], _)) => {
                    let angle = |y: f64| ((y - at) / radius).clamp(-1.0, 1.0).asin();
                    let [from, to] = [angle(pair[0]), angle(pair[1])];
                    Box::new(move |share| at + radius * (from + share * (to - from)).sin())
                }
                None => Box::new(move |share| pair[0] + share * (pair[1] - pair[0])),
            };
        let longest = (pair[1] - pair[0]).max((s1002_depth(pair[1]) - s1002_depth(pair[0])).abs());
        let count = (longest / STEP).ceil() as usize;
        let first = usize::from(part > 0);
        points.extend((first..=count).map(|k| {
            let y = places(k as f64 / count as f64).clamp(pair[0], pair[1]);
            [1e-3 * y, -1e-3 * s1002_depth(y)]
        }));
    }
    Ok(from_origin(Outline::new(&points, 0.0)?, Body::Wheel))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Width of 72 mm at 14 mm below the top, as in the standard, and the radii of the arcs.
    #[test]
    fn the_rail_has_the_width_and_the_radii_of_the_standard() {
        let rail = rail_60e1().unwrap();
        assert_eq!(rail.kinks().count(), 0);
        let [from, to] = rail.range();
        assert!((from + to).abs() < 1e-12);
        let width = |k: usize| rail.at(from + (to - from) * k as f64 / 2000.0).position;
        let side = (0..2000).map(width).find(|[_, z]| *z > -14.1e-3).unwrap();
        assert!((side[0] + 36e-3).abs() < 0.1e-3, "{side:?}");
        for (s, radius) in [(0.0, 0.3), (18e-3, 0.08), (33e-3, 0.013)] {
            let turned = rail.at(s - 5e-4).angle() - rail.at(s + 5e-4).angle();
            assert!((1e-3 / turned / radius - 1.0).abs() < 0.01, "{s} {turned}");
        }
    }

    /// The parts meet, and the curve follows the formula.
    #[test]
    fn the_wheel_is_on_its_formula() {
        let wheel = wheel_s1002().unwrap();
        for end in &PARTS[1..8] {
            let step = s1002_depth(end - 1e-9) - s1002_depth(end + 1e-9);
            assert!(step.abs() < 2e-4, "{end} {step:e}");
        }
        assert_eq!(wheel.kinks().count(), 0);
        assert!(wheel.at(0.0).position[0].abs() < 1e-12);
        let [from, to] = wheel.range();
        let off = |k: usize| {
            let [y, z] = wheel.at(from + (to - from) * k as f64 / 5000.0).position;
            (z + 1e-3 * s1002_depth((1e3 * y).clamp(-70.0, 60.0))).abs()
        };
        let worst = (200..5000).map(off).fold(0.0, f64::max);
        assert!(worst < 5e-7, "{worst:e}");
        assert!((wheel.at(from).position[1] + 9.519259302e-3).abs() < 1e-9);
    }
}
