//! Gap between the bodies at a row of the rail, along its normal.
//!
//! The gap of a row is g(x), negative where the bodies penetrate each other. The weight of the row
//! in the reference of a patch is w = ∫g² dx over the negative part, and its position is ∫x g²
//! dx/w. A round wheel with the radius of curvature R has g = g_j + (x − x_j)²/2R there and
//! w = |g_j|^{5/2} √(2R) 16/15; the constant is dropped because R is nearly the same for all rows.
//!
//! Between columns of equal spacing h, g is the parabola through both values with the mean of both
//! second differences.

use numerics::quadrature::GAUSS_3;

/// Exponent of a gap in the weight of its row.
const WEIGHT: f64 = 2.5;

/// Gap between the bodies at one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gap {
    /// Least gap [m].
    pub(super) gap: f64,
    /// Position of the row's reference along the track [m].
    pub(super) x: f64,
    /// Range of x in which the gap is negative [m].
    pub(super) x_range: [f64; 2],
    /// Weight in the reference of a patch, in the same unit for all rows.
    pub(super) weight: f64,
}

/// Gap of a row where the bodies cannot touch.
pub(super) const OPEN: Gap = Gap { gap: f64::INFINITY, x: 0.0, x_range: [0.0; 2], weight: 0.0 };

impl Gap {
    /// Gap of a round wheel: the least gap at x, and the wheel's radius of curvature along x there
    /// [m].
    pub(super) fn round(gap: f64, x: f64, radius: f64) -> Self {
        let penetration = (-gap).max(0.0);
        let half = (2.0 * radius * penetration).sqrt();
        Self { gap, x, x_range: [x - half, x + half], weight: penetration.powf(WEIGHT) }
    }

    /// Same gap with x counted from another origin; the present origin is at `x` [m].
    pub(super) fn from(self, x: f64) -> Self {
        Self { x: x + self.x, x_range: self.x_range.map(|end| x + end), ..self }
    }

    /// Gap of a row from gaps at columns, `first` being the first and `step` their spacing [m]. An
    /// infinite gap means no body.
    pub(super) fn along(first: f64, step: f64, gaps: &[f64]) -> Self {
        let Some([x, gap]) = lowest(first, step, gaps) else { return OPEN };
        let place = |at: usize| first + at as f64 * step;
        let curvature = |at: usize| curvature(gaps, at, step);
        let mut sum = Sum::default();
        for left in 0..gaps.len() - 1 {
            let [one, next] = [gaps[left], gaps[left + 1]];
            if one.is_finite() && next.is_finite() {
                let bends = [curvature(left), curvature(left + 1)];
                let inner = bends.iter().filter(|bend| **bend != 0.0).count().max(1) as f64;
                sum.add(place(left), step, [one, next], (bends[0] + bends[1]) / inner);
            }
        }
        match sum.weight > 0.0 {
            true => {
                Self { gap, x: sum.moment / sum.weight, x_range: sum.range, weight: sum.weight }
            }
            false => Self { gap: gap.max(0.0), x, x_range: [x, x], weight: 0.0 },
        }
    }
}

/// Second derivative at a column from its neighbours [1/m]; 0 at an end.
fn curvature(gaps: &[f64], at: usize, step: f64) -> f64 {
    match (at.checked_sub(1).map(|k| gaps[k]), gaps.get(at + 1)) {
        (Some(before), Some(behind)) if before.is_finite() && behind.is_finite() => {
            (before - 2.0 * gaps[at] + behind) / (step * step)
        }
        _ => 0.0,
    }
}

/// Position and value of the least gap, by a parabola through the lowest column and its neighbours.
/// Columns begin at `first`, `step` apart [m]; `None` if no gap is finite.
pub(super) fn lowest(first: f64, step: f64, gaps: &[f64]) -> Option<[f64; 2]> {
    let by_gap = |a: &usize, b: &usize| gaps[*a].total_cmp(&gaps[*b]);
    let least = (0..gaps.len()).min_by(by_gap).filter(|at| gaps[*at] < f64::INFINITY)?;
    let place = first + least as f64 * step;
    let bend = curvature(gaps, least, step);
    if bend <= 0.0 {
        return Some([place, gaps[least]]);
    }
    let slope = (gaps[least + 1] - gaps[least - 1]) / (2.0 * step);
    Some([place - slope / bend, gaps[least] - 0.5 * slope * slope / bend])
}

/// ∫g² dx and ∫x g² dx over the negative part of g, and its ends.
#[derive(Clone, Copy, Debug)]
struct Sum {
    weight: f64,
    moment: f64,
    range: [f64; 2],
}

impl Default for Sum {
    fn default() -> Self {
        Self { weight: 0.0, moment: 0.0, range: [f64::INFINITY, f64::NEG_INFINITY] }
    }
}

impl Sum {
    /// Adds a parabola over a `step` from x = `from` on, with these values at its ends and this
    /// second derivative.
    fn add(&mut self, from: f64, step: f64, [one, next]: [f64; 2], bend: f64) {
        let slope = (next - one) / step;
        let value = |x: f64| one + slope * x - 0.5 * bend * x * (step - x);
        let mut ends = [0.0, f64::NAN, f64::NAN, step];
        // 0 = one + (slope − bend step/2) x + bend x²/2.
        let (a, b) = (0.5 * bend, slope - 0.5 * bend * step);
        let root = b * b - 4.0 * a * one;
        if a == 0.0 && b != 0.0 {
            ends[1] = -one / b;
        } else if a != 0.0 && root > 0.0 {
            // Stable quadratic formula: no root by the difference of nearly equal numbers.
            let q = -0.5 * (b + root.sqrt().copysign(b));
            ends[1] = (q / a).min(one / q);
            ends[2] = (q / a).max(one / q);
        }
        let mut last = 0.0;
        for end in ends.into_iter().filter(|end| *end > 0.0 && *end <= step) {
            let (middle, half) = (0.5 * (last + end), 0.5 * (end - last));
            if value(middle) < 0.0 && half > 0.0 {
                for (at, weight) in GAUSS_3 {
                    let x = middle + half * at;
                    let square = half * weight * value(x).powi(2);
                    self.weight += square;
                    self.moment += square * (from + x);
                }
                self.range = [self.range[0].min(from + last), self.range[1].max(from + end)];
            }
            last = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For columns on a circle, position, least gap, ends and weight agree with the parabola.
    /// Tolerances: the circle's fourth order, and the parabola of the columns beside a root.
    #[test]
    fn columns_of_a_circle_are_the_circle() {
        let (radius, x) = (0.46_f64, 3.37e-4);
        for penetration in [2e-8, 3e-6, 1e-4, 8e-4] {
            let gap = |at: f64| radius - (radius * radius - (at - x).powi(2)).sqrt() - penetration;
            let gaps: Vec<f64> = (-40..=40).map(|k| gap(1e-3 * f64::from(k))).collect();
            let found = Gap::along(-40e-3, 1e-3, &gaps);
            let expected = Gap::round(-penetration, x, radius);
            assert!((found.gap - expected.gap).abs() < 1e-11, "{found:?}");
            assert!((found.x - x).abs() < 1e-8, "{found:?}");
            for k in 0..2 {
                let off = (found.x_range[k] - expected.x_range[k]).abs();
                assert!(off < 2e-3 * (2.0 * radius * penetration).sqrt(), "{found:?} {expected:?}");
            }
            let weight = expected.weight * (2.0 * radius).sqrt() * 16.0 / 15.0;
            assert!((found.weight / weight - 1.0).abs() < 4e-3, "{penetration} {found:?} {weight}");
        }
        assert_eq!(Gap::along(0.0, 1.0, &[f64::INFINITY; 4]), OPEN);
        let apart = Gap::along(0.0, 1.0, &[2.0, 1.0, 2.0, f64::INFINITY]);
        assert_eq!((apart.gap, apart.weight), (1.0, 0.0));
    }

    /// Two places of penetration give one range, from the start of the first to the end of the
    /// second.
    #[test]
    fn two_places_are_one_range() {
        let gap = |x: f64| (x.abs() - 20e-3).powi(2) - 1e-6;
        let gaps: Vec<f64> = (-40..=40).map(|k| gap(1e-3 * f64::from(k))).collect();
        let found = Gap::along(-40e-3, 1e-3, &gaps);
        assert!(found.x.abs() < 1e-12);
        assert!((found.x_range[0] + 21e-3).abs() < 1e-9 && (found.x_range[1] - 21e-3).abs() < 1e-9);
    }
}
