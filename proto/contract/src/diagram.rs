//! Diagrams of two figures of a summary: lines that are known, such as limits, among which a run has its point.

use serde::{Deserialize, Serialize};

/// Most lines of a diagram, and most points of a line.
const MOST: [usize; 2] = [16, 1000];

/// A diagram.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Diagram {
    /// Label of the curve.
    pub title: String,
    /// Key of the figure to the right, one that the same participant describes; of a list every entry is a point.
    pub x: String,
    /// Key of the figure upward.
    pub y: String,
    /// The lines; none for a curve that the points of several runs or windows make.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lines: Vec<Line>,
    /// Lines that stand in the summary; without any of them there the diagram is not drawn.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<Curve>,
    /// One unit is as long to the right as upward.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub true_shape: bool,
    /// What the lines are, and where they are from.
    pub note: String,
}

/// A line of a diagram that a participant writes into its summary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// What it is.
    pub name: String,
    /// Dotted path of a list of pairs in `summary.json`, in the units of the figures.
    pub key: String,
}

/// A line of a diagram.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// What it is.
    pub name: String,
    /// Its points, in the units of the figures.
    pub points: Vec<[f64; 2]>,
}

impl Diagram {
    /// A diagram of two figures without lines.
    #[must_use]
    pub fn new(title: &str, [x, y]: [&str; 2], note: &str) -> Self {
        let [title, x, y, note] = [title, x, y, note].map(str::to_owned);
        Self { title, x, y, lines: Vec::new(), curves: Vec::new(), true_shape: false, note }
    }

    /// What is wrong with a diagram that came from outside, of a participant with figures of these keys.
    ///
    /// # Errors
    /// An axis that is none of the figures, and lines without points, with too many, or that are not finite.
    pub fn check<'a>(&self, figures: impl Iterator<Item = &'a str> + Clone) -> Result<(), String> {
        let title = &self.title;
        for axis in [&self.x, &self.y] {
            if !figures.clone().any(|key| key == axis) {
                return Err(format!("diagram `{title}` is over `{axis}`, which is no figure"));
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
            Diagram { lines: vec![line.clone(); MOST[0] + 1], ..good.clone() },
            of(vec![[0.0, 1.0]]),
            of(vec![[0.0, 1.0], [f64::NAN, 1.0]]),
            of(vec![[0.0; 2]; MOST[1] + 1]),
        ];
        assert!(wrong.iter().all(|diagram| check(diagram).is_err()));
    }
}
