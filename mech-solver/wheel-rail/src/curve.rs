//! A curve z(y) through measured points: natural cubic splines between kinks, smoothed within a
//! tolerance if one is given.
//!
//! *Why splines.* Pressure follows curvature. A smooth shape therefore needs an interpolation whose
//! curvature is continuous and converges. Shape-preserving interpolations of first order (monotone,
//! Akima) have steps of curvature at every point. Their merit is that they do not overshoot beside
//! a corner; here the spline ends at the corner instead. A spline through a corner that turns by τ
//! between points of spacing h swings about the chords by 0.08 τ h, 0.02 τ h, … on either side, and
//! a light contact touches on such a bump alone.
//!
//! Detection of kinks and smoothing: [`super::spline`].

use super::spline::{kinks, smoothed, smoothest};

/// Height z(y) by splines between kinks.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Coordinates y, in ascending order [m].
    y: Vec<f64>,
    /// Heights [m].
    z: Vec<f64>,
    /// Second derivatives [1/m]; zero at kinks and ends.
    bend: Vec<f64>,
    /// Indices of the kinks, in ascending order.
    kinks: Vec<usize>,
    /// Largest distance by which smoothing moved a point [m].
    moved: f64,
}

impl Curve {
    /// Creates the curve through points in ascending order of y. Smoothing moves no point by more
    /// than `tolerance` [m]; with 0 the curve passes through all points.
    ///
    /// # Panics
    /// Panics if there are fewer than two points, or if the numbers of y and z differ.
    #[must_use]
    pub fn new(y: Vec<f64>, z: Vec<f64>, tolerance: f64) -> Self {
        assert!(y.len() == z.len() && y.len() >= 2, "{} places, {} heights", y.len(), z.len());
        let spacing: Vec<f64> = y.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let slope = |k: usize| (z[k + 1] - z[k]) / spacing[k];
        let turns: Vec<f64> = (1..y.len() - 1).map(|k| slope(k) - slope(k - 1)).collect();
        let kinks = kinks(&spacing, &turns, tolerance);
        let mut curve = Self { bend: vec![0.0; y.len()], y, z, kinks, moved: 0.0 };
        let last = curve.y.len() - 1;
        let ends = std::iter::once(0).chain(curve.kinks.iter().copied()).chain([last]);
        let ends: Vec<usize> = ends.collect();
        for pair in ends.windows(2) {
            curve.fit(pair[0], pair[1], tolerance);
        }
        curve
    }

    /// First and last y [m].
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        [self.y[0], self.y[self.y.len() - 1]]
    }

    /// Number of points.
    #[must_use]
    pub fn points(&self) -> usize {
        self.y.len()
    }

    /// Points that the curve passes through [m].
    pub fn passed(&self) -> Vec<[f64; 2]> {
        self.y.iter().zip(&self.z).map(|(y, z)| [*y, *z]).collect()
    }

    /// y of the kinks [m].
    pub fn kinks(&self) -> impl Iterator<Item = f64> + '_ {
        self.kinks.iter().map(|at| self.y[*at])
    }

    /// Largest distance by which smoothing moved a point [m].
    #[must_use]
    pub fn moved(&self) -> f64 {
        self.moved
    }

    /// Height [m] and slope [-] at y [m]. Beyond the ends the curve continues straight.
    #[must_use]
    pub fn at(&self, y: f64) -> [f64; 2] {
        let [first, last] = self.range();
        let inside = y.clamp(first, last);
        let right = self.y.partition_point(|at| *at <= inside).clamp(1, self.y.len() - 1);
        let left = right - 1;
        let width = self.y[right] - self.y[left];
        let (b, a) = ((inside - self.y[left]) / width, (self.y[right] - inside) / width);
        let (bend_a, bend_b) = (self.bend[left], self.bend[right]);
        let cubic = (a.powi(3) - a) * bend_a + (b.powi(3) - b) * bend_b;
        let height = a * self.z[left] + b * self.z[right] + cubic * width * width / 6.0;
        let turn = (3.0 * b * b - 1.0) * bend_b - (3.0 * a * a - 1.0) * bend_a;
        let slope = (self.z[right] - self.z[left]) / width + turn * width / 6.0;
        [height + slope * (y - inside), slope]
    }

    /// Fits the points from `first` to `last`; these two stay where they are.
    fn fit(&mut self, first: usize, last: usize, tolerance: f64) {
        if last - first < 2 {
            return;
        }
        let (y, z) = (&self.y[first..=last], &self.z[first..=last]);
        let spacing = (y[y.len() - 1] - y[0]) / (y.len() - 1) as f64;
        let (best, moved) = smoothest(spacing, tolerance, |lambda| {
            let found = smoothed(y, z, lambda);
            let moved = found.moves.iter().fold(0.0, |most: f64, by| most.max(by.abs()));
            (found, moved)
        });
        self.moved = self.moved.max(moved);
        self.z[first..=last].copy_from_slice(&best.z);
        self.bend[first..=last].copy_from_slice(&best.bend);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Curve through points every half millimetre over ±20 mm.
    fn of(function: impl Fn(f64) -> f64, tolerance: f64) -> Curve {
        let y: Vec<f64> = (-40..=40).map(|k| 0.5e-3 * f64::from(k)).collect();
        let z = y.iter().map(|y| function(*y)).collect();
        Curve::new(y, z, tolerance)
    }

    fn places(curve: &Curve) -> Vec<f64> {
        curve.kinks().map(|y| (1e6 * y).round() / 1e3).collect()
    }

    /// Beside a corner the curve follows its chords, at the points and between them.
    #[test]
    fn a_corner_is_kept_and_nothing_overshoots() {
        let edge = |at: f64| move |y: f64| -0.05 * (y.abs() - at).max(0.0);
        let curve = of(edge(10e-3), 0.0);
        assert_eq!(places(&curve), [-10.0, 10.0]);
        for k in -2000..=2000 {
            let y = 1e-5 * f64::from(k);
            assert!((curve.at(y)[0] - edge(10e-3)(y)).abs() < 1e-15, "{y}");
        }
        // The chord cuts off a corner between two points, and no more than the corner.
        let curve = of(edge(10.2e-3), 0.0);
        assert_eq!(places(&curve), [-10.5, -10.0, 10.0, 10.5]);
        let highest = (0..2000).map(|k| curve.at(1e-5 * f64::from(k))[0]).fold(-1.0, f64::max);
        assert_eq!(highest, 0.0);
    }

    #[test]
    fn corners_close_to_each_other_on_a_crown() {
        let crown = |y: f64| -0.5 * y * y / 0.3;
        let groove = |y: f64| crown(y) - 1e-4 * f64::from(u8::from(y.abs() < 1.1e-3));
        assert_eq!(places(&of(crown, 0.0)), [0.0; 0]);
        assert_eq!(places(&of(groove, 0.0)), [-1.5, -1.0, 1.0, 1.5]);
        let lip = |y: f64| crown(y) + 0.02 * (y - 4e-3).max(0.0);
        assert_eq!(places(&of(lip, 0.0)), [4.0]);
    }

    /// Arcs that meet without a corner, as on every railhead: the curvature is discontinuous, the
    /// slope is continuous.
    #[test]
    fn arcs_and_roundings_are_no_kinks() {
        let arcs = |y: f64| {
            let y = y.abs();
            let parts = [(0.0, 1.0 / 0.3), (10e-3, 1.0 / 0.08), (15e-3, 1.0 / 0.013)];
            let mut last = 0.0;
            parts.iter().fold(0.0, |z, (from, curvature)| {
                let more = curvature - last;
                last = *curvature;
                z - 0.5 * more * (y - from).max(0.0).powi(2)
            })
        };
        assert_eq!(places(&of(arcs, 0.0)), [0.0; 0]);
        let flat_then_round = |y: f64| -0.5 * (y.abs() - 5e-3).max(0.0).powi(2) / 0.02;
        assert_eq!(places(&of(flat_then_round, 0.0)), [0.0; 0]);
        let bump = |y: f64| 1e-5 * (-0.5 * (y / 1e-3).powi(2)).exp();
        assert_eq!(places(&of(bump, 0.0)), [0.0; 0]);
    }

    /// Noise of one micrometre on a crown, from a linear congruential generator. The curvature over
    /// 5 mm is recovered to 5 % of the crown's, and no point moves by more than the tolerance.
    #[test]
    fn noise_is_smoothed_within_the_tolerance() {
        let noisy = |tolerance| {
            let mut seed = 1_u32;
            let y: Vec<f64> = (-80..=80).map(|k| 0.25e-3 * f64::from(k)).collect();
            let z = y.iter().map(|y| {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                -0.5 * y * y / 0.3 + 1e-6 * (f64::from(seed >> 8) / f64::from(1 << 23) - 1.0)
            });
            let z: Vec<f64> = z.collect();
            (Curve::new(y.clone(), z.clone(), tolerance), y, z)
        };
        let curvature = |curve: &Curve| {
            let slopes = [-10e-3, -5e-3, 0.0, 5e-3, 10e-3].map(|y| curve.at(y)[1]);
            slopes.windows(2).map(|pair| (pair[1] - pair[0]) / 5e-3 * 0.3).collect::<Vec<_>>()
        };
        let (rough, ..) = noisy(0.0);
        assert!(curvature(&rough).iter().any(|c| (c + 1.0).abs() > 0.1), "{:?}", curvature(&rough));
        let (smooth, y, z) = noisy(1.2e-6);
        assert_eq!(places(&smooth), [0.0; 0]);
        assert!(
            curvature(&smooth).iter().all(|c| (c + 1.0).abs() < 0.05),
            "{:?}",
            curvature(&smooth)
        );
        let farthest =
            y.iter().zip(&z).map(|(y, z)| (smooth.at(*y)[0] - z).abs()).fold(0.0, f64::max);
        assert!(farthest <= 1.2e-6 && (farthest - smooth.moved()).abs() < 1e-12, "{farthest}");
    }

    /// A corner above the tolerance is kept; a corner below the tolerance is smoothed.
    #[test]
    fn the_tolerance_decides_about_corners() {
        let roof = |y: f64| -0.01 * y.abs();
        assert_eq!(places(&of(roof, 4e-6)), [0.0]);
        let smooth = of(roof, 6e-6);
        assert_eq!(places(&smooth), [0.0; 0]);
        assert!(smooth.moved() > 1e-6 && smooth.moved() <= 6e-6);
    }
}
