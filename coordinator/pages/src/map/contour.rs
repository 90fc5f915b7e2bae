//! Contour lines through the centres of cells, by marching squares.
//!
//! Two-dimensional form of Lorensen and Cline 1987. Between two neighbouring cells, one above and
//! one below the level, the line crosses where linear interpolation gives the level. If the corners
//! of a square alternate, the line separates the corners above the level. Squares with a corner
//! that is not finite have no line.

use std::collections::HashMap;

/// A line through points; first and last point coincide if the line is closed.
pub type Polyline = Vec<[f64; 2]>;

/// Side between two neighbouring cells, given by their indices.
type Side = (usize, usize);

/// Contour lines of a level over cells in rows of `columns`. Coordinates count cells; (0, 0) is the
/// centre of the first cell.
#[must_use]
pub fn contours(values: &[f64], columns: usize, level: f64) -> Vec<Polyline> {
    let crossing = |a: usize, b: usize| (level - values[a]) / (values[b] - values[a]);
    contours_at(values, columns, level, crossing)
}

/// Like [`contours`], with lines that cross between two cells a and b at this part of the way.
#[must_use]
pub fn contours_at(
    values: &[f64],
    columns: usize,
    level: f64,
    crossing: impl Fn(usize, usize) -> f64,
) -> Vec<Polyline> {
    let rows = values.len() / columns;
    let mut pieces = Vec::new();
    for j in 1..rows {
        for i in 1..columns {
            let below = (j - 1) * columns + i - 1;
            let square = [below, below + 1, below + columns + 1, below + columns];
            if square.iter().all(|&cell| values[cell].is_finite()) {
                pieces.extend(cut(square, square.map(|cell| values[cell] > level)));
            }
        }
    }
    let cross = |(a, b): Side| {
        let part = crossing(a, b);
        let [x, y] = [a % columns, a / columns].map(|n| n as f64);
        if b - a == 1 { [x + part, y] } else { [x, y + part] }
    };
    let joined = join(&pieces).into_iter();
    joined.map(|line| line.into_iter().map(cross).collect()).collect()
}

/// Pieces of the line through a square, whose corners are numbered counter-clockwise from the lower
/// left.
fn cut(square: [usize; 4], above: [bool; 4]) -> impl Iterator<Item = [Side; 2]> {
    let side = move |n: usize| {
        let (a, b) = (square[n % 4], square[(n + 1) % 4]);
        (a.min(b), a.max(b))
    };
    // Start at each corner above the level whose predecessor is below, and end at the last corner
    // of its group.
    let begins = (0..4).filter(move |&n| above[n] && !above[(n + 3) % 4]);
    begins.map(move |n| {
        let end = (n..n + 4).find(|m| !above[(m + 1) % 4]).unwrap_or(n);
        [side(n + 3), side(end)]
    })
}

/// Joins pieces with common ends into lines.
fn join(pieces: &[[Side; 2]]) -> Vec<Vec<Side>> {
    let mut at: HashMap<Side, Vec<usize>> = HashMap::new();
    for (n, piece) in pieces.iter().enumerate() {
        piece.iter().for_each(|side| at.entry(*side).or_default().push(n));
    }
    let mut used = vec![false; pieces.len()];
    let mut lines = Vec::new();
    // Follow open lines from one of their ends, closed lines from any point.
    let is_end = |n: &usize| pieces[*n].iter().any(|side| at[side].len() == 1);
    let ends = (0..pieces.len()).filter(is_end).collect::<Vec<_>>();
    for first in ends.into_iter().chain(0..pieces.len()) {
        if used[first] {
            continue;
        }
        let [a, b] = pieces[first];
        let (start, mut end) = if at[&b].len() == 1 { (b, a) } else { (a, b) };
        used[first] = true;
        let mut line = vec![start, end];
        while let Some(&next) = at[&end].iter().find(|&&n| !used[n]) {
            used[next] = true;
            let [a, b] = pieces[next];
            end = if a == end { b } else { a };
            line.push(end);
        }
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(columns: usize, rows: usize, of: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let value = |n: usize| of((n % columns) as f64, (n / columns) as f64);
        (0..columns * rows).map(value).collect()
    }

    #[test]
    fn a_slope_has_a_straight_line() {
        let lines = contours(&field(5, 4, |x, _| x), 5, 1.25);
        assert_eq!(lines.len(), 1, "{lines:?}");
        assert!(lines[0].iter().all(|[x, _]| (x - 1.25).abs() < 1e-12));
        let ends = [lines[0][0][1], lines[0][3][1]];
        assert!(ends == [0.0, 3.0] || ends == [3.0, 0.0], "{ends:?}");
    }

    #[test]
    fn a_cone_has_a_closed_circle() {
        let lines = contours(&field(41, 41, |x, y| (x - 20.0).hypot(y - 20.0)), 41, 12.5);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
        for [x, y] in &lines[0] {
            // Error of the linear interpolation of a cone: 1/(8 r) of a cell.
            assert!(((x - 20.0).hypot(y - 20.0) - 12.5).abs() < 0.011, "{x} {y}");
        }
    }

    #[test]
    fn corners_above_the_level_stay_apart_and_blank_cells_have_none() {
        let saddle = [1.0, 0.0, 0.0, 1.0];
        assert_eq!(contours(&saddle, 2, 0.5).len(), 2);
        assert!(contours(&[1.0, 0.0, f64::NAN, 1.0], 2, 0.5).is_empty());
        assert!(contours(&[1.0; 9], 3, 0.5).is_empty());
    }
}
