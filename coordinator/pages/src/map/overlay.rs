//! Overlays on the colours of a map: contour lines, edges, arrows and the mark of the largest
//! value.

use super::contour::Polyline;
use crate::axis::Axis;
use std::fmt::Write as _;

/// Maximum number of arrows along the longer side of a map.
const ARROWS: usize = 17;
/// Length of the shortest drawn arrow, in drawing units.
const SHORTEST: f64 = 2.0;
/// Number of distinct styles of edges.
const EDGES: usize = 2;

/// A line common to all maps of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// Name in the legend.
    pub name: String,
    /// Lines in the units of the map's axes.
    pub lines: Vec<Polyline>,
}

/// Vectors at the centres of cells, row by row from below.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrows {
    /// Horizontal components.
    pub x: Vec<f64>,
    /// Vertical components.
    pub y: Vec<f64>,
}

/// Class of the n-th edge in the style sheet.
pub(super) fn edge_class(n: usize) -> String {
    format!("edge{}", n % EDGES)
}

/// Path data of lines; parts outside the axes are omitted.
pub(super) fn path(lines: &[Polyline], x: &Axis, y: &Axis) -> String {
    let mut path = String::new();
    for line in lines {
        let mut pen = 'M';
        for place in line {
            match within(x, place[0]).zip(within(y, place[1])) {
                Some((x, y)) => {
                    let _ = write!(path, "{pen}{x:.1} {y:.1}");
                    pen = 'L';
                }
                None => pen = 'M',
            }
        }
    }
    path
}

/// Position of a value in the drawing; `None` outside the axis.
fn within(axis: &Axis, value: f64) -> Option<f64> {
    let [low, high] = axis.range;
    (low <= value && value <= high).then(|| axis.place(value)).flatten()
}

/// Draws edges as light lines on a dark casing, visible on every colour.
pub(super) fn edges(all: &[Edge], x: &Axis, y: &Axis) -> String {
    let mut svg = String::new();
    for (n, edge) in all.iter().enumerate() {
        let path = path(&edge.lines, x, y);
        if !path.is_empty() {
            let class = edge_class(n);
            let _ = writeln!(svg, "<path class=\"casing\" d=\"{path}\"/>");
            let _ = writeln!(svg, "<path class=\"edge {class}\" d=\"{path}\"/>");
        }
    }
    svg
}

/// Draws one arrow for each block of cells, centred on the block. The longest arrow is as long as
/// the distance between blocks, and no arrow leaves the map.
pub(super) fn arrows(of: &Arrows, columns: usize, x: &Axis, y: &Axis) -> String {
    let rows = of.x.len() / columns;
    let every = columns.max(rows).div_ceil(ARROWS);
    let cell =
        [(x.paper[1] - x.paper[0]) / columns as f64, (y.paper[1] - y.paper[0]) / rows as f64];
    // Whole blocks, with the rest of the cells on both sides.
    let middles = |count: usize| {
        let blocks = (count / every).max(1);
        let first = (count.saturating_sub(blocks * every) + every.min(count) - 1) / 2;
        (0..blocks).map(move |block| first + block * every)
    };
    let places = || middles(rows).flat_map(|j| middles(columns).map(move |i| (i, j)));
    let vector = |(i, j): (usize, usize)| [of.x[j * columns + i], of.y[j * columns + i]];
    let length = |[u, v]: [f64; 2]| u.hypot(v);
    let longest = places().map(vector).map(length).filter(|l| l.is_finite()).fold(0.0, f64::max);
    // The middle of an even number of cells is half a cell off.
    let room = |cells: usize, size: f64| (cells - (1 - cells % 2)) as f64 * size.abs();
    let room = room(every.min(columns), cell[0]).min(room(every.min(rows), cell[1]));
    let scale = room / longest;
    let mut path = String::new();
    for place in places() {
        let [u, v] = vector(place).map(|value| value * scale);
        let size = length([u, v]);
        if !size.is_finite() || size < SHORTEST {
            continue;
        }
        let middle = [
            x.paper[0] + (place.0 as f64 + 0.5) * cell[0],
            y.paper[0] + (place.1 as f64 + 0.5) * cell[1],
        ];
        // The vertical coordinate of an SVG points downwards.
        let along = [u / size, -v / size];
        let end = |side: f64| [0, 1].map(|n| middle[n] + 0.5 * side * size * along[n]);
        let (from, to) = (end(-1.0), end(1.0));
        let barb = |side: f64| {
            let head = 4.5f64.min(0.5 * size);
            let back = [along[0] + 0.6 * side * along[1], along[1] - 0.6 * side * along[0]];
            [to[0] - head * back[0], to[1] - head * back[1]]
        };
        let ([a, b], [x0, y0], [x1, y1]) = ([barb(1.0), barb(-1.0)], from, to);
        let _ = write!(
            path,
            "M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}M{:.1} {:.1}L{x1:.1} {y1:.1}L{:.1} {:.1}",
            a[0], a[1], b[0], b[1]
        );
    }
    match path.as_str() {
        "" => String::new(),
        path => {
            format!("<path class=\"casing\" d=\"{path}\"/>\n<path class=\"arrow\" d=\"{path}\"/>\n")
        }
    }
}

/// Draws a cross.
pub(super) fn peak([x, y]: [f64; 2]) -> String {
    let [left, right, top, bottom] = [x - 5.0, x + 5.0, y - 5.0, y + 5.0];
    let path = format!(
        "M{left:.1} {top:.1}L{right:.1} {bottom:.1}M{left:.1} {bottom:.1}L{right:.1} {top:.1}"
    );
    format!("<path class=\"casing\" d=\"{path}\"/>\n<path class=\"peak\" d=\"{path}\"/>\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(paper: [f64; 2]) -> Axis {
        Axis { range: [0.0, 2.0], decades: false, whole: false, paper }
    }

    #[test]
    fn an_arrow_points_where_its_vector_does() {
        let one = Arrows { x: vec![0.0], y: vec![3.0] };
        let svg = arrows(&one, 1, &axis([0.0, 40.0]), &axis([40.0, 0.0]));
        assert!(svg.contains("d=\"M20.0 40.0L20.0 0.0"), "upward: {svg}");
        let still = Arrows { x: vec![0.0], y: vec![0.0] };
        assert_eq!(arrows(&still, 1, &axis([0.0, 40.0]), &axis([40.0, 0.0])), "");
    }

    #[test]
    fn no_arrow_leaves_the_map() {
        for [columns, rows] in [[10, 40], [2, 60], [1, 3], [40, 40], [60, 7]] {
            let one = Arrows { x: vec![3.0; columns * rows], y: vec![1.0; columns * rows] };
            let (wide, high) = (5.0 * columns as f64, 5.0 * rows as f64);
            let svg = arrows(&one, columns, &axis([0.0, wide]), &axis([high, 0.0]));
            let numbers = svg.split(|c: char| !c.is_ascii_digit() && !".-".contains(c));
            let places: Vec<f64> = numbers.filter_map(|text| text.parse().ok()).collect();
            assert!(!places.is_empty() || columns * rows < 4, "{svg}");
            for place in places.chunks_exact(2) {
                let inside = (-0.1..=wide + 0.1).contains(&place[0])
                    && (-0.1..=high + 0.1).contains(&place[1]);
                assert!(inside, "{columns} x {rows}: {place:?}");
            }
        }
    }

    #[test]
    fn what_is_outside_is_left_out() {
        let line = vec![[-1.0, 1.0], [0.0, 1.0], [2.0, 1.0], [3.0, 1.0], [1.0, 1.0]];
        let path = path(&[line], &axis([0.0, 20.0]), &axis([20.0, 0.0]));
        assert_eq!(path, "M0.0 10.0L20.0 10.0M10.0 10.0");
    }
}
