//! Maps: values over a plane as colours.

mod contour;
mod overlay;

pub use contour::{Polyline, contours, contours_at};
pub use overlay::{Arrows, Edge};

use super::axis::{Axis, Frame, extent};
use super::canvas::{Drawing, Key, LEFT};
use super::image::{COLOURS, Palette, address, entry};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use run::format::number;
use std::fmt::Write as _;

/// Width of the view box, larger than in other plots because a map shows more detail.
const WIDTH: f64 = 680.0;
/// Right limit of a map in the drawing.
const RIGHT: f64 = 540.0;
const TOP: f64 = 14.0;
/// Space between a map and its colour bar, and width of the bar.
const BAR: [f64; 2] = [16.0, 16.0];
/// Minimum width of a map with its legend, so that labels fit below it.
const NARROWEST: f64 = 340.0;
/// Maximum height of a map.
const HEIGHT: f64 = 420.0;
/// Height of a map whose axes have different scales.
const FREE_HEIGHT: f64 = 240.0;
/// Minimum height of the colour bar.
const BAR_HEIGHT: f64 = 60.0;
/// Maximum number of elements drawn along an axis; more are averaged in blocks.
const ELEMENTS: usize = 300;
/// Approximate number of contour lines.
const LEVELS: usize = 5;
/// Significant digits of the limits of the colour bar.
const DIGITS: usize = 4;
/// Code of a missing value in the data for the script, and the largest code of a value.
const BLANK: u16 = u16::MAX;
const MOST: f64 = (u16::MAX - 1) as f64;

/// A map of a field over a rectangle of elements.
#[derive(Clone, Debug, PartialEq)]
pub struct Heatmap {
    /// Title above the map.
    pub title: String,
    /// Label of the horizontal axis, with its unit.
    pub x_label: String,
    /// Label of the vertical axis, with its unit.
    pub y_label: String,
    /// Label of the colour bar, with its unit.
    pub value_label: String,
    /// Left and right border.
    pub x: [f64; 2],
    /// Lower and upper border.
    pub y: [f64; 2],
    /// Number of elements along x.
    pub columns: usize,
    /// Values row by row from below; values that are not finite are left blank.
    pub values: Vec<f64>,
    /// Whether the colour range includes zero.
    pub from_zero: bool,
    /// Colours. The range of a difference is symmetric, so that its zero is neutral.
    pub palette: Palette,
    /// Whether both axes have the same scale.
    pub true_shape: bool,
    /// Vectors drawn over the colours.
    pub arrows: Option<Arrows>,
    /// Lines drawn over the colours.
    pub edges: Vec<Edge>,
    /// Note below the map.
    pub note: String,
}

/// Drawn elements: the elements of the map, or means of blocks of elements.
struct FieldDrawing {
    columns: usize,
    values: Vec<f64>,
}

impl Heatmap {
    /// Renders the map as HTML.
    #[must_use]
    pub fn html(&self) -> String {
        self.drawing().html()
    }

    /// Renders the map as a self-contained SVG file, with its title.
    #[must_use]
    pub fn standalone(&self) -> String {
        self.drawing().standalone()
    }

    /// The map as a drawing.
    pub(super) fn drawing(&self) -> Drawing<'_> {
        let drawn = self.drawn();
        let [width, height] = self.size();
        let (left, bottom) = (LEFT, TOP + height);
        let x = Axis { range: self.x, decades: false, whole: false, paper: [left, left + width] };
        let y = Axis { range: self.y, decades: false, whole: false, paper: [bottom, TOP] };
        Drawing {
            title: &self.title,
            description: self.describe(),
            keys: self.keys(),
            size: [Self::total(width), TOP + height.max(BAR_HEIGHT) + 48.0],
            content: self.content(&drawn, &x, &y),
            data: self.data(&drawn, &x, &y) + &natural(Self::total(width)),
            note: &self.note,
        }
    }

    /// Width of the drawing of a map of this width: the colour bar stands beside the map.
    fn total(width: f64) -> f64 {
        (WIDTH - (RIGHT - LEFT - width)).max(NARROWEST)
    }

    fn keys(&self) -> Vec<Key<'_>> {
        let named = self.edges.iter().map(|edge| edge.name.as_str()).enumerate();
        named.map(|(n, name)| Key { class: overlay::edge_class(n), name }).collect()
    }

    /// Values at the ends of the colour range.
    fn range(&self) -> [f64; 2] {
        let values = self.values.iter().copied().chain(self.from_zero.then_some(0.0));
        let mut range = extent(values).unwrap_or([0.0, 1.0]);
        if self.palette == Palette::Diverging {
            let most = range[0].abs().max(range[1].abs());
            range = [-most, most];
        }
        if range[0] < range[1] { range } else { [range[0] - 1.0, range[1] + 1.0] }
    }

    fn content(&self, drawn: &FieldDrawing, x: &Axis, y: &Axis) -> String {
        let range = self.range();
        let ([left, right], [bottom, top]) = (x.paper, y.paper);
        let mut svg = String::new();
        let _ = writeln!(
            svg,
            "<image class=\"map\" x=\"{left:.2}\" y=\"{top:.2}\" width=\"{:.2}\" \
             height=\"{:.2}\" preserveAspectRatio=\"none\" href=\"{}\"/>",
            right - left,
            bottom - top,
            address(self.palette, drawn.columns, &drawn.pixels(range))
        );
        svg += &self.lines(drawn, x, y);
        if let Some(arrows) = &self.arrows {
            svg += &overlay::arrows(arrows, self.columns, x, y);
        }
        svg += &overlay::edges(&self.edges, x, y);
        if let Some(place) = self.peak(x, y) {
            svg += &overlay::peak(place);
        }
        let (x_label, y_label) = (self.x_label.as_str(), self.y_label.as_str());
        svg += &Frame { x, y, x_label, y_label, grid: false }.svg();
        svg + &self.bar(range, right + BAR[0], bottom.max(TOP + BAR_HEIGHT))
    }

    /// Draws contour lines at the numbers beside the colour bar.
    fn lines(&self, drawn: &FieldDrawing, x: &Axis, y: &Axis) -> String {
        let FieldDrawing { columns, values } = drawn;
        // Blank elements with zero value count as zero.
        let nought = |value: &f64| if value.is_finite() { *value } else { 0.0 };
        let values = match self.from_zero {
            true => &values.iter().map(nought).collect::<Vec<_>>(),
            false => values,
        };
        let rows = values.len() / columns;
        let along = |[low, high]: [f64; 2], count: usize, at: f64| {
            low + (high - low) * (at + 0.5) / count as f64
        };
        let place = |[i, j]: [f64; 2]| [along(self.x, *columns, i), along(self.y, rows, j)];
        let levels = colour_axis(self.range(), [0.0, 1.0]).ticks(LEVELS);
        // At an end of the range, a line would separate values that differ by rounding only.
        let [low, high] = self.range();
        let margin = 1e-6 * (high - low);
        let within = |level: f64| level != 0.0 && level > low + margin && level < high - margin;
        let lines = levels.iter().filter(|(level, _)| within(*level));
        let lines = lines.flat_map(|(level, _)| contours(values, *columns, *level));
        let lines: Vec<Polyline> =
            lines.map(|line| line.into_iter().map(place).collect()).collect();
        match overlay::path(&lines, x, y).as_str() {
            "" => String::new(),
            path => format!("<path class=\"contour\" d=\"{path}\"/>\n"),
        }
    }

    /// Position of the largest value in the drawing; `None` without a value, or if all values are
    /// equal.
    fn peak(&self, x: &Axis, y: &Axis) -> Option<[f64; 2]> {
        extent(self.values.iter().copied()).filter(|[low, high]| low < high)?;
        // A difference is marked where its magnitude is largest.
        let size = |value: f64| match self.palette {
            Palette::Sequential => value,
            Palette::Diverging => value.abs(),
        };
        let [low, high] = extent(self.values.iter().map(|value| size(*value)))?;
        let rows = self.values.len() / self.columns;
        let middle = |n: usize, count: usize, [from, to]: [f64; 2]| {
            from + (n as f64 + 0.5) / count as f64 * (to - from)
        };
        // Among places that are equally large within rounding, take the one nearest to the origin.
        let off = |at: &usize| {
            let x = middle(at % self.columns, self.columns, self.x);
            x.hypot(middle(at / self.columns, rows, self.y))
        };
        let as_large = |at: &usize| size(self.values[*at]) >= high - 1e-9 * (high - low);
        let at =
            (0..self.values.len()).filter(as_large).min_by(|a, b| off(a).total_cmp(&off(b)))?;
        let part = |n: usize, count: usize, [from, to]: [f64; 2]| {
            from + (n as f64 + 0.5) / count as f64 * (to - from)
        };
        Some([
            part(at % self.columns, self.columns, x.paper),
            part(at / self.columns, rows, y.paper),
        ])
    }

    /// Data for the script: limits of the axes in the drawing and in values, their labels, and the
    /// values coded as little-endian integers in steps of 1/65534 of their range.
    fn data(&self, drawn: &FieldDrawing, x: &Axis, y: &Axis) -> String {
        let [low, high] = self.range();
        let step = |value: &f64| match value.is_finite() {
            true => ((value - low) / (high - low) * MOST).round().clamp(0.0, MOST) as u16,
            false => BLANK,
        };
        let bytes: Vec<u8> = drawn.values.iter().flat_map(|v| step(v).to_le_bytes()).collect();
        let axis = |axis: &Axis, name: &str, label: &str| {
            let ([low, high], [from, to]) = (axis.range, axis.paper);
            let label = super::html::escape(label);
            format!(" data-{name}=\"{low} {high} {from} {to}\" data-{name}-label=\"{label}\"")
        };
        format!(
            "{}{} data-columns=\"{}\" data-range=\"{low} {high}\" data-unit=\"{}\" data-values=\"{}\"",
            axis(x, "x", &self.x_label),
            axis(y, "y", &self.y_label),
            drawn.columns,
            super::html::escape(&self.value_label),
            STANDARD.encode(bytes)
        )
    }

    /// Describes the range of the values, for readers who cannot see the map.
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

    /// Width and height of the map in the drawing.
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

    /// Averages blocks of elements if there are more elements than can be drawn.
    fn drawn(&self) -> FieldDrawing {
        let rows = self.values.len() / self.columns;
        let (di, dj) = (self.columns.div_ceil(ELEMENTS), rows.div_ceil(ELEMENTS));
        let (ni, nj) = (self.columns.div_ceil(di), rows.div_ceil(dj));
        let mean = |(i, j): (usize, usize)| {
            let rows = j * dj..((j + 1) * dj).min(rows);
            let columns = || i * di..((i + 1) * di).min(self.columns);
            let of = |j: usize| columns().map(move |i| self.values[j * self.columns + i]);
            let (count, sum) = rows
                .flat_map(of)
                .filter(|value| value.is_finite())
                .fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
            sum / count
        };
        let blocks = (0..nj).flat_map(|j| (0..ni).map(move |i| (i, j)));
        FieldDrawing { columns: ni, values: blocks.map(mean).collect() }
    }

    /// Draws the colour bar with its numbers.
    fn bar(&self, range: [f64; 2], left: f64, bottom: f64) -> String {
        let right = left + BAR[1];
        let mut svg = String::new();
        let colours: Vec<u8> = (1..=COLOURS).rev().collect();
        let _ = writeln!(
            svg,
            "<image class=\"bar\" x=\"{left}\" y=\"{TOP}\" width=\"{}\" height=\"{:.2}\" \
             preserveAspectRatio=\"none\" href=\"{}\"/>",
            right - left,
            bottom - TOP,
            address(self.palette, 1, &colours)
        );
        let axis = colour_axis(range, [bottom, TOP]);
        let ends = [(range[1], number(range[1], DIGITS)), (range[0], number(range[0], DIGITS))];
        let mut taken: Vec<f64> = Vec::new();
        // First the limits of the colours, then round numbers where space is left.
        for (n, (value, text)) in ends.into_iter().chain(axis.ticks(LEVELS)).enumerate() {
            let Some(y) = axis.place(value) else { continue };
            let class = if n < 2 { "label" } else { "tick" };
            let _ = writeln!(svg, "<path class=\"grid\" d=\"M{right} {y:.2}h4\"/>");
            if taken.iter().all(|other| (other - y).abs() >= 17.0) {
                taken.push(y);
                let (x, y) = (right + 7.0, y + 4.5);
                let _ =
                    writeln!(svg, "<text class=\"{class}\" x=\"{x}\" y=\"{y:.2}\">{text}</text>");
            }
        }
        let _ = writeln!(
            svg,
            "<text class=\"label\" x=\"{left}\" y=\"{:.2}\">{}</text>",
            bottom + 24.0,
            super::html::escape(&self.value_label)
        );
        svg
    }
}

impl FieldDrawing {
    /// Palette entries from the top row downwards.
    fn pixels(&self, range: [f64; 2]) -> Vec<u8> {
        let rows = self.values.chunks_exact(self.columns).rev();
        rows.flatten().map(|value| entry(*value, range)).collect()
    }
}

/// Attribute that keeps a narrow drawing at the scale of the others.
fn natural(width: f64) -> String {
    match width < WIDTH {
        true => format!(" style=\"max-width:{:.1}%\"", 100.0 * width / WIDTH),
        false => String::new(),
    }
}

/// Axis of the colour bar.
fn colour_axis(range: [f64; 2], paper: [f64; 2]) -> Axis {
    Axis { range, decades: false, whole: false, paper }
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
            palette: Palette::Sequential,
            true_shape: true,
            arrows: None,
            edges: Vec::new(),
            note: String::new(),
        }
    }

    #[test]
    fn the_top_row_comes_first_and_gaps_are_blank() {
        let drawn = map(2, vec![0.0, 1.0, f64::NAN, 0.5]).drawn();
        assert_eq!((drawn.columns, drawn.pixels([0.0, 1.0])), (2, vec![0, 128, 1, 255]));
    }

    #[test]
    fn many_elements_are_averaged() {
        let columns = 2 * ELEMENTS;
        let values = (0..2 * columns).map(|k| f64::from((k % 2) as u8)).collect();
        let drawn = map(columns, values).drawn();
        assert_eq!((drawn.columns, drawn.values.len()), (ELEMENTS, 2 * ELEMENTS));
        assert!(drawn.values.iter().all(|value| *value == 0.5));
    }

    #[test]
    fn the_script_is_given_the_values() {
        let html = map(2, vec![0.0, 4.0, f64::NAN, 2.0]).html();
        let bytes = [0u16, 65534, 65535, 32767].map(u16::to_le_bytes).concat();
        let data = format!(
            "data-range=\"0 4\" data-unit=\"v\" data-values=\"{}\"",
            STANDARD.encode(bytes)
        );
        assert!(html.contains(&data), "{html}");
    }

    #[test]
    fn the_largest_value_is_marked() {
        let axes = [[0.0, 20.0], [10.0, 0.0]].map(|paper| colour_axis([0.0, 1.0], paper));
        let at = |values: Vec<f64>| map(2, values).peak(&axes[0], &axes[1]);
        assert_eq!(at(vec![0.0, 1.0, f64::NAN, 0.5]), Some([15.0, 7.5]));
        assert_eq!(at(vec![1.0; 4]), None);
    }

    /// A difference has zero in the middle of its colours, and its mark where it is largest.
    #[test]
    fn a_difference_is_symmetric() {
        let axes = [[0.0, 20.0], [10.0, 0.0]].map(|paper| colour_axis([0.0, 1.0], paper));
        let map = Heatmap { palette: Palette::Diverging, ..map(2, vec![0.0, -3.0, 0.0, 1.0]) };
        assert_eq!(map.range(), [-3.0, 3.0]);
        assert_eq!(map.peak(&axes[0], &axes[1]), Some([15.0, 7.5]));
    }

    /// The colour bar of a slender contact stands beside the map, and the drawing ends there.
    #[test]
    fn a_slender_map_has_its_colours_beside_it() {
        let whole = map(2, vec![1.0; 2]);
        let wide = whole.drawing();
        let map = Heatmap { x: [0.0, 0.25], ..map(1, vec![1.0, 2.0]) };
        let slender = map.drawing();
        assert!(slender.size[0] < 0.55 * wide.size[0], "{:?}", slender.size);
        let [width, _] = map.size();
        assert!(slender.content.contains(&format!("class=\"bar\" x=\"{}\"", LEFT + width + 16.0)));
        assert!(slender.data.contains("max-width:") && !wide.data.contains("max-width:"));
    }

    #[test]
    fn a_true_shape_has_equal_scales() {
        let [width, height] = map(1, vec![1.0]).size();
        assert!((width / height - 2.0).abs() < 1e-12);
    }
}
