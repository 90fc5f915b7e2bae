//! Plots of lines over an axis.

use super::axis::{Axis, Frame};
use super::canvas::{COLOURS, Drawing, Key, LEFT, RIGHT, WIDTH, mark};
use super::html::escape;
use run::format::number;
use std::fmt::Write as _;

/// Height of the view box.
const HEIGHT: f64 = 282.0;
/// Upper and lower edge of the plotting area in the drawing.
const TOP: f64 = 12.0;
const BOTTOM: f64 = 234.0;
/// Number of dash patterns in the style sheet, for lines whose colour is already in use.
const DASHES: usize = 3;
/// Maximum number of points drawn per line; more would exceed the resolution of paper.
const POINTS: usize = 720;

/// One line of a figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Name in the legend.
    pub name: String,
    /// Points in drawing order; a point that is not finite leaves a gap.
    pub points: Vec<[f64; 2]>,
    /// Whether to draw dots at the points.
    pub dots: bool,
    /// Whether to draw marks without a line, for printed or measured values of others.
    pub marks: bool,
    /// Half lengths of the bars through the marks, such as standard deviations; may be empty.
    pub spreads: Vec<f64>,
}

/// A plot of lines with two axes and a legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Title above the plot.
    pub title: String,
    /// Label of the horizontal axis, with its unit.
    pub x_label: String,
    /// Label of the vertical axis, with its unit.
    pub y_label: String,
    /// Whether only whole numbers are meaningful along the horizontal axis.
    pub whole: bool,
    /// Whether the horizontal axis is logarithmic.
    pub decades_x: bool,
    /// Whether the vertical axis is logarithmic.
    pub decades: bool,
    /// Whether the vertical axis includes zero; ignored on a logarithmic axis.
    pub from_zero: bool,
    /// Whether both axes have the same scale; ignored on logarithmic axes.
    pub true_shape: bool,
    /// Lines of the plot.
    pub lines: Vec<Line>,
    /// Lines that a reader can select one at a time with a slider, in place of the others.
    pub frames: Vec<Line>,
    /// Note below the plot.
    pub note: String,
}

impl Figure {
    /// Returns a plot without lines.
    #[must_use]
    pub fn new(
        title: impl Into<String>,
        x_label: impl Into<String>,
        y_label: impl Into<String>,
    ) -> Self {
        Self {
            title: title.into(),
            x_label: x_label.into(),
            y_label: y_label.into(),
            whole: false,
            decades_x: false,
            decades: false,
            from_zero: true,
            true_shape: false,
            lines: Vec::new(),
            frames: Vec::new(),
            note: String::new(),
        }
    }

    /// Adds a line.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        let dots = points.len() <= 40;
        self.lines.push(Line {
            name: name.into(),
            points,
            dots,
            marks: false,
            spreads: Vec::new(),
        });
        self
    }

    /// Adds marks without a connecting line.
    #[must_use]
    pub fn with_marks(self, name: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        self.with_spread(name, points, Vec::new())
    }

    /// Adds marks, each with a bar of the given half length; no bars if `spreads` is empty.
    #[must_use]
    pub fn with_spread(
        mut self,
        name: impl Into<String>,
        points: Vec<[f64; 2]>,
        spreads: Vec<f64>,
    ) -> Self {
        self.lines.push(Line { name: name.into(), points, dots: false, marks: true, spreads });
        self
    }

    /// Returns whether any point can be drawn.
    #[must_use]
    pub fn has_points(&self) -> bool {
        let places = |value: f64, decades: bool| value.is_finite() && (!decades || value > 0.0);
        let drawn = |p: &[f64; 2]| places(p[0], self.decades_x) && places(p[1], self.decades);
        self.lines.iter().any(|line| line.points.iter().any(drawn))
    }

    /// Renders the plot as HTML.
    #[must_use]
    pub fn html(&self) -> String {
        self.drawing().html()
    }

    /// Renders the plot as a self-contained SVG file, with title and legend.
    #[must_use]
    pub fn standalone(&self) -> String {
        self.drawing().standalone()
    }

    /// The plot as a drawing, for a page, a file or a sheet.
    #[must_use]
    pub(super) fn drawing(&self) -> Drawing<'_> {
        let [x, y] = self.axes();
        let axis = |axis: &Axis, name: &str, label: &str| {
            let ([low, high], [from, to]) = (axis.range, axis.paper);
            let scale = if axis.decades { "decades" } else { "linear" };
            format!(
                " data-{name}=\"{low} {high} {from} {to} {scale}\" data-{name}-label=\"{}\"",
                escape(label)
            )
        };
        Drawing {
            title: &self.title,
            description: self.describe(),
            keys: self.keys(),
            size: [WIDTH, HEIGHT],
            content: self.content(&x, &y),
            data: axis(&x, "x", &self.x_label) + &axis(&y, "y", &self.y_label),
            note: &self.note,
        }
    }

    /// Legend of the lines; empty for a single line.
    fn keys(&self) -> Vec<Key<'_>> {
        if self.lines.len() < 2 {
            return Vec::new();
        }
        let key = |(n, line)| Key { class: Line::class(line, n), name: &line.name };
        self.lines.iter().enumerate().map(key).collect()
    }

    fn axes(&self) -> [Axis; 2] {
        let all = || self.lines.iter().chain(&self.frames).flat_map(|line| &line.points);
        let x = match self.decades_x {
            true => Axis::decades(all().map(|p| p[0]), [LEFT, RIGHT]),
            false => Axis::linear(all().map(|p| p[0]), false, [LEFT, RIGHT]),
        };
        let zero = self.from_zero.then_some(0.0).into_iter();
        let bars = self.lines.iter().flat_map(Line::bars).flatten().map(|end| end[1]);
        let y = match self.decades {
            true => Axis::decades(all().map(|p| p[1]), [BOTTOM, TOP]),
            false => Axis::linear(all().map(|p| p[1]).chain(bars).chain(zero), true, [BOTTOM, TOP]),
        };
        let (mut x, mut y) = (Axis { whole: self.whole, ..x }, y);
        if self.true_shape && !self.decades && !self.decades_x {
            let unit = |axis: &Axis| {
                (axis.range[1] - axis.range[0]) / (axis.paper[1] - axis.paper[0]).abs()
            };
            let largest = unit(&x).max(unit(&y));
            for axis in [&mut x, &mut y] {
                let middle = 0.5 * (axis.range[0] + axis.range[1]);
                let half = 0.5 * largest * (axis.paper[1] - axis.paper[0]).abs();
                axis.range = [middle - half, middle + half];
            }
        }
        [x, y]
    }

    /// Draws axes and lines.
    fn content(&self, x: &Axis, y: &Axis) -> String {
        let (x_label, y_label) = (self.x_label.as_str(), self.y_label.as_str());
        let mut svg = Frame { x, y, x_label, y_label, grid: true }.svg();
        for (n, line) in self.lines.iter().enumerate() {
            line.draw(&mut svg, &line.class(n), x, y);
        }
        for frame in &self.frames {
            frame.draw(&mut svg, "s0 instant", x, y);
        }
        svg
    }

    /// Describes the range of every line, for readers who cannot see the plot.
    fn describe(&self) -> String {
        let mut text = format!("{} over {}.", self.y_label, self.x_label);
        for line in &self.lines {
            let Some([low, high]) = super::axis::extent(line.points.iter().map(|p| p[1])) else {
                continue;
            };
            let _ = write!(text, " {}: {} to {}.", line.name, number(low, 4), number(high, 4));
        }
        text
    }
}

impl Line {
    /// Class in the style sheet.
    fn class(&self, n: usize) -> String {
        match (self.marks, n / COLOURS) {
            (true, _) => "mark".to_owned(),
            (false, 0) => format!("s{n}"),
            // Colours repeat with another dash pattern.
            (false, turn) => format!("s{} d{}", n % COLOURS, (turn - 1) % DASHES + 1),
        }
    }

    /// Lower and upper ends of the bars.
    fn bars(&self) -> impl Iterator<Item = [[f64; 2]; 2]> {
        let ends = |([x, y], spread): (&[f64; 2], &f64)| [[*x, y - spread], [*x, y + spread]];
        self.points.iter().zip(&self.spreads).map(ends)
    }

    fn draw(&self, svg: &mut String, class: &str, x: &Axis, y: &Axis) {
        for [low, high] in self.bars() {
            if let (Some(x), Some(low), Some(high)) =
                (x.place(low[0]), y.place(low[1]), y.place(high[1]))
            {
                let _ = writeln!(
                    svg,
                    "<path class=\"frame\" d=\"M{x:.2} {low:.2}L{x:.2} {high:.2}\"/>"
                );
            }
        }
        let place = |p: &[f64; 2]| Some([x.place(p[0])?, y.place(p[1])?]);
        let places: Vec<Option<[f64; 2]>> = thinned(&self.points).iter().map(place).collect();
        if self.marks {
            places.iter().flatten().for_each(|place| *svg += &mark(*place));
            return;
        }
        let mut path = String::new();
        let mut begun = false;
        for place in &places {
            if let Some([x, y]) = place {
                let _ = write!(path, "{}{x:.2} {y:.2}", if begun { 'L' } else { 'M' });
            }
            begun = place.is_some();
        }
        if places.iter().flatten().count() > 1 {
            let _ = writeln!(
                svg,
                "<path class=\"line {class}\" data-name=\"{}\" d=\"{path}\"/>",
                escape(&self.name)
            );
        }
        if self.dots {
            for [x, y] in places.iter().flatten() {
                let _ = writeln!(
                    svg,
                    "<circle class=\"dot {class}\" cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"2.6\"/>"
                );
            }
        }
    }
}

/// Reduces the points to at most [`POINTS`]: the lowest and the highest of each group, in order, so
/// that no peak is lost.
fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if points.len() <= POINTS {
        return points.to_vec();
    }
    let mut kept = Vec::with_capacity(POINTS + 2);
    for group in points.chunks(points.len().div_ceil(POINTS / 2)) {
        let by_height = |a: &usize, b: &usize| group[*a][1].total_cmp(&group[*b][1]);
        let ends = [(0..group.len()).min_by(by_height), (0..group.len()).max_by(by_height)];
        let mut ends: Vec<usize> = ends.into_iter().flatten().collect();
        ends.sort_unstable();
        ends.dedup();
        kept.extend(ends.into_iter().map(|k| group[k]));
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_stays_a_gap() {
        let points = vec![[0.0, 1.0], [1.0, 2.0], [2.0, f64::NAN], [3.0, 1.0], [4.0, 2.0]];
        let html = Figure::new("t", "x", "y").with("s", points).html();
        let path = html.lines().find(|line| line.contains("line s0")).unwrap();
        assert_eq!(path.matches('M').count(), 2, "{path}");
        assert_eq!(path.matches('L').count(), 2, "{path}");
        assert!(!html.contains("NaN"));
    }

    /// Two of the eight curves of a cost study once looked the same, because there are six colours.
    #[test]
    fn every_line_looks_different() {
        let line = Figure::new("", "", "").with("", Vec::new()).lines.remove(0);
        let classes: std::collections::BTreeSet<String> =
            (0..COLOURS * (DASHES + 1)).map(|n| line.class(n)).collect();
        assert_eq!(classes.len(), COLOURS * (DASHES + 1), "{classes:?}");
        for dash in 1..=DASHES {
            let css = include_str!("plot.css");
            assert!(css.contains(&format!(".line.d{dash} ")), "no style for d{dash}");
        }
    }

    #[test]
    fn peaks_survive_thinning() {
        let mut points: Vec<[f64; 2]> = (0..100_000).map(|k| [f64::from(k), 0.0]).collect();
        points[54_321][1] = 7.0;
        points[54_322][1] = -7.0;
        let kept = thinned(&points);
        assert!(kept.len() <= POINTS, "{}", kept.len());
        assert!(kept.contains(&[54_321.0, 7.0]) && kept.contains(&[54_322.0, -7.0]));
        assert!(kept.windows(2).all(|pair| pair[0][0] < pair[1][0]));
    }

    /// A bar extends beyond its mark, and the axis has room for it.
    #[test]
    fn marks_have_bars() {
        let plot = |spreads| Figure::new("t", "x", "y").with_spread("m", vec![[1.0, 2.0]], spreads);
        let bars = |figure: &Figure| figure.html().matches("class=\"frame\" d=\"M").count();
        assert_eq!(bars(&plot(vec![5.0])), bars(&plot(Vec::new())) + 1);
        let [_, y] = plot(vec![5.0]).axes();
        assert!(y.range[0] <= -3.0 && y.range[1] >= 7.0, "{:?}", y.range);
    }

    #[test]
    fn what_is_said_is_escaped() {
        let html = Figure::new("<b>", "a & b", "\"y\"").with("s", vec![[0.0, 1.0]]).html();
        assert!(html.contains("<figcaption>&lt;b&gt;</figcaption>"), "{html}");
        assert!(html.contains("a &amp; b") && !html.contains("<b>"), "{html}");
    }
}
