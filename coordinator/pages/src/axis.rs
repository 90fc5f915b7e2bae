//! Axes: positions of values on the drawing, and round numbers for ticks.

use super::html::escape;
use run::format::superscript;
use std::fmt::Write as _;

/// Names of the spatial axes.
pub const AXES: [&str; 3] = ["x", "y", "z"];

/// A linear or logarithmic axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Smallest and largest value.
    pub range: [f64; 2],
    /// Whether the axis is logarithmic; both ends of the range are positive then.
    pub decades: bool,
    /// Whether only whole numbers are meaningful.
    pub whole: bool,
    /// Positions on the drawing of the two ends of the range.
    pub paper: [f64; 2],
}

impl Axis {
    /// Returns a linear axis from the smallest to the largest value, with a margin if `loose`. The
    /// range is never empty.
    #[must_use]
    pub fn linear(values: impl Iterator<Item = f64>, loose: bool, paper: [f64; 2]) -> Self {
        let [mut low, mut high] = extent(values).unwrap_or([0.0, 1.0]);
        if high <= low {
            let half = if low == 0.0 { 1.0 } else { 0.5 * low.abs() };
            (low, high) = (low - half, high + half);
        } else if loose {
            let room = 0.05 * (high - low);
            // An axis that begins or ends at zero keeps doing so.
            (low, high) = match (low == 0.0, high == 0.0) {
                (true, _) => (low, high + room),
                (_, true) => (low - room, high),
                _ => (low - room, high + room),
            };
        }
        Self { range: [low, high], decades: false, whole: false, paper }
    }

    /// Returns a logarithmic axis over the whole decades that enclose the positive values.
    #[must_use]
    pub fn decades(values: impl Iterator<Item = f64>, paper: [f64; 2]) -> Self {
        let logs = values.filter(|value| *value > 0.0).map(f64::log10);
        let [low, high] = extent(logs).unwrap_or([0.0, 1.0]);
        let (low, mut high) = (low.floor(), high.ceil());
        if high <= low {
            high = low + 1.0;
        }
        Self { range: [10f64.powf(low), 10f64.powf(high)], decades: true, whole: false, paper }
    }

    /// Position of a value on the drawing; `None` if the value has none.
    #[must_use]
    pub fn place(&self, value: f64) -> Option<f64> {
        let [low, high] = self.range;
        let part = match self.decades {
            true if value > 0.0 => (value / low).ln() / (high / low).ln(),
            true => return None,
            false => (value - low) / (high - low),
        };
        let [from, to] = self.paper;
        let place = from + part * (to - from);
        place.is_finite().then_some(place)
    }

    /// Round values along the axis, about `wanted` of them, with their text.
    #[must_use]
    pub fn ticks(&self, wanted: usize) -> Vec<(f64, String)> {
        match self.decades {
            true => self.powers(wanted),
            false => self.round(wanted),
        }
    }

    fn round(&self, wanted: usize) -> Vec<(f64, String)> {
        let [low, high] = self.range;
        let least = (high - low) / wanted.max(1) as f64;
        let step = match self.whole {
            true => round_step(least.max(1.0)).ceil(),
            false => round_step(least),
        };
        let decimals = decimals(step);
        let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
        let largest = low.abs().max(high.abs());
        let by_power = largest >= 1e6 || step < 1e-6;
        // Use one power of ten for all ticks and only the digits of the step, because longer
        // numbers would be cut off at the margin.
        let power = largest.log10().floor() as i32;
        let unit = 10f64.powi(power);
        let places = self::decimals(step / unit);
        let write = |value: f64| match by_power {
            true if value == 0.0 => "0".to_owned(),
            true => format!("{:.places$}·10{}", value / unit, superscript(power)).replace('-', "−"),
            false => format!("{value:.decimals$}").replace('-', "−"),
        };
        let count = (last - first) as usize;
        let values = (0..=count).map(|k| (first + k as f64) * step);
        // Avoid "−0".
        values.map(|value| if value == 0.0 { 0.0 } else { value }).map(|v| (v, write(v))).collect()
    }

    fn powers(&self, wanted: usize) -> Vec<(f64, String)> {
        let [low, high] = self.range.map(|value| value.log10().round() as i32);
        let every = (high - low).div_euclid(wanted.max(1) as i32).max(0) + 1;
        let shown = (low..=high).filter(|power| power.rem_euclid(every) == 0);
        shown.map(|power| (10f64.powi(power), format!("10{}", superscript(power)))).collect()
    }
}

/// Number of decimals of the multiples of a round step.
fn decimals(step: f64) -> usize {
    let whole = |decimals: &i32| {
        let scaled = step * 10f64.powi(*decimals);
        (scaled - scaled.round()).abs() < 1e-6 * scaled
    };
    (0..15).find(whole).unwrap_or(15) as usize
}

/// Smallest of 1, 2, 2.5 or 5 times a power of ten that is not below `least`.
fn round_step(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    let suits = |factor: &f64| factor * power >= least * (1.0 - 1e-9);
    [1.0, 2.0, 2.5, 5.0].into_iter().find(suits).unwrap_or(10.0) * power
}

/// Smallest and largest finite value.
#[must_use]
pub fn extent(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let wider = |range: Option<[f64; 2]>, value: f64| match range {
        Some([low, high]) => Some([low.min(value), high.max(value)]),
        None => Some([value, value]),
    };
    values.filter(|value| value.is_finite()).fold(None, wider)
}

/// Returns whether the finite values differ by more than solver rounding.
#[must_use]
pub fn is_varying(values: impl Iterator<Item = f64>) -> bool {
    extent(values).is_some_and(|[from, to]| to - from > 1e-6 * from.abs().max(to.abs()))
}

/// The frame of a plot: two axes with their labels, shared by all kinds of plot.
#[derive(Clone, Debug)]
pub struct Frame<'a> {
    /// Horizontal axis.
    pub x: &'a Axis,
    /// Vertical axis.
    pub y: &'a Axis,
    /// Label of `x`, with its unit.
    pub x_label: &'a str,
    /// Label of `y`, with its unit.
    pub y_label: &'a str,
    /// Whether to draw grid lines, with more numbers along the horizontal axis.
    pub grid: bool,
}

/// Maximum width of a digit, and space to the right of an axis, in drawing units.
const DIGIT: f64 = 7.5;
const BEYOND: f64 = 12.0;

/// Mean width of a letter of a label, in drawing units, and that of a label in two rows.
const LETTER: [f64; 2] = [7.6, 6.4];
const STYLES: [&str; 2] = ["class=\"label mid\"", "class=\"label mid\" style=\"font-size:12px\""];
/// Places of a single row of a label, and of two rows: below the horizontal axis, and from the left
/// border of the drawing.
const BELOW: [f64; 3] = [40.0, 33.0, 45.0];
const BESIDE: [f64; 3] = [12.0, 10.0, 23.0];

/// A row of the label of an axis.
struct Row {
    /// Text, escaped.
    text: String,
    /// Approximate half of its width.
    half: f64,
    /// Place across the row.
    place: f64,
    /// Attributes of its class and its size.
    style: &'static str,
}

/// Returns the rows of a label: one or, if the room is too narrow for it, two in smaller letters.
fn rows(label: &str, room: f64, [single, first, second]: [f64; 3]) -> Vec<Row> {
    let row = |text: &str, small: usize, place: f64| {
        let style = STYLES[small];
        let half = 0.5 * LETTER[small] * text.chars().count() as f64;
        Row { text: escape(text), half: half.min(0.5 * room), place, style }
    };
    let count = label.chars().count();
    // The rows are as equal as the words allow.
    let middle = |at: &usize| (2 * label[..*at].chars().count()).abs_diff(count);
    let space = label.match_indices(' ').map(|(at, _)| at).min_by_key(middle);
    match space.filter(|_| LETTER[0] * count as f64 > room) {
        None => vec![row(label, 0, single)],
        Some(at) => vec![row(&label[..at], 1, first), row(&label[at + 1..], 1, second)],
    }
}

impl Frame<'_> {
    /// Renders the axes as SVG.
    #[must_use]
    pub fn svg(&self) -> String {
        let ([left, right], [bottom, top]) = (self.x.paper, self.y.paper);
        let beside = format!("<g class=\"beside\">\n{}</g>\n", self.numbers_beside());
        let mut out = self.numbers_below() + &beside;
        let _ = writeln!(
            out,
            "<path class=\"frame\" d=\"M{left:.2} {top:.2}V{bottom:.2}H{right:.2}\"/>"
        );
        let (middle, centre) = (0.5 * (left + right), 0.5 * (bottom + top));
        // A label that is wider than its axis moves towards the axis's start.
        for Row { text, half, place, style } in rows(self.x_label, right + BEYOND, BELOW) {
            let (x, y) = (middle.min(right + BEYOND - half).max(half), bottom + place);
            let _ = writeln!(out, "<text {style} x=\"{x:.2}\" y=\"{y:.2}\">{text}</text>");
        }
        for Row { text, half, place: x, style } in rows(self.y_label, bottom + top, BESIDE) {
            let y = centre.max(half);
            let _ = writeln!(
                out,
                "<text {style} transform=\"translate({x:.2} {y:.2}) rotate(-90)\">\
                 {text}</text>"
            );
        }
        out
    }

    fn numbers_below(&self) -> String {
        let [bottom, top] = self.y.paper;
        let from = if self.grid { top } else { bottom };
        let mut out = String::new();
        let [left, right] = self.x.paper;
        // A narrow axis has room for few numbers.
        let room = ((right - left) / 45.0) as usize;
        for (value, text) in self.x.ticks(room.min(if self.grid { 7 } else { 6 })) {
            let Some(x) = self.x.place(value) else { continue };
            let below = bottom + 5.0;
            let _ = writeln!(out, "<path class=\"grid\" d=\"M{x:.2} {from:.2}V{below:.2}\"/>");
            let y = bottom + 19.0;
            // Keep a number at the end of the axis within the drawing.
            let half = 0.5 * DIGIT * text.chars().count() as f64;
            let x = x.min(self.x.paper[1] + BEYOND - half);
            let _ =
                writeln!(out, "<text class=\"tick mid\" x=\"{x:.2}\" y=\"{y:.2}\">{text}</text>");
        }
        out
    }

    fn numbers_beside(&self) -> String {
        let ([left, right], [bottom, top]) = (self.x.paper, self.y.paper);
        let to = if self.grid { right } else { left };
        let mut out = String::new();
        for (value, text) in self.y.ticks(if (bottom - top).abs() < 110.0 { 3 } else { 5 }) {
            let Some(y) = self.y.place(value) else { continue };
            let from = left - 5.0;
            let _ = writeln!(out, "<path class=\"grid\" d=\"M{from:.2} {y:.2}H{to:.2}\"/>");
            let (x, y) = (left - 8.0, y + 4.5);
            let _ =
                writeln!(out, "<text class=\"tick end\" x=\"{x:.2}\" y=\"{y:.2}\">{text}</text>");
        }
        out
    }
}

/// Largest magnitude of the values; 0 for none.
#[must_use]
pub fn largest_magnitude(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()))
}

/// Label of an axis from a name and a unit, each of which may be empty.
#[must_use]
pub fn label(name: &str, unit: &str) -> String {
    match (name, unit) {
        (name, "") => name.to_owned(),
        ("", unit) => unit.to_owned(),
        (name, unit) => format!("{name} [{unit}]"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(axis: &Axis) -> Vec<String> {
        axis.ticks(5).into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn ticks_are_round_and_within() {
        let axis = Axis::linear([-9.6, 9.6].into_iter(), false, [0.0, 1.0]);
        assert_eq!(texts(&axis), ["−5", "0", "5"]);
        // A step of 2.5 needs one decimal.
        let axis = Axis::linear([-6.2, 6.2].into_iter(), false, [0.0, 1.0]);
        assert_eq!(texts(&axis), ["−5.0", "−2.5", "0.0", "2.5", "5.0"]);
        let axis = Axis { whole: true, ..Axis::linear([1.0, 12.0].into_iter(), false, [0.0, 1.0]) };
        assert_eq!(texts(&axis), ["3", "6", "9", "12"]);
        let axis = Axis::linear([0.0, 0.3].into_iter(), false, [0.0, 1.0]);
        assert_eq!(texts(&axis), ["0.0", "0.1", "0.2", "0.3"]);
        let axis = Axis::linear([0.0, 1364.0].into_iter(), true, [0.0, 1.0]);
        assert_eq!(texts(&axis), ["0", "500", "1000"]);
        for (value, _) in axis.ticks(5) {
            assert!((0.0..=1.0).contains(&axis.place(value).unwrap()));
        }
    }

    /// Very small and very large numbers share one power of ten, and fit beside the axis.
    #[test]
    fn small_and_large_ticks_are_short() {
        let ticks =
            |low: f64, high: f64| texts(&Axis::linear([low, high].into_iter(), false, [0.0, 1.0]));
        assert_eq!(ticks(0.0, 2e-9), ["0", "0.5·10⁻⁹", "1.0·10⁻⁹", "1.5·10⁻⁹", "2.0·10⁻⁹"]);
        assert_eq!(ticks(-1e-9, 1e-9)[0], "−1.0·10⁻⁹");
        assert_eq!(ticks(0.0, 4e7), ["0", "1·10⁷", "2·10⁷", "3·10⁷", "4·10⁷"]);
    }

    #[test]
    fn decades_hold_all_values() {
        let axis = Axis::decades([4.0, 3.9e-11, 0.0].into_iter(), [10.0, 0.0]);
        assert_eq!(axis.range, [1e-11, 10.0]);
        assert_eq!(axis.place(0.0), None);
        // One decade of twelve.
        assert!((axis.place(1.0).unwrap() - 10.0 / 12.0).abs() < 1e-12);
        assert!(texts(&axis).contains(&"10⁻⁶".to_owned()), "{:?}", texts(&axis));
    }

    /// A long label takes two rows, and none of them leaves the drawing.
    #[test]
    fn a_long_label_is_not_cut() {
        let [x, y] = [[86.0, 426.0], [234.0, 12.0]]
            .map(|paper| Axis::linear([0.0, 1.0].into_iter(), false, paper));
        let long = "Longitudinal force on the upper body over normal force [kN/kN]";
        let svg = |x_label, y_label| Frame { x: &x, y: &y, x_label, y_label, grid: true }.svg();
        let whole = svg(long, long);
        for part in [">Longitudinal force on the upper<", ">body over normal force [kN/kN]<"] {
            assert_eq!(whole.matches(part).count(), 2, "{whole}");
        }
        assert!(
            svg("x [mm]", "MPa").contains("class=\"label mid\" x=\"256.00\" y=\"274.00\">x [mm]<")
        );
        assert!(rows(long, 438.0, BELOW).iter().all(|row| 2.0 * row.half < 438.0));
        assert_eq!(rows("Temperature rise [K]", 438.0, BELOW).len(), 1);
    }

    #[test]
    fn one_value_alone_has_an_axis() {
        for value in [0.0, 3.0, -2e-9] {
            let axis = Axis::linear([value, f64::NAN].into_iter(), true, [0.0, 1.0]);
            assert!((axis.place(value).unwrap() - 0.5).abs() < 1e-12);
            assert!(!axis.ticks(5).is_empty());
        }
    }
}
