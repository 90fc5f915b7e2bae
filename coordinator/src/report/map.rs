//! Values over a plane, as colours.

use super::axis::{Axis, Frame, extent};
use super::canvas::{LEFT, figure, view};
use super::image::address;
use super::palette::{COLOURS, entry};
use super::standalone::Standalone;
use run::format::number;
use std::fmt::Write as _;

/// Where a map ends at most on the paper, and where its colour bar is.
const RIGHT: f64 = 362.0;
const TOP: f64 = 12.0;
const BAR: [f64; 2] = [374.0, 386.0];
/// Greatest height of a map.
const HEIGHT: f64 = 300.0;
/// Height of a map whose axes have different scales.
const FREE_HEIGHT: f64 = 190.0;
/// Most elements drawn along an axis; more are averaged in blocks.
const ELEMENTS: usize = 400;

/// A field over a rectangle of elements.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Heatmap {
    /// What is shown.
    pub title: String,
    /// What is to the right, with its unit.
    pub x_label: String,
    /// What is upward, with its unit.
    pub y_label: String,
    /// What the colours are, with their unit.
    pub value_label: String,
    /// Left and right border.
    pub x: [f64; 2],
    /// Lower and upper border.
    pub y: [f64; 2],
    /// Elements along x.
    pub columns: usize,
    /// Values, row by row from below. What is not finite stays blank.
    pub values: Vec<f64>,
    /// Nought belongs to the colours.
    pub from_zero: bool,
    /// One unit is as long to the right as upward.
    pub true_shape: bool,
    /// A sentence below it.
    pub note: String,
}

impl Heatmap {
    /// The map as HTML.
    #[must_use]
    pub(crate) fn html(&self) -> String {
        let svg = view(&self.title, &self.describe(), self.height(), &self.content());
        figure(&self.title, &svg, &self.note)
    }

    /// The map as an SVG file that needs nothing else, with its title.
    #[must_use]
    pub(crate) fn standalone(&self) -> String {
        Standalone {
            title: &self.title,
            description: &self.describe(),
            keys: &[],
            height: self.height(),
            content: &self.content(),
        }
        .svg()
    }

    /// Height of the view box.
    fn height(&self) -> f64 {
        TOP + self.size()[1] + 48.0
    }

    /// The values that the ends of the colours stand for.
    fn range(&self) -> [f64; 2] {
        let values = self.values.iter().copied().chain(self.from_zero.then_some(0.0));
        let range = extent(values).unwrap_or([0.0, 1.0]);
        if range[0] < range[1] { range } else { [range[0] - 1.0, range[1] + 1.0] }
    }

    fn content(&self) -> String {
        let [width, height] = self.size();
        let (left, bottom) = (LEFT, TOP + height);
        let x = Axis { range: self.x, decades: false, whole: false, paper: [left, left + width] };
        let y = Axis { range: self.y, decades: false, whole: false, paper: [bottom, TOP] };
        let range = self.range();
        let (columns, pixels) = self.pixels(range);
        let mut svg = String::new();
        let _ = writeln!(
            svg,
            "<image class=\"map\" x=\"{left:.2}\" y=\"{TOP:.2}\" width=\"{width:.2}\" \
             height=\"{height:.2}\" preserveAspectRatio=\"none\" href=\"{}\"/>",
            address(columns, &pixels)
        );
        let (x_label, y_label) = (self.x_label.as_str(), self.y_label.as_str());
        svg += &Frame { x: &x, y: &y, x_label, y_label, grid: false }.svg();
        svg += &self.bar(range, bottom);
        svg
    }

    /// The range of the values, for readers who cannot see the map.
    fn describe(&self) -> String {
        let range = self.range();
        format!(
            "{} over {} and {}, from {} to {}.",
            self.value_label,
            self.x_label,
            self.y_label,
            number(range[0], 4),
            number(range[1], 4)
        )
    }

    /// Width and height of the map on the paper.
    fn size(&self) -> [f64; 2] {
        let width = RIGHT - LEFT;
        if !self.true_shape {
            return [width, FREE_HEIGHT];
        }
        let slope = (self.y[1] - self.y[0]) / (self.x[1] - self.x[0]);
        let height = width * slope;
        match height > HEIGHT {
            true => [HEIGHT / slope, HEIGHT],
            false => [width, height],
        }
    }

    /// Palette entries from the top row on, and how many make a row.
    fn pixels(&self, range: [f64; 2]) -> (usize, Vec<u8>) {
        let rows = self.values.len() / self.columns;
        let (di, dj) = (self.columns.div_ceil(ELEMENTS), rows.div_ceil(ELEMENTS));
        let (ni, nj) = (self.columns.div_ceil(di), rows.div_ceil(dj));
        let mean = |i: usize, j: usize| {
            let rows = j * dj..((j + 1) * dj).min(rows);
            let columns = || i * di..((i + 1) * di).min(self.columns);
            let of = |j: usize| columns().map(move |i| self.values[j * self.columns + i]);
            let (count, sum) = rows
                .flat_map(of)
                .filter(|value| value.is_finite())
                .fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
            sum / count
        };
        let row = |j: usize| (0..ni).map(move |i| entry(mean(i, j), range));
        (ni, (0..nj).rev().flat_map(row).collect())
    }

    /// The colours and their values.
    fn bar(&self, range: [f64; 2], bottom: f64) -> String {
        let [left, right] = BAR;
        let mut svg = String::new();
        let colours: Vec<u8> = (1..=COLOURS).rev().collect();
        let _ = writeln!(
            svg,
            "<image class=\"bar\" x=\"{left}\" y=\"{TOP}\" width=\"{}\" height=\"{:.2}\" \
             preserveAspectRatio=\"none\" href=\"{}\"/>",
            right - left,
            bottom - TOP,
            address(1, &colours)
        );
        let axis = Axis { range, decades: false, whole: false, paper: [bottom, TOP] };
        let wanted = if bottom - TOP < 110.0 { 3 } else { 5 };
        for (value, text) in axis.ticks(wanted) {
            let Some(y) = axis.place(value) else { continue };
            let _ = writeln!(svg, "<path class=\"grid\" d=\"M{right} {y:.2}h4\"/>");
            let _ = writeln!(
                svg,
                "<text class=\"tick\" x=\"{}\" y=\"{:.2}\">{text}</text>",
                right + 7.0,
                y + 4.5
            );
        }
        let _ = writeln!(
            svg,
            "<text class=\"label\" x=\"{left}\" y=\"{:.2}\">{}</text>",
            bottom + 19.0,
            super::html::escape(&self.value_label)
        );
        svg
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(columns: usize, values: Vec<f64>) -> Heatmap {
        Heatmap {
            title: "t".to_owned(),
            x_label: "x".to_owned(),
            y_label: "y".to_owned(),
            value_label: "v".to_owned(),
            x: [0.0, 2.0],
            y: [0.0, 1.0],
            columns,
            values,
            from_zero: false,
            true_shape: true,
            note: String::new(),
        }
    }

    #[test]
    fn the_top_row_comes_first_and_gaps_are_blank() {
        let (columns, pixels) = map(2, vec![0.0, 1.0, f64::NAN, 0.5]).pixels([0.0, 1.0]);
        assert_eq!((columns, pixels), (2, vec![0, 128, 1, 255]));
    }

    #[test]
    fn many_elements_are_averaged() {
        let columns = 2 * ELEMENTS;
        let values = (0..2 * columns).map(|k| f64::from((k % 2) as u8)).collect();
        let (ni, pixels) = map(columns, values).pixels([0.0, 1.0]);
        assert_eq!((ni, pixels.len()), (ELEMENTS, 2 * ELEMENTS));
        assert!(pixels.iter().all(|pixel| *pixel == 128));
    }

    #[test]
    fn a_true_shape_has_equal_scales() {
        let [width, height] = map(1, vec![1.0]).size();
        assert!((width / height - 2.0).abs() < 1e-12);
    }
}
