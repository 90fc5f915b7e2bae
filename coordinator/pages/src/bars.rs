//! Horizontal bar charts with bars to both sides of zero.

use super::axis::Axis;
use super::canvas::{Drawing, RIGHT, WIDTH};
use super::html::escape;
use run::format::number;
use std::fmt::Write as _;

/// Height of a bar with its spacing.
const ROW: f64 = 26.0;
/// Space above the first bar.
const TOP: f64 = 8.0;
/// Space below the last bar, for the numbers and the label.
const BELOW: f64 = 48.0;
/// Right edge of the names.
const NAMES: f64 = 176.0;

/// A bar chart: one value for each name.
#[derive(Clone, Debug, PartialEq)]
pub struct Bars {
    /// Title above the chart.
    pub title: String,
    /// Label of the values, with their unit.
    pub label: String,
    /// Names and values.
    pub bars: Vec<(String, f64)>,
}

impl Bars {
    /// Renders the chart as HTML.
    #[must_use]
    pub fn html(&self) -> String {
        let values = self.bars.iter().map(|(_, value)| *value);
        let axis = Axis::linear(values.chain([0.0]), true, [NAMES + 8.0, RIGHT - 44.0]);
        let bottom = TOP + ROW * self.bars.len() as f64;
        let nought = axis.place(0.0).unwrap_or(NAMES);
        let mut svg = String::new();
        for (value, text) in axis.ticks(4) {
            let Some(x) = axis.place(value) else { continue };
            let (end, y) = (bottom + 5.0, bottom + 19.0);
            let _ = writeln!(svg, "<path class=\"grid\" d=\"M{x:.2} {TOP}V{end:.2}\"/>");
            let _ =
                writeln!(svg, "<text class=\"tick mid\" x=\"{x:.2}\" y=\"{y:.2}\">{text}</text>");
        }
        for (n, (name, value)) in self.bars.iter().enumerate() {
            let y = TOP + ROW * n as f64;
            svg += &bar(name, *value, [nought, axis.place(*value).unwrap_or(nought)], y);
        }
        let _ = writeln!(svg, "<path class=\"frame\" d=\"M{nought:.2} {TOP}V{bottom:.2}\"/>");
        let (middle, y) = (0.5 * (NAMES + RIGHT), bottom + 40.0);
        let label = escape(&self.label);
        let _ = writeln!(
            svg,
            "<text class=\"label mid\" x=\"{middle:.2}\" y=\"{y:.2}\">{label}</text>"
        );
        let said: Vec<String> = self
            .bars
            .iter()
            .map(|(name, value)| format!("{name}: {}", number(*value, 3)))
            .collect();
        Drawing {
            title: &self.title,
            description: said.join(". "),
            size: [WIDTH, bottom + BELOW],
            content: svg,
            ..Drawing::default()
        }
        .html()
    }
}

/// Draws one bar, with its name before and its value behind.
fn bar(name: &str, value: f64, [from, to]: [f64; 2], y: f64) -> String {
    let (left, width) = (from.min(to), (from - to).abs().max(0.5));
    let (name, value_text) = (escape(name), number(value, 3));
    let middle = y + 0.5 * ROW + 4.5;
    let top = y + 5.0;
    let height = ROW - 10.0;
    let value_at = (left + width + 6.0).min(WIDTH - 40.0);
    format!(
        "<text class=\"tick end\" x=\"{NAMES}\" y=\"{middle:.2}\">{name}</text>\n\
         <rect class=\"piece s0\" x=\"{left:.2}\" y=\"{top:.2}\" width=\"{width:.2}\" \
         height=\"{height:.2}\"/>\n\
         <text class=\"tick\" x=\"{value_at:.2}\" y=\"{middle:.2}\">{value_text}</text>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_go_to_both_sides_of_nought() {
        let bars = vec![("a <b>".to_owned(), 3.0), ("c".to_owned(), -1.0)];
        let html = Bars { title: "t".to_owned(), label: "l".to_owned(), bars }.html();
        assert_eq!(html.matches("<rect").count(), 2);
        assert!(html.contains("a &lt;b&gt;") && html.contains("−1.00"), "{html}");
    }
}
