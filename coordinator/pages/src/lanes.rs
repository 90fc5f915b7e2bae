//! Work of the processes over time: one lane per process, with bars along the time axis.

use super::axis::Axis;
use super::canvas::{COLOURS, Drawing, RIGHT, WIDTH};
use super::html::escape;
use run::format::Scale;
use std::fmt::Write as _;

const LEFT: f64 = 92.0;
const TOP: f64 = 10.0;
/// Height of a lane, and of its bars.
const LANE: f64 = 44.0;
const BAR: f64 = 24.0;
/// Smallest visible width of a bar.
const SEEN: f64 = 0.75;

/// The lane of one process.
#[derive(Clone, Debug, PartialEq)]
pub struct Lane {
    /// Name of the process.
    pub name: String,
    /// Start and end of each piece of work \[s\].
    pub bars: Vec<[f64; 2]>,
}

/// Lanes over a common time axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Lanes {
    /// Title above the lanes.
    pub title: String,
    /// Lanes from top to bottom.
    pub lanes: Vec<Lane>,
    /// Note below the drawing.
    pub note: String,
}

impl Lanes {
    /// Renders the lanes as HTML.
    #[must_use]
    pub fn html(&self) -> String {
        let ends = self.lanes.iter().flat_map(|lane| lane.bars.iter().map(|bar| bar[1]));
        let end = ends.fold(0.0, f64::max);
        let scale = Scale::of("s", end);
        let bottom = TOP + LANE * self.lanes.len() as f64;
        let paper = [LEFT, RIGHT];
        let time = Axis::linear([0.0, end / scale.factor].into_iter(), false, paper);
        let mut svg = String::new();
        for (value, text) in time.ticks(5) {
            let Some(x) = time.place(value) else { continue };
            let _ = writeln!(svg, "<path class=\"grid\" d=\"M{x:.2} {TOP}V{:.2}\"/>", bottom + 5.0);
            let _ = writeln!(
                svg,
                "<text class=\"tick mid\" x=\"{x:.2}\" y=\"{:.2}\">{text}</text>",
                bottom + 19.0
            );
        }
        for (n, lane) in self.lanes.iter().enumerate() {
            let at = |seconds: f64| time.place(seconds / scale.factor).unwrap_or(LEFT);
            lane.draw(&mut svg, n, TOP + LANE * (n as f64 + 0.5), at);
        }
        let _ = writeln!(svg, "<path class=\"frame\" d=\"M{LEFT} {TOP}V{bottom:.2}H{RIGHT}\"/>");
        let label = format!("time in the windows [{}]", scale.unit);
        let middle = 0.5 * (LEFT + RIGHT);
        let _ = writeln!(
            svg,
            "<text class=\"label mid\" x=\"{middle}\" y=\"{:.2}\">{label}</text>",
            bottom + 40.0
        );
        let total = |lane: &Lane| {
            let busy: f64 = lane.bars.iter().map(|bar| bar[1] - bar[0]).sum();
            format!("{}: {} in {} pieces.", lane.name, scale.show(busy, 4), lane.bars.len())
        };
        let described = self.lanes.iter().map(total).collect::<Vec<_>>().join(" ");
        Drawing {
            title: &self.title,
            description: described,
            size: [WIDTH, bottom + 48.0],
            content: svg,
            note: &self.note,
            ..Drawing::default()
        }
        .html()
    }
}

impl Lane {
    fn draw(&self, svg: &mut String, n: usize, middle: f64, at: impl Fn(f64) -> f64) {
        let name = escape(&self.name);
        let _ = writeln!(
            svg,
            "<text class=\"label end\" x=\"{}\" y=\"{:.2}\">{name}</text>",
            LEFT - 8.0,
            middle + 4.5
        );
        let [top, bottom] = [middle - 0.5 * BAR, middle + 0.5 * BAR];
        let mut path = String::new();
        for &[from, to] in &self.bars {
            let (from, to) = (at(from), at(to));
            let from = from.min(RIGHT - SEEN);
            let to = to.max(from + SEEN).min(RIGHT);
            let _ = write!(path, "M{from:.2} {top:.2}H{to:.2}V{bottom:.2}H{from:.2}Z");
        }
        if !path.is_empty() {
            let _ = writeln!(svg, "<path class=\"piece s{}\" d=\"{path}\"/>", n % COLOURS);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shortest_work_is_seen_and_stays_within() {
        let lane = Lane { name: "a".to_owned(), bars: vec![[0.0, 1.0], [1.0, 1.0 + 1e-9]] };
        let lanes = Lanes { title: "t".to_owned(), lanes: vec![lane], note: String::new() };
        let html = lanes.html();
        let path = html.lines().find(|line| line.contains("piece s0")).unwrap();
        assert!(path.contains("M92.00 ") && path.contains("H426.00V"), "{path}");
        assert!(path.contains("M425.25 "), "{path}");
    }
}
