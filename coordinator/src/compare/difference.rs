//! What differs between two results, as plain data.

use super::fields::{self, FieldDifference};
use super::flat;
use crate::report::source::Results;
use contract::figure::value;
use run::results::figures::{Group, groups};
use serde::Serialize;

/// What differs.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Comparison {
    /// Keys of the case with other values, or which one of them lacks.
    pub case: Vec<KeyDifference>,
    /// Figures that differ, the largest relative difference first.
    pub figures: Vec<FigureDifference>,
    /// Number of figures that are the same to the last digit.
    pub same_figures: usize,
    /// Fields that differ, and those that one of them lacks.
    pub fields: Vec<FieldDifference>,
    /// Number of fields that are the same to the bit.
    pub same_fields: usize,
    /// Times \[s\] that both have.
    pub times: Vec<(String, [f64; 2])>,
}

/// A key of the case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct KeyDifference {
    /// Dotted key.
    pub key: String,
    /// Its value in A; absent if it has none.
    pub a: Option<String>,
    /// And in B.
    pub b: Option<String>,
}

/// A figure of the summaries.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct FigureDifference {
    /// Dotted key in `summary.json`.
    pub key: String,
    /// What it is.
    pub name: String,
    /// Its value in A; absent if it has none.
    pub a: Option<f64>,
    /// And in B.
    pub b: Option<f64>,
    /// B − A over the larger of both magnitudes; absent where one has no value.
    pub relative: Option<f64>,
}

impl Comparison {
    /// Nothing differs but times.
    #[must_use]
    pub(crate) fn is_same(&self) -> bool {
        self.case.is_empty() && self.figures.is_empty() && self.fields.is_empty()
    }

    /// Of these two.
    #[must_use]
    pub(super) fn of(a: &Results, b: &Results) -> Self {
        let (figures, same_figures) = figures(a, b);
        let (fields, same_fields) = fields::differences(a, b);
        Self { case: keys(a, b), figures, same_figures, fields, same_fields, times: times(a, b) }
    }
}

fn keys(a: &Results, b: &Results) -> Vec<KeyDifference> {
    let [of_a, of_b] = [a, b].map(|one| flat::case(&one.case));
    let all: std::collections::BTreeSet<&String> = of_a.keys().chain(of_b.keys()).collect();
    let of = |key: &&String| KeyDifference {
        key: (*key).clone(),
        a: of_a.get(*key).cloned(),
        b: of_b.get(*key).cloned(),
    };
    all.iter().map(of).filter(|one| one.a != one.b).collect()
}

/// Figures that differ, and how many do not.
fn figures(a: &Results, b: &Results) -> (Vec<FigureDifference>, usize) {
    let shown = [shown(a), shown(b)].concat();
    let mut known: Vec<(&str, &str)> = Vec::new();
    for one in a.figures().iter().chain(b.figures()).filter(|one| !one.is_of_a_list()) {
        // What neither of them shows is rounding.
        let is_rounding = one.line.is_some() && !shown.contains(&one.key.as_str());
        if !is_rounding && known.iter().all(|(key, _)| *key != one.key) {
            known.push((&one.key, &one.words));
        }
    }
    let (mut different, mut same) = (Vec::new(), 0);
    for (key, name) in known {
        let [of_a, of_b] = [a, b].map(|one| value(&one.summary, key));
        match (of_a, of_b) {
            (None, None) => {}
            (Some(x), Some(y)) if x == y => same += 1,
            _ => {
                let largest = |x: f64, y: f64| x.abs().max(y.abs());
                let relative = of_a.zip(of_b).map(|(x, y)| (y - x) / largest(x, y));
                let (key, name) = (key.to_owned(), name.to_owned());
                different.push(FigureDifference { key, name, a: of_a, b: of_b, relative });
            }
        }
    }
    let size = |one: &FigureDifference| one.relative.map_or(f64::INFINITY, f64::abs);
    different.sort_by(|one, other| size(other).total_cmp(&size(one)));
    (different, same)
}

/// Keys of the figures that a person is shown.
fn shown(of: &Results) -> Vec<&str> {
    let lines = groups(&of.summary, of.figures()).into_iter().filter_map(|group| match group {
        Group::Line(line) => Some(line.entries),
        Group::List(_) => None,
    });
    lines.flatten().map(|entry| entry.figure.key.as_str()).collect()
}

fn times(a: &Results, b: &Results) -> Vec<(String, [f64; 2])> {
    let costs = a.summary.get("cost").and_then(|cost| cost.as_object()).into_iter().flatten();
    let both = costs.filter_map(|(key, of_a)| {
        let name = key.strip_suffix("_s")?;
        let of_b = b.quantity(&format!("/cost/{key}"))?;
        Some((name.to_owned(), [of_a.as_f64()?, of_b]))
    });
    both.collect()
}
