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

/// Elements at either end of a row in contact whose rise is not resolved.
const UNRESOLVED: usize = 2;
/// Shortest row in contact with two resolved elements.
const SHORTEST_ROW: usize = 2 * UNRESOLVED + 2;
/// Rise over the largest change of temperature up to which a rise is rounding.
const FAINT: f64 = 1e-9;

/// Hottest point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Temperature rise [K].
    pub rise: f64,
    /// Coordinate x [m]; not restricted to element centres.
    pub x: f64,
    /// Coordinate y [m].
    pub y: f64,
    /// Index of the row nearest to the point.
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
    near(grid, rise, hottest, (0, grid.ni - 1), rise_at)
}

/// Returns the hottest point of a surface that exchanges heat with the other one in the elements
/// `touching`, in ascending order.
///
/// At the ends of a row of these elements the exchanged flux jumps. There the reconstructed flux,
/// which is zero at the ends, has errors of the order of the root of the length of an element: the
/// rise of an end element is 2 to 6 % of the rise in the contact too high, that between the
/// elements up to a half. [`UNRESOLVED`] elements at both ends are therefore not used, nor a rise
/// between elements that is not smooth. The rise at an end itself follows from the straight line
/// through the next two elements, but does not exceed the rises of the row.
///
/// The rise may be uniform over the contact, and the hottest element is then a matter of rounding.
/// Of the elements that are as hot as the hottest, the one nearest to their centroid is used.
pub(super) fn hottest_in_contact(
    grid: &Structured,
    rise: &[f64],
    touching: &[usize],
    rise_at: impl Fn(usize, f64) -> f64,
) -> Option<Peak> {
    let resolved = resolved(grid, rise, touching);
    let hottest = middle_of_hottest(grid, &resolved)?;
    let (row, column) = (hottest / grid.ni, hottest % grid.ni);
    let place = |at: &usize| *at / grid.ni == row;
    let own: Vec<usize> = touching.iter().copied().filter(place).map(|at| at % grid.ni).collect();
    let (Some(first), Some(last)) = (own.first().copied(), own.last().copied()) else {
        return near(grid, &resolved, hottest, (0, grid.ni - 1), rise_at);
    };
    let (x, half) = (grid.x(column), 0.5 * grid.dx());
    let resolves = own.len() >= SHORTEST_ROW;
    let at = |x: f64| Some(Peak { rise: resolved[hottest], x, y: grid.y(row), row });
    match column {
        _ if resolved[hottest] <= 0.0 => None,
        _ if resolves && column == first => at(x - half),
        _ if resolves && column == last => at(x + half),
        _ if resolves && (first..=last).contains(&column) => {
            let inner = (first + UNRESOLVED, last - UNRESOLVED);
            let beside = [column.max(inner.0 + 1) - 1, (column + 1).min(inner.1)];
            let beside = beside.map(|column| resolved[row * grid.ni + column]);
            let peak = near(grid, &resolved, hottest, inner, rise_at)?;
            let most = resolved[hottest] + most_between(resolved[hottest], beside);
            if peak.rise <= most { Some(peak) } else { at(x) }
        }
        _ if column > last + 1 => near(grid, &resolved, hottest, (last + 1, grid.ni - 1), rise_at),
        _ if column + 1 < first => near(grid, &resolved, hottest, (0, first - 1), rise_at),
        _ => at(x),
    }
}

/// Returns the rises [K] with those of resolved elements and of the ends of rows in contact, as
/// [`hottest_in_contact`] uses them; negative infinity for elements that are not used.
fn resolved(grid: &Structured, rise: &[f64], touching: &[usize]) -> Vec<f64> {
    let mut resolved = rise.to_vec();
    let follows = |a: &usize, b: &usize| a + 1 == *b && a / grid.ni == b / grid.ni;
    let rows = || touching.chunk_by(follows).filter(|row| row.len() >= SHORTEST_ROW);
    if rows().next().is_some() {
        touching.iter().for_each(|at| resolved[*at] = f64::NEG_INFINITY);
    }
    for row in rows() {
        let inner = &row[UNRESOLVED..row.len() - UNRESOLVED];
        inner.iter().for_each(|at| resolved[*at] = rise[*at]);
        let highest = row.iter().map(|at| rise[*at]).fold(f64::NEG_INFINITY, f64::max);
        let at_end = |near: usize, next: usize| {
            (rise[near] + (UNRESOLVED as f64 + 0.5) * (rise[near] - rise[next])).min(highest)
        };
        let last = inner.len() - 1;
        resolved[row[0]] = at_end(inner[0], inner[1]);
        resolved[row[row.len() - 1]] = at_end(inner[last], inner[last - 1]);
    }
    resolved
}

/// Returns the most by which a smooth rise exceeds that of the hottest element between this element
/// and its neighbours [K]: twice that of the parabola through them.
fn most_between(highest: f64, [before, after]: [f64; 2]) -> f64 {
    0.25 * (2.0 * highest - before - after)
}

/// Returns the element nearest to the centroid of those that are as hot as the hottest.
fn middle_of_hottest(grid: &Structured, rise: &[f64]) -> Option<usize> {
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
    hot().min_by_key(apart)
}

/// Returns the hottest point between the neighbours of an element along its row, of which only the
/// columns from the first to the second of `within` are used; `None` if the rise of the element is
/// not positive.
fn near(
    grid: &Structured,
    rise: &[f64],
    hottest: usize,
    within: (usize, usize),
    rise_at: impl Fn(usize, f64) -> f64,
) -> Option<Peak> {
    if rise[hottest] <= 0.0 {
        return None;
    }
    let (row, column) = (hottest / grid.ni, hottest % grid.ni);
    let low = grid.x(column.saturating_sub(1).max(within.0));
    let high = grid.x((column + 1).min(within.1));
    let (x, rise) = maximum(low, high, |x| rise_at(row, x));
    Some(Peak { rise, x, y: grid.y(row), row })
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
        let largest = rise.iter().fold(0.0_f64, |most, rise| most.max(rise.abs()));
        let faint = FAINT * largest;
        let Some(peak) = solution.peak(body, rise).filter(|peak| peak.rise > faint) else {
            let mut section = json!({"max_rise_k": 0.0});
            if coldest < 0.0 {
                section["min_rise_k"] = json!(coldest);
            }
            return section;
        };
        let mut section = place(peak);
        // Smaller undershoots are artefacts of the piecewise parabolic flux at its jumps.
        if coldest < -UNDERSHOOT * peak.rise {
            section.insert("min_rise_k".to_owned(), json!(coldest));
        }
        if let Some(depth) = penetration(solution, body, peak) {
            section.insert("penetration_depth_m".to_owned(), json!(depth));
        }
        let strips = strips(grid.ni, rise, faint);
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

fn place(peak: Peak) -> Map<String, Value> {
    let figures = [("max_rise_k", peak.rise), ("x_m", peak.x), ("y_m", peak.y)];
    figures.into_iter().map(|(key, value)| (key.to_owned(), json!(value))).collect()
}

/// First and last rows of the heated strips: adjacent rows with a rise above `faint` [K].
fn strips(columns: usize, rise: &[f64], faint: f64) -> Vec<[usize; 2]> {
    let mut strips: Vec<[usize; 2]> = Vec::new();
    for (row, values) in rise.chunks_exact(columns).enumerate() {
        if values.iter().any(|rise| *rise > faint) {
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
    let mut figures = place(solution.peak(body, &own)?);
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

#[cfg(test)]
mod tests {
    use super::*;

    /// At the ends of a row in contact neither the rises of elements nor those between elements are
    /// used; the ends follow from the straight line through the next two.
    #[test]
    fn jumps_of_the_flux_make_no_maximum() {
        let grid = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 12, 2);
        let touching: Vec<usize> = (1..=10).chain(15..=17).collect();
        let mut rise = vec![0.0; 24];
        rise[1..=10].fill(10.0);
        rise[15..=17].fill(30.0);
        rise[1] = 14.0;
        rise[10] = 12.0;
        let wild = |_: usize, x: f64| if (3.0..=8.0).contains(&x) { 10.0 } else { 99.0 };
        let peak = hottest_in_contact(&grid, &rise, &touching, wild).unwrap();
        assert_eq!((peak.rise, peak.row), (10.0, 0), "{peak:?}");
        // Rises that grow by one an element end two and a half above the last resolved element.
        (1..=10).for_each(|at| rise[at] = at as f64);
        rise[10] = 11.5;
        let peak = hottest_in_contact(&grid, &rise, &touching, wild).unwrap();
        assert_eq!((peak.rise, peak.x), (10.5, 10.5), "{peak:?}");
        // No row is long enough: the middles of elements are used.
        let short: Vec<usize> = (15..=17).collect();
        let peak = hottest_in_contact(&grid, &rise, &short, wild).unwrap();
        assert_eq!((peak.rise, peak.x, peak.y), (30.0, 4.0, 1.0), "{peak:?}");
    }
}
