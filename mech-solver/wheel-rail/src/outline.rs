//! A profile as a plane curve (y(s), z(s)) over the length s of its chords, so that it may be
//! vertical or overhang: natural cubic splines between kinks, smoothed within a tolerance if one is
//! given.
//!
//! Both coordinates are splines over s with the same kinks and the same λ ([`crate::spline`]), so
//! that turning or mirroring a profile gives the same curve, turned or mirrored. |dr/ds| differs
//! from 1 by (κh)²/24, with the curvature κ and the spacing h of points: 3e-5 on an arc of 13 mm
//! with points every 0.35 mm. s runs along the measured points, from the origin set by
//! [`Outline::starting_at`].
//!
//! Smoothing of a wavelength L uses λ = (L/2π)⁴/h with the mean spacing h, for which the splines
//! halve a wave of that length. No tolerance applies, so that profiles that belong together are all
//! smoothed alike. Corners of less than 30° are smoothed too. CONTACT's λ without weights is the
//! same, in mm³.
//!
//! Points closer than [`CLOSEST`] to the previous one are omitted: the rounding of a file with
//! seven digits turns such a chord by as much as a kink. Beyond its ends the curve continues
//! straight, for iterations that go there; there is no material.

use crate::spline::{kinks, smoothed, smoothest};
use std::f64::consts::{PI, TAU};

/// Points closer than this are merged [m].
pub const CLOSEST: f64 = 1e-6;
/// Least number of points.
const FEWEST: usize = 4;
/// Least angle of a corner that smoothing by wavelength keeps [rad].
const CORNER: f64 = PI / 6.0;
/// Turn of a chord beyond which the curve runs back on itself [rad].
const MOST_TURN: f64 = 5.0 / 6.0 * PI;

/// A plane curve through measured points.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Length of the chords, from the origin [m].
    length: Vec<f64>,
    /// Points y and z [m].
    points: Vec<[f64; 2]>,
    /// Second derivatives with respect to s [1/m]; zero at kinks and ends.
    bend: Vec<[f64; 2]>,
    /// Indices of the kinks, in ascending order.
    kinks: Vec<usize>,
    /// Largest distance by which smoothing moved a point [m].
    moved: f64,
}

/// Smoothing of points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Smoothing {
    /// Moves no point by more than this distance [m]; 0 for no smoothing.
    Within(f64),
    /// Halves the amplitude of waves of this length [m], equally for every profile.
    Halving(f64),
}

/// Reason why points do not form a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OutlineError {
    /// Too few points.
    #[error("it has {0} distinct points, and a curve needs {FEWEST}")]
    Few(usize),
    /// The curve turns back on itself, as where two measurements are joined.
    #[error("the curve turns back on itself at point {0}; remove the points that overlap")]
    TurnsBack(usize),
}

/// A point of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// y and z [m].
    pub position: [f64; 2],
    /// Derivative of the position with respect to s [-], of a length of about 1.
    pub tangent: [f64; 2],
}

impl Place {
    /// Angle of the tangent from the y-axis [rad].
    #[must_use]
    pub fn angle(&self) -> f64 {
        self.tangent[1].atan2(self.tangent[0])
    }
}

impl Outline {
    /// Creates the curve through points (y, z) [m], with s = 0 at the first. Smoothing moves no
    /// point by more than `tolerance` [m]; with 0 the curve passes through all points.
    ///
    /// # Errors
    /// Fails if there are too few points, or if the points run back over the curve.
    pub fn new(points: &[[f64; 2]], tolerance: f64) -> Result<Self, OutlineError> {
        Self::smoothed(points, Smoothing::Within(tolerance))
    }

    /// Creates the curve through points (y, z) [m], smoothed as given, with s = 0 at the first.
    ///
    /// # Errors
    /// Fails if there are too few points, or if the points run back over the curve.
    pub fn smoothed(points: &[[f64; 2]], smoothing: Smoothing) -> Result<Self, OutlineError> {
        let (points, numbers) = apart(points);
        if points.len() < FEWEST {
            return Err(OutlineError::Few(points.len()));
        }
        let chords: Vec<[f64; 2]> =
            points.windows(2).map(|pair| [0, 1].map(|k| pair[1][k] - pair[0][k])).collect();
        let spacing: Vec<f64> = chords.iter().map(|chord| chord[0].hypot(chord[1])).collect();
        let turns: Vec<f64> = chords.windows(2).map(|pair| turn(pair[0], pair[1])).collect();
        if let Some(at) = turns.iter().position(|turn| turn.abs() > MOST_TURN) {
            return Err(OutlineError::TurnsBack(numbers[at + 1]));
        }
        let mut length = vec![0.0];
        length.extend(spacing.iter().scan(0.0, |sum, step| {
            *sum += step;
            Some(*sum)
        }));
        let kinks = match smoothing {
            Smoothing::Within(tolerance) => kinks(&spacing, &turns, tolerance),
            Smoothing::Halving(_) => kinks(&spacing, &turns, 0.0)
                .into_iter()
                .filter(|at| turns[at - 1].abs() > CORNER)
                .collect(),
        };
        let bend = vec![[0.0; 2]; points.len()];
        let mut curve = Self { length, points, bend, kinks, moved: 0.0 };
        let last = curve.points.len() - 1;
        let ends: Vec<usize> =
            std::iter::once(0).chain(curve.kinks.iter().copied()).chain([last]).collect();
        for pair in ends.windows(2) {
            curve.fit(pair[0], pair[1], smoothing);
        }
        Ok(curve)
    }

    /// Assembles a curve from points [m] at these lengths [m] and second derivatives with respect
    /// to the length [1/m].
    pub(super) fn of_parts(
        length: Vec<f64>,
        points: Vec<[f64; 2]>,
        bend: Vec<[f64; 2]>,
        kinks: Vec<usize>,
    ) -> Self {
        Self { length, points, bend, kinks, moved: 0.0 }
    }

    /// Fits the points from `first` to `last`; these two stay where they are.
    fn fit(&mut self, first: usize, last: usize, smoothing: Smoothing) {
        if last - first < 2 {
            return;
        }
        let length = &self.length[first..=last];
        let measured = [0, 1].map(|k| -> Vec<f64> {
            self.points[first..=last].iter().map(|point| point[k]).collect()
        });
        let spacing = (length[length.len() - 1] - length[0]) / (length.len() - 1) as f64;
        let of = |lambda: f64| {
            let both = [0, 1].map(|k| smoothed(length, &measured[k], lambda));
            let moves = both[0].moves.iter().zip(&both[1].moves);
            let moved = moves.fold(0.0, |most: f64, (y, z)| most.max(y.hypot(*z)));
            (both, moved)
        };
        let ([y, z], moved) = match smoothing {
            Smoothing::Within(tolerance) => smoothest(spacing, tolerance, of),
            Smoothing::Halving(wavelength) => of((wavelength / TAU).powi(4) / spacing),
        };
        self.moved = self.moved.max(moved);
        for at in first..=last {
            self.points[at] = [y.z[at - first], z.z[at - first]];
            self.bend[at] = [y.bend[at - first], z.bend[at - first]];
        }
    }

    /// First and last s [m].
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        [self.length[0], self.length[self.length.len() - 1]]
    }

    /// s of the points [m].
    pub(super) fn lengths(&self) -> &[f64] {
        &self.length
    }

    /// Smoothed points [m].
    #[must_use]
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// s of the kinks [m].
    pub fn kinks(&self) -> impl Iterator<Item = f64> + '_ {
        self.kinks.iter().map(|at| self.length[*at])
    }

    /// Largest distance by which smoothing moved a point [m].
    #[must_use]
    pub fn moved(&self) -> f64 {
        self.moved
    }

    /// Point of the curve at s [m].
    #[must_use]
    pub fn at(&self, s: f64) -> Place {
        let right = self.length.partition_point(|length| *length <= s);
        self.on(right.clamp(1, self.length.len() - 1) - 1, s)
    }

    /// Point of the curve at s [m]. The search starts at the interval `near`, which receives the
    /// interval of s.
    #[must_use]
    pub fn at_near(&self, s: f64, near: &mut usize) -> Place {
        let last = self.length.len() - 2;
        let mut left = (*near).min(last);
        while left < last && s >= self.length[left + 1] {
            left += 1;
        }
        while left > 0 && s < self.length[left] {
            left -= 1;
        }
        *near = left;
        self.on(left, s)
    }

    /// Point of the curve at s in an interval, or beyond an end of the curve.
    fn on(&self, left: usize, s: f64) -> Place {
        let [from, to] = [self.length[left], self.length[left + 1]];
        let (width, inside) = (to - from, s.clamp(from, to));
        let b = (inside - from) / width;
        let a = 1.0 - b;
        let (weight_a, weight_b) = ((a * a * a - a) / 6.0, (b * b * b - b) / 6.0);
        let (slope_a, slope_b) = ((3.0 * a * a - 1.0) / 6.0, (3.0 * b * b - 1.0) / 6.0);
        let [start, end] = [self.points[left], self.points[left + 1]];
        let [bend_a, bend_b] = [self.bend[left], self.bend[left + 1]];
        let tangent = [0, 1].map(|k| {
            (end[k] - start[k]) / width + width * (slope_b * bend_b[k] - slope_a * bend_a[k])
        });
        let position = [0, 1].map(|k| {
            let cubic = width * width * (weight_a * bend_a[k] + weight_b * bend_b[k]);
            a * start[k] + b * end[k] + cubic + tangent[k] * (s - inside)
        });
        Place { position, tangent }
    }

    /// Shifts s, so that s = 0 where it is `s` now [m].
    #[must_use]
    pub fn starting_at(mut self, s: f64) -> Self {
        self.length.iter_mut().for_each(|length| *length -= s);
        self
    }

    /// Mirrors the curve at the z-axis and reverses its direction: (y, s) → (−y, −s).
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let last = self.points.len() - 1;
        let flip = |values: &[[f64; 2]]| values.iter().rev().map(|[y, z]| [-y, *z]).collect();
        Self {
            length: self.length.iter().rev().map(|length| -length).collect(),
            points: flip(&self.points),
            bend: flip(&self.bend),
            kinks: self.kinks.iter().rev().map(|at| last - at).collect(),
            moved: self.moved,
        }
    }

    /// Turns the curve about the origin, from y to z, by `angle` [rad], then shifts it by (y, z)
    /// [m].
    #[must_use]
    pub fn placed(&self, angle: f64, shift: [f64; 2]) -> Self {
        let (sin, cos) = angle.sin_cos();
        let turned = |[y, z]: &[f64; 2]| [cos * y - sin * z, sin * y + cos * z];
        Self {
            length: self.length.clone(),
            points: self
                .points
                .iter()
                .map(|point| {
                    let [y, z] = turned(point);
                    [y + shift[0], z + shift[1]]
                })
                .collect(),
            bend: self.bend.iter().map(turned).collect(),
            kinks: self.kinks.clone(),
            moved: self.moved,
        }
    }

    /// s between `from` and `to` where `value` is largest [m]: the best of many points, refined by
    /// golden sections.
    pub(super) fn largest(&self, [from, to]: [f64; 2], value: impl Fn(&Place) -> f64) -> f64 {
        const PLACES: usize = 1000;
        let of = |s: f64| value(&self.at(s));
        let step = (to - from) / PLACES as f64;
        let place = |k: usize| from + k as f64 * step;
        let best = (0..=PLACES).max_by(|a, b| of(place(*a)).total_cmp(&of(place(*b))));
        let best = place(best.unwrap_or(0));
        let [mut low, mut high] = [(best - step).max(from), (best + step).min(to)];
        let share = 0.5 * (5.0_f64.sqrt() - 1.0);
        while high - low > 1e-9 * step {
            let [left, right] = [high - share * (high - low), low + share * (high - low)];
            *(if of(left) < of(right) { &mut low } else { &mut high }) =
                if of(left) < of(right) { left } else { right };
        }
        0.5 * (low + high)
    }
}

/// Angle from one chord to the next [rad].
fn turn(one: [f64; 2], next: [f64; 2]) -> f64 {
    let angle = next[1].atan2(next[0]) - one[1].atan2(one[0]);
    angle - TAU * (angle / TAU).round()
}

/// Points at least [`CLOSEST`] from the previous one, and their numbers.
fn apart(points: &[[f64; 2]]) -> (Vec<[f64; 2]>, Vec<usize>) {
    let (mut kept, mut numbers) = (Vec::<[f64; 2]>::new(), Vec::new());
    for (number, point) in points.iter().enumerate() {
        let far = |last: &[f64; 2]| (point[0] - last[0]).hypot(point[1] - last[1]) >= CLOSEST;
        if kept.last().is_none_or(far) {
            kept.push(*point);
            numbers.push(number);
        }
    }
    (kept, numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(radius: f64, count: i32) -> Vec<[f64; 2]> {
        let angle = |k: i32| 2.5 * f64::from(k) / f64::from(count);
        (-count..=count).map(angle).map(|a| [radius * a.sin(), radius * a.cos()]).collect()
    }

    /// A circle beyond the vertical. Both coordinates are of fourth order between the points, away
    /// from the ends, where the natural spline is straight.
    #[test]
    fn a_circle_is_followed_beyond_the_vertical() {
        let error = |count: i32| {
            let curve = Outline::new(&circle(13e-3, count), 0.0).unwrap();
            assert_eq!(curve.kinks().count(), 0);
            let [from, to] = curve.range();
            let place = |k: i32| curve.at(from + (to - from) * f64::from(k) / 1000.0);
            let off = |k: i32| {
                let [y, z] = place(k).position;
                (y.hypot(z) / 13e-3 - 1.0).abs()
            };
            (200..800).map(off).fold(0.0, f64::max)
        };
        let (coarse, fine) = (error(40), error(80));
        assert!(coarse < 2e-7 && coarse / fine > 14.0, "{coarse:e} {fine:e}");
    }

    #[test]
    fn a_turned_curve_is_the_same_curve() {
        let curve = Outline::new(&circle(13e-3, 30), 0.0).unwrap().starting_at(4e-3);
        let turned = curve.placed(0.4, [1.0, 2.0]);
        for k in 0..50 {
            let s = -5e-3 + 1e-3 * f64::from(k);
            let Place { position: [y, z], tangent } = curve.at(s);
            let (sin, cos) = 0.4_f64.sin_cos();
            let [expected_y, expected_z] = [cos * y - sin * z + 1.0, sin * y + cos * z + 2.0];
            let [found_y, found_z] = turned.at(s).position;
            assert!((found_y - expected_y).hypot(found_z - expected_z) < 1e-15);
            assert!((turned.at(s).angle() - tangent[1].atan2(tangent[0]) - 0.4).abs() < 1e-12);
            let mut near = 7;
            assert_eq!(turned.at_near(s, &mut near), turned.at(s));
            let mirror = curve.mirrored().at(-s);
            assert!(
                (mirror.position[0] + y).abs() < 1e-17
                    && (mirror.tangent[1] + tangent[1]).abs() < 1e-14
            );
        }
    }

    /// Noise of one micrometre is smoothed away by a tolerance of two; a corner is kept.
    #[test]
    fn noise_goes_and_a_corner_stays() {
        let mut noise = 1_u64;
        let mut random = || {
            noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (noise >> 40) as f64 / f64::from(1 << 23) - 1.0
        };
        let corner = |s: f64| if s < 0.0 { [s, 0.0] } else { [0.6 * s, -0.8 * s] };
        let points: Vec<[f64; 2]> = (-40..=40)
            .map(|k| corner(0.5e-3 * f64::from(k)).map(|value| value + 1e-6 * random()))
            .collect();
        let curve = Outline::new(&points, 2e-6).unwrap();
        let kinks: Vec<f64> = curve.kinks().map(|s| (s * 1e4).round()).collect();
        assert_eq!(kinks, [200.0]);
        assert!(curve.moved() <= 2e-6);
        let angle = curve.at(10e-3).angle();
        assert!(angle.abs() < 5e-4, "{angle}");
    }

    /// A wave on a straight line. At the smoothing wavelength half of it remains, at half that
    /// length a seventeenth, at twice that length all but a seventeenth.
    #[test]
    fn waves_of_a_wavelength_are_halved() {
        let (length, height) = (8e-3, 1e-6);
        for (share, left) in [(1.0, 0.5), (0.5, 1.0 / 17.0), (2.0, 16.0 / 17.0)] {
            let wave = |y: f64| height * (TAU * y / (share * length)).cos();
            let points: Vec<[f64; 2]> =
                (-200..=200).map(|k| 0.2e-3 * f64::from(k)).map(|y| [y, wave(y)]).collect();
            let curve = Outline::smoothed(&points, Smoothing::Halving(length)).unwrap();
            let [.., middle] = curve.at(curve.lengths()[200]).position;
            assert!((middle / height - left).abs() < 5e-3, "{share}: {middle:e}");
        }
    }

    #[test]
    fn points_that_are_no_curve_are_refused() {
        let few = Outline::new(&[[0.0, 0.0], [1e-9, 0.0], [1.0, 0.0], [2.0, 0.0]], 0.0);
        assert_eq!(few, Err(OutlineError::Few(3)));
        let mut points: Vec<[f64; 2]> = (0..9).map(|k| [f64::from(k), 0.0]).collect();
        points[5] = [3.5, 0.0];
        assert_eq!(Outline::new(&points, 0.0), Err(OutlineError::TurnsBack(4)));
    }
}
