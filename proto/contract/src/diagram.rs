//! Diagrams of two figures of a summary: a run is a point among known lines, such as limits.

use serde::{Deserialize, Serialize};

/// Maximum number of lines of a diagram, and of points of a line.
const MOST: [usize; 2] = [16, 1000];

/// Diagram of two figures of a summary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Diagram {
    /// Title of the diagram.
    pub title: String,
    /// Key of the figure on the horizontal axis, described by the same participant; every entry of
    /// a list is a point.
    pub x: String,
    /// Key of the figure on the vertical axis.
    pub y: String,
    /// Known lines; empty if the points of several runs or windows form the curve.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lines: Vec<Line>,
    /// Lines that the participant writes into the summary. If none of them is there, the diagram is
    /// not drawn.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<Curve>,
    /// Keys of figures that are the same in all points of a curve. Points that differ in one of
    /// them form no curve.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub constant: Vec<String>,
    /// Both axes have the same scale.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub true_shape: bool,
    /// Meaning and source of the lines.
    pub note: String,
}

/// A line of a diagram that a participant writes into the summary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// Name of the line.
    pub name: String,
    /// Dotted path of a list of pairs in `summary.json`, in the units of the figures.
    pub key: String,
}

/// A line of a diagram.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// Name of the line.
    pub name: String,
    /// Points, in the units of the figures.
    pub points: Vec<[f64; 2]>,
}

impl Diagram {
    /// Returns a diagram of two figures without lines.
    #[must_use]
    pub fn new(title: &str, [x, y]: [&str; 2], note: &str) -> Self {
        let [title, x, y, note] = [title, x, y, note].map(str::to_owned);
        let (lines, curves, constant, true_shape) = Default::default();
        Self { title, x, y, lines, curves, constant, true_shape, note }
    }

    /// Checks a diagram received from a participant that describes these figures.
    ///
    /// # Errors
    /// Fails if an axis is not one of the figures, if there are too many lines, or if a line has
    /// fewer than 2 or too many points or a value that is not finite.
    pub fn check<'a>(&self, figures: impl Iterator<Item = &'a str> + Clone) -> Result<(), String> {
        let title = &self.title;
        for axis in [&self.x, &self.y].into_iter().chain(&self.constant) {
            if !figures.clone().any(|key| key == axis) {
                return Err(format!("diagram `{title}` names `{axis}`, which is no figure"));
            }
        }
        let [lines, points] = MOST;
        if self.lines.len() + self.curves.len() > lines {
            return Err(format!("diagram `{title}` has {} lines", self.lines.len()));
        }
        for line in &self.lines {
            let finite = line.points.iter().flatten().all(|value| value.is_finite());
            if !finite || !(2..=points).contains(&line.points.len()) {
                return Err(format!("diagram `{title}` has no line in `{}`", line.name));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_drawn_is_refused() {
        let line = Line { name: "limit".to_owned(), points: vec![[0.0, 4.0], [1.0, 1.0]] };
        let axes = ["contact.ratio", "contact.load"];
        let good = Diagram { lines: vec![line.clone()], ..Diagram::new("limits", axes, "") };
        let check =
            |diagram: &Diagram| diagram.check(["contact.load", "contact.ratio"].into_iter());
        assert_eq!(check(&good), Ok(()));
        assert_eq!(check(&Diagram { lines: Vec::new(), ..good.clone() }), Ok(()));
        let of = |points| Diagram { lines: vec![Line { points, ..line.clone() }], ..good.clone() };
        let wrong = [
            Diagram { x: "contact.power_w".to_owned(), ..good.clone() },
            Diagram { constant: vec!["contact.power_w".to_owned()], ..good.clone() },
            Diagram { lines: vec![line.clone(); MOST[0] + 1], ..good.clone() },
            of(vec![[0.0, 1.0]]),
            of(vec![[0.0, 1.0], [f64::NAN, 1.0]]),
            of(vec![[0.0; 2]; MOST[1] + 1]),
        ];
        assert!(wrong.iter().all(|diagram| check(diagram).is_err()));
    }
}
