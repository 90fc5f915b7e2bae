//! A contact as strips along x, each with half an ellipse of pressure: p √(1 − (x − x₀)²/l²)
//! over |x − x₀| < l.
//!
//! Approximate theories of the normal contact produce such strips, and the simplified theory of the
//! tangential contact uses them. From a pressure on elements, a strip takes the load of its row and
//! the length between the edges of contact.
//!
//! *Equivalent ellipse*: the ellipse with the area of the strips and the aspect ratio of their
//! total length and width (Piotrowski and Kik, A simplified model of wheel/rail contact mechanics
//! for non-Hertzian problems, Vehicle System Dynamics 46 (2008) 27–48).

use super::local::Window;
use elastic::strips::semi_ellipse::segment_area;
use std::f64::consts::PI;

/// A strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PressedStrip {
    /// Row of the window.
    pub(super) row: usize,
    /// Middle x₀ [m].
    pub(super) middle: f64,
    /// Half length l [m].
    pub(super) half_length: f64,
    /// Pressure p in the middle [Pa].
    pub(super) pressure: f64,
}

/// Writes the mean pressure of every element of a window, in Pa times the factor.
pub(super) fn write_pressure(
    strips: &[PressedStrip],
    window: &Window,
    factor: f64,
    pressure: &mut [f64],
) {
    let [nx, _] = window.counts();
    let dx = window.sides[0];
    pressure.fill(0.0);
    for strip in strips {
        let row = &mut pressure[strip.row * nx..(strip.row + 1) * nx];
        let edge = |i: usize| {
            let x = (i as f64 - window.half[0] as f64 - 0.5) * dx;
            segment_area((1.0 + (x - strip.middle) / strip.half_length).clamp(0.0, 2.0))
        };
        let scale = factor * strip.pressure * strip.half_length / dx;
        let mut before = edge(0);
        for (i, mean) in row.iter_mut().enumerate() {
            let after = edge(i + 1);
            *mean = scale * (after - before);
            before = after;
        }
    }
}

/// Converts a pressure on the elements of a window [Pa] to strips.
pub(super) fn of_pressure(window: &Window, pressure: &[f64]) -> Vec<PressedStrip> {
    let [nx, _] = window.counts();
    let rows = pressure.chunks_exact(nx).enumerate();
    rows.filter_map(|(row, pressure)| of_row(window, row, pressure)).collect()
}

fn of_row(window: &Window, row: usize, pressure: &[f64]) -> Option<PressedStrip> {
    let dx = window.sides[0];
    let first = pressure.iter().position(|p| *p > 0.0)?;
    let last = pressure.iter().rposition(|p| *p > 0.0)?;
    let sum: f64 = pressure.iter().sum();
    // The squared pressure falls linearly to zero within the last element.
    let beyond = |edge: f64, inner: f64| match inner > edge {
        true => (edge * edge / (inner * inner - edge * edge)).min(0.5),
        false => 0.5,
    };
    let inside = |at: usize| pressure.get(at).copied().unwrap_or(0.0);
    let from = window.along(0, first) - dx * beyond(pressure[first], inside(first + 1));
    let before = last.checked_sub(1).map_or(0.0, inside);
    let to = window.along(0, last) + dx * beyond(pressure[last], before);
    let half_length = 0.5 * (to - from);
    let pressure = sum * dx / (0.5 * PI * half_length);
    Some(PressedStrip { row, middle: 0.5 * (from + to), half_length, pressure })
}

/// Area of strips `spacing` apart [m²]. The squared length is linear from row to row, and beyond
/// the last strips down to zero.
pub(super) fn area(strips: &[PressedStrip], spacing: f64) -> f64 {
    let runs = strips.chunk_by(|one, next| one.row + 1 == next.row);
    let of_run = |run: &[PressedStrip]| {
        let between = |pair: &[PressedStrip]| {
            let [one, next] = [pair[0].half_length, pair[1].half_length];
            2.0 / 3.0 * (one * one + one * next + next * next) / (one + next)
        };
        let [first, .., last] = run else { return 2.0 / 3.0 * run[0].half_length };
        let end = |edge: &PressedStrip, inner: &PressedStrip| {
            2.0 / 3.0 * edge.half_length * beyond(edge, Some(inner))
        };
        run.windows(2).map(between).sum::<f64>()
            + end(first, &run[1])
            + end(last, &run[run.len() - 2])
    };
    2.0 * spacing * runs.map(of_run).sum::<f64>()
}

/// Number of rows beyond the last strip to the point where the squared length, extrapolated
/// linearly, is zero.
fn beyond(edge: &PressedStrip, inner: Option<&PressedStrip>) -> f64 {
    let square = |strip: &PressedStrip| strip.half_length * strip.half_length;
    match inner.filter(|inner| inner.row.abs_diff(edge.row) == 1).map(square) {
        Some(inner) if inner > square(edge) => (square(edge) / (inner - square(edge))).min(1.0),
        _ => 0.5,
    }
}

/// Semi-axes a and b of the equivalent ellipse [m].
pub(super) fn equivalent_ellipse(strips: &[PressedStrip], spacing: f64) -> [f64; 2] {
    let ends = |sign: f64| strips.iter().map(move |strip| strip.middle + sign * strip.half_length);
    let length = ends(1.0).fold(f64::MIN, f64::max) - ends(-1.0).fold(f64::MAX, f64::min);
    let width = match strips {
        [] => 0.0,
        [first, rest @ ..] => {
            let last = rest.last().unwrap_or(first);
            let rows = (last.row - first.row) as f64;
            let inner = rest.len().checked_sub(2).map(|at| &rest[at]).or(Some(first));
            spacing * (rows + beyond(first, rest.first()) + beyond(last, inner))
        }
    };
    let size = (area(strips, spacing) / PI).sqrt();
    let ratio = (length / width).sqrt();
    [size * ratio, size / ratio]
}
