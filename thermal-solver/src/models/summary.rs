//! The thermal part of `summary.json`.

use crate::{LOWER, UPPER};
use numerics::search::{maximum, root_of_decreasing};
use proto::bodies::Bodies;
use proto::grid::Structured;
use serde_json::{Map, Value, json};

/// Largest number of strips that are listed.
const MOST_STRIPS: usize = 32;
/// Undershoot below the initial temperature, relative to the highest rise, above which a negative
/// rise is reported.
const UNDERSHOOT: f64 = 1e-3;
/// Share of the highest rise from which on an element counts as hottest. Between surfaces in
/// contact the exchanged flux, and with it the rise, has a relative error of some 1e-7.
const AS_HOT: f64 = 1.0 - 1e-6;

/// Hottest point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Temperature rise [K].
    pub rise: f64,
    /// Coordinate x [m]; not restricted to element centres.
    pub x: f64,
    /// Index of the row.
    pub row: usize,
}

/// Accepted state of a model as the summary reads it. The index `body` is upper or lower.
pub(super) trait Solution {
    /// Grid of the surface temperatures.
    fn grid(&self) -> &Structured;

    /// Rises of a surface [K].
    fn surface(&self, body: usize) -> &[f64];

    /// Returns the hottest point of a body among the rows in which these rises are not zero; `None`
    /// if no rise is positive.
    fn peak(&self, body: usize, rise: &[f64]) -> Option<Peak>;

    /// Rise [K] at any x [m] of a row, at a depth below the surface [m].
    fn rise_at(&self, body: usize, row: usize, x: f64, depth: f64) -> f64;

    /// Typical depth over which the rises change [m].
    fn depth_scale(&self, body: usize) -> f64;

    /// Rise of a row before the passage [K]; it is included in the surface rises only.
    fn background(&self, _body: usize, _row: usize) -> f64 {
        0.0
    }
}

/// Returns the hottest point of a surface with these rises [K]. The maximum of `rise_at(row, x)` is
/// sought in the row of the hottest element, between the centres of its neighbours.
pub(super) fn hottest(
    grid: &Structured,
    rise: &[f64],
    rise_at: impl Fn(usize, f64) -> f64,
) -> Option<Peak> {
    let hottest = (0..rise.len()).reduce(|a, b| if rise[b] > rise[a] { b } else { a })?;
    near(grid, rise, hottest, rise_at)
}

/// Returns the hottest point of a surface that exchanges heat with the other one in the contact.
///
/// The rise may be uniform over the contact, and the hottest element is then a matter of rounding.
/// In a short row at the edge of the contact the flux jumps, so that the rise between the elements
/// exceeds that at their centres. Of the elements that are as hot as the hottest, the one nearest
/// to their centroid is used.
pub(super) fn hottest_in_contact(
    grid: &Structured,
    rise: &[f64],
    rise_at: impl Fn(usize, f64) -> f64,
) -> Option<Peak> {
    let highest = rise.iter().copied().fold(0.0, f64::max);
    let hot = || (0..rise.len()).filter(move |at| rise[*at] >= AS_HOT * highest);
    let place = |at: usize| [at % grid.ni, at / grid.ni];
    let mut sums = [0; 2];
    hot().for_each(|at| sums.iter_mut().zip(place(at)).for_each(|(sum, index)| *sum += index));
    let count = hot().count();
    // Integers, so that elements at equal distances compare as equal.
    let apart = |at: &usize| {
        let sides = place(*at).into_iter().zip(sums);
        sides.map(|(index, sum)| (count * index).abs_diff(sum).pow(2)).sum::<usize>()
    };
    near(grid, rise, hot().min_by_key(apart)?, rise_at)
}

/// Returns the hottest point between the neighbours of an element along its row; `None` if the rise
/// of the element is not positive.
fn near(
    grid: &Structured,
    rise: &[f64],
    hottest: usize,
    rise_at: impl Fn(usize, f64) -> f64,
) -> Option<Peak> {
    if rise[hottest] <= 0.0 {
        return None;
    }
    let (row, column) = (hottest / grid.ni, hottest % grid.ni);
    let (low, high) = (grid.x(column.saturating_sub(1)), grid.x((column + 1).min(grid.ni - 1)));
    let (x, rise) = maximum(low, high, |x| rise_at(row, x));
    Some(Peak { rise, x, row })
}

/// Returns `{"temperature": {NAME: {...}, NAME: {...}}}`, with the names of the case.
///
/// If no rise is positive there is no hottest point: the rise is 0, and coordinates and depth are
/// omitted. A surface that loses heat also has a lowest rise. Several heated strips, separated by
/// cold rows, are listed with a hottest point each.
pub(super) fn temperature(names: &Bodies, solution: &dyn Solution) -> Value {
    let grid = solution.grid();
    let section = |body: usize| {
        let rise = solution.surface(body);
        let coldest = rise.iter().copied().fold(0.0, f64::min);
        let Some(peak) = solution.peak(body, rise) else {
            let mut section = json!({"max_rise_k": 0.0});
            if coldest < 0.0 {
                section["min_rise_k"] = json!(coldest);
            }
            return section;
        };
        let mut section = place(grid, peak);
        // Smaller undershoots are artefacts of the piecewise parabolic flux at its jumps.
        if coldest < -UNDERSHOOT * peak.rise {
            section.insert("min_rise_k".to_owned(), json!(coldest));
        }
        if let Some(depth) = penetration(solution, body, peak) {
            section.insert("penetration_depth_m".to_owned(), json!(depth));
        }
        let strips = strips(grid.ni, rise);
        if strips.len() > 1 {
            let strips = strips.iter().take(MOST_STRIPS);
            let each = strips.filter_map(|rows| strip(solution, body, *rows));
            section.insert("each_strip".to_owned(), Value::Array(each.collect()));
        }
        Value::Object(section)
    };
    let [upper, lower] = &names.0;
    json!({"temperature": {lower: section(LOWER), upper: section(UPPER)}})
}

fn place(grid: &Structured, peak: Peak) -> Map<String, Value> {
    let figures = [("max_rise_k", peak.rise), ("x_m", peak.x), ("y_m", grid.y(peak.row))];
    figures.into_iter().map(|(key, value)| (key.to_owned(), json!(value))).collect()
}

/// First and last rows of the heated strips: adjacent rows with a positive rise.
fn strips(columns: usize, rise: &[f64]) -> Vec<[usize; 2]> {
    let mut strips: Vec<[usize; 2]> = Vec::new();
    for (row, values) in rise.chunks_exact(columns).enumerate() {
        if values.iter().any(|rise| *rise > 0.0) {
            match strips.last_mut() {
                Some([_, last]) if *last + 1 == row => *last = row,
                _ => strips.push([row, row]),
            }
        }
    }
    strips
}

/// Returns the lateral bounds and the hottest point of a strip.
fn strip(solution: &dyn Solution, body: usize, [first, last]: [usize; 2]) -> Option<Value> {
    let (grid, rise) = (solution.grid(), solution.surface(body));
    let mut own = vec![0.0; rise.len()];
    let range = first * grid.ni..(last + 1) * grid.ni;
    own[range.clone()].copy_from_slice(&rise[range]);
    let mut figures = place(grid, solution.peak(body, &own)?);
    let half = 0.5 * grid.dy();
    figures.insert("y_from_m".to_owned(), json!(grid.y(first) - half));
    figures.insert("y_to_m".to_owned(), json!(grid.y(last) + half));
    Some(Value::Object(figures))
}

/// Depth [m] below the hottest point where the flash temperature has fallen to 1/e, found with the
/// model's own variation in depth.
fn penetration(solution: &dyn Solution, body: usize, peak: Peak) -> Option<f64> {
    let flash = peak.rise - solution.background(body, peak.row);
    let target = flash / std::f64::consts::E;
    let excess = |depth: f64| solution.rise_at(body, peak.row, peak.x, depth) - target;
    root_of_decreasing(solution.depth_scale(body), excess)
}
