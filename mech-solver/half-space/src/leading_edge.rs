//! Leading edges of a computed pressure, and its means over rows that begin there.
//!
//! Where the curvature along x is constant, as on wheels, the pressure along a row is nearly a half
//! ellipse, p² = k²(c² − (x − m)²). Least squares over the loaded elements without the outermost
//! ones give m, and k as a mean over some rows. The half chord follows from the load of the row,
//! q = ∫p dx,
//!
//! c = √(2q/(πk)),
//!
//! which the elements cut by the edges hardly disturb: on an ellipse the edge is known to 0.05
//! elements (rms). Rows too short for a fit have the k of the nearest others, and the middle of
//! their load.
//!
//! On the displaced elements the pressure is the mean of the half ellipse over the element, times
//! the ratio of the computed pressure to the mean on the regular grid. The ratio is interpolated
//! along the row, and the load of the row is kept.
//!
//! Pressures of other shapes, as under a bound or on rough surfaces, have no such rows.

use super::aligned::{AlignedGrid, Chord};
use grids::Structured;
use std::f64::consts::PI;

/// Least number of loaded elements in a row whose pressure is fitted.
const FITTED: usize = 5;
/// Largest distance between the edge by the load and the zero of the fit, in elements, in a row of
/// half an ellipse.
const APART: f64 = 0.5;
/// Rows with less than this share of the largest load of a row need not be half ellipses.
const SHARE: f64 = 0.05;

/// Rows on either side over which k is averaged, weighted with the squares of the loads.
const NEAR: usize = 2;

/// Pressure of elements in rows that begin at the leading edge.
#[derive(Clone, Debug, PartialEq)]
pub struct AlignedPressure {
    /// Grid whose rows begin at the leading edge.
    pub rows: AlignedGrid,
    /// Mean pressure of the elements [Pa].
    pub means: Vec<f64>,
    /// Edges of each row in contact.
    pub chords: Vec<Option<Chord>>,
}

/// Half ellipse of a row, and its load per unit of width [N/m].
#[derive(Clone, Copy, Debug)]
struct HalfEllipse {
    /// Slope k of the pressure over the half chord [Pa/m].
    slope: f64,
    /// Middle m and half chord c [m].
    middle: f64,
    half_chord: f64,
    load: f64,
}

impl HalfEllipse {
    /// Mean over an element of this centre and side; zero if its centre is outside.
    fn mean(&self, x: f64, side: f64) -> f64 {
        if (x - self.middle).abs() >= self.half_chord {
            return 0.0;
        }
        let integral = |x: f64| {
            let s = ((x - self.middle) / self.half_chord).clamp(-1.0, 1.0);
            0.5 * (s * (1.0 - s * s).max(0.0).sqrt() + s.asin())
        };
        let part = integral(x + 0.5 * side) - integral(x - 0.5 * side);
        self.slope * self.half_chord * self.half_chord * part / side
    }
}

/// Displaces the rows of a grid to the leading edges of a pressure. Returns `None` if the rows are
/// no half ellipses.
#[must_use]
pub fn align(grid: &Structured, pressure: &[f64]) -> Option<AlignedPressure> {
    let rows = half_ellipses(grid, pressure)?;
    let chord = |row: &HalfEllipse| Chord {
        trailing: row.middle - row.half_chord,
        leading: row.middle + row.half_chord,
    };
    let chords: Vec<_> = rows.iter().map(|row| row.as_ref().map(chord)).collect();
    let aligned = AlignedGrid::new(*grid, |j| chords[j].map(|chord: Chord| chord.leading));
    let mut means = Vec::with_capacity(pressure.len());
    for (j, (row, pressure)) in rows.iter().zip(pressure.chunks_exact(grid.ni)).enumerate() {
        let offset = aligned.offset(j);
        match row {
            Some(row) => means.extend(row_means(row, pressure, grid, offset)),
            None => means.extend(pressure.iter().map(|_| 0.0)),
        }
    }
    let [before, after] = [pressure, &means].map(|of| of.iter().sum::<f64>());
    means.iter_mut().for_each(|mean| *mean *= before / after);
    Some(AlignedPressure { rows: aligned, means, chords })
}

/// Pressure of the elements of a row displaced by `offset` [m].
fn row_means(row: &HalfEllipse, pressure: &[f64], grid: &Structured, offset: f64) -> Vec<f64> {
    let side = grid.dx();
    let inner = |i: usize| (grid.x(i) - row.middle).abs() < row.half_chord - 1.5 * side;
    let ratio = |i: usize| pressure[i] / row.mean(grid.x(i), side);
    let ratios: Vec<(usize, f64)> =
        (0..pressure.len()).filter(|i| inner(*i)).map(|i| (i, ratio(i))).collect();
    let at = |place: f64| interpolated(&ratios, place);
    let mean = |i: usize| row.mean(grid.x(i) + offset, side) * at(i as f64 + offset / side);
    let mut means: Vec<f64> = (0..pressure.len()).map(mean).collect();
    let sum: f64 = means.iter().sum::<f64>() * side;
    if sum > 0.0 {
        means.iter_mut().for_each(|mean| *mean *= row.load / sum);
    }
    means
}

/// Interpolates ratios at ascending, consecutive elements of a row at any place [elements]. Beyond
/// the ends the ratio is that of the nearest element; without ratios it is 1.
pub(super) fn interpolated(ratios: &[(usize, f64)], place: f64) -> f64 {
    let (Some((first, low)), Some((last, high))) = (ratios.first(), ratios.last()) else {
        return 1.0;
    };
    if place <= *first as f64 {
        return *low;
    }
    let from_first = place - *first as f64;
    let k = from_first.floor() as usize;
    match ratios.get(k + 1) {
        Some((_, next)) if place < *last as f64 => {
            let share = from_first - k as f64;
            (1.0 - share) * ratios[k].1 + share * next
        }
        _ => *high,
    }
}

/// Half ellipses of the rows with a pressure; `None` if they are none.
fn half_ellipses(grid: &Structured, pressure: &[f64]) -> Option<Vec<Option<HalfEllipse>>> {
    let side = grid.dx();
    let rows: Vec<&[f64]> = pressure.chunks_exact(grid.ni).collect();
    let loads: Vec<f64> = rows.iter().map(|row| side * row.iter().sum::<f64>()).collect();
    let largest = loads.iter().copied().fold(0.0, f64::max);
    let mut fits = vec![None; rows.len()];
    for ((fit, row), load) in fits.iter_mut().zip(&rows).zip(&loads) {
        let counts = *load >= SHARE * largest;
        match parabola(grid, row) {
            Some([slope, middle, zero]) => {
                let half_chord = (2.0 * load / (PI * slope)).sqrt();
                if counts && (half_chord - zero).abs() > APART * side {
                    return None;
                }
                *fit = Some((slope, middle));
            }
            None if counts && run(row)?.len() >= FITTED => return None,
            None => {}
        }
    }
    let slope = |j: usize| -> Option<f64> {
        let fitted = || fits.iter().enumerate().filter_map(|(at, fit)| fit.map(|fit| (at, fit)));
        let nearest = fitted().map(|(at, _)| at.abs_diff(j)).min()?;
        let near = fitted().filter(|(at, _)| at.abs_diff(j) <= nearest.max(NEAR));
        let [sum, weights] = near.fold([0.0; 2], |[sum, weights], (at, (slope, _))| {
            let weight = loads[at].powi(2);
            [sum + weight * slope, weights + weight]
        });
        Some(sum / weights)
    };
    let ellipse = |j: usize| -> Option<Option<HalfEllipse>> {
        if loads[j] <= 0.0 {
            return Some(None);
        }
        let slope = slope(j)?;
        let weighted: f64 = rows[j].iter().enumerate().map(|(i, p)| p * grid.x(i)).sum();
        let centre = weighted * side / loads[j];
        let middle = fits[j].map_or(centre, |(_, middle)| middle);
        let half_chord = (2.0 * loads[j] / (PI * slope)).sqrt();
        Some(Some(HalfEllipse { slope, middle, half_chord, load: loads[j] }))
    };
    (0..rows.len()).map(ellipse).collect()
}

/// Indices of the loaded elements of a row; `None` if there are several runs, or none.
fn run(row: &[f64]) -> Option<std::ops::Range<usize>> {
    let first = row.iter().position(|p| *p > 0.0)?;
    let last = row.iter().rposition(|p| *p > 0.0)?;
    row[first..=last].iter().all(|p| *p > 0.0).then_some(first..last + 1)
}

/// Least squares of p² by a parabola over the loaded elements without the outermost ones: its slope
/// k, its middle and half the distance of its zeros.
fn parabola(grid: &Structured, row: &[f64]) -> Option<[f64; 3]> {
    let run = run(row).filter(|run| run.len() >= FITTED)?;
    let inner = run.start + 1..run.end - 1;
    // Coordinates from the middle of the run, in elements.
    let middle = 0.5 * (inner.start + inner.end - 1) as f64;
    let mut sums = [0.0; 5];
    let mut right = [0.0; 3];
    for i in inner {
        let s = i as f64 - middle;
        let square = row[i] * row[i];
        (0..5).for_each(|power| sums[power] += s.powi(power as i32));
        (0..3).for_each(|power| right[power] += square * s.powi(power as i32));
    }
    let matrix = nalgebra::Matrix3::from_fn(|i, j| sums[i + j]);
    let found = matrix.lu().solve(&nalgebra::Vector3::from(right))?;
    let [constant, linear, square] = [found[0], found[1], found[2]];
    if square >= 0.0 {
        return None;
    }
    let at = -0.5 * linear / square;
    let top = constant - square * at * at;
    let side = grid.dx();
    let slope = (-square).sqrt() / side;
    Some([slope, grid.x(0) + (middle + at) * side, (top / -square).sqrt() * side])
}
