//! Diagrams of two figures of a summary: lines that are known, such as limits, among which a run has its point.

use serde::{Deserialize, Serialize};

/// Most lines of a diagram, and most points of a line.
const MOST: [usize; 2] = [16, 1000];

/// A diagram.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Diagram {
    /// What it is.
    pub title: String,
    /// Key of the figure to the right, one that the same participant describes.
    pub x: String,
    /// Key of the figure upward.
    pub y: String,
    /// The lines.
    pub lines: Vec<Line>,
    /// What the lines are, and where they are from.
    pub note: String,
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
        if !(1..=lines).contains(&self.lines.len()) {
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
        let good = Diagram {
            title: "limits".to_owned(),
            x: "contact.ratio".to_owned(),
            y: "contact.load".to_owned(),
            lines: vec![line.clone()],
            note: String::new(),
        };
        let check =
            |diagram: &Diagram| diagram.check(["contact.load", "contact.ratio"].into_iter());
        assert_eq!(check(&good), Ok(()));
        let of = |points| Diagram { lines: vec![Line { points, ..line.clone() }], ..good.clone() };
        let wrong = [
            Diagram { x: "contact.power_w".to_owned(), ..good.clone() },
            Diagram { lines: Vec::new(), ..good.clone() },
            of(vec![[0.0, 1.0]]),
            of(vec![[0.0, 1.0], [f64::NAN, 1.0]]),
            of(vec![[0.0; 2]; MOST[1] + 1]),
        ];
        assert!(wrong.iter().all(|diagram| check(diagram).is_err()));
    }
}
