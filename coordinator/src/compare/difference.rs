//! Differences between two results, as plain data.

use super::fields::{self, FieldDifference, NEGLIGIBLE};
use contract::figure::Measure;
use pages::source::Results;
use run::format::stem_and_unit;
use run::results::figures::{Group, groups};
use serde::Serialize;
use std::collections::BTreeMap;
use studies::study::quantity::{Quantities, Quantity};
use toml::Value;

/// Differences between two results.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Comparison {
    /// Keys of the case whose values differ, or that one result lacks.
    pub case: Vec<KeyDifference>,
    /// Figures that differ, the largest relative difference first.
    pub figures: Vec<FigureDifference>,
    /// Number of figures with equal digits.
    pub same_figures: usize,
    /// Fields that differ, and those that one result lacks.
    pub fields: Vec<FieldDifference>,
    /// Number of bit-identical fields.
    pub same_fields: usize,
    /// Times \[s\] of both results.
    pub times: Vec<(String, [f64; 2])>,
}

/// A key of the case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct KeyDifference {
    /// Dotted key.
    pub key: String,
    /// Value in A, if any.
    pub a: Option<String>,
    /// Value in B, if any.
    pub b: Option<String>,
}

/// A figure of the summaries.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct FigureDifference {
    /// Dotted key in `summary.json`.
    pub key: String,
    /// Name for people.
    pub name: String,
    /// Value in A, if any.
    pub a: Option<f64>,
    /// Value in B, if any.
    pub b: Option<f64>,
    /// Scale of the change.
    pub measure: Measure,
    /// Change from A to B: B/A − 1 for a relative measure, else B − A. `None` if A is zero or a
    /// value is missing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub change: Option<f64>,
}

/// Largest difference of two places \[m\] that counts as rounding.
const NEGLIGIBLE_PLACE: f64 = 1e-9;

impl FigureDifference {
    fn of(quantity: Quantity, [a, b]: [Option<f64>; 2]) -> Self {
        let change = a.zip(b).and_then(|(a, b)| quantity.change(a, b));
        let Quantity { key, name, measure, .. } = quantity;
        Self { key, name, a, b, measure, change }
    }

    /// Returns the difference over the larger magnitude; infinite if a value is missing.
    fn size(&self) -> f64 {
        let share = |(a, b): (f64, f64)| (b - a).abs() / a.abs().max(b.abs());
        self.a.zip(self.b).map_or(f64::INFINITY, share)
    }

    /// Both values agree within rounding.
    pub(super) fn is_negligible(&self) -> bool {
        let close = |(a, b): (f64, f64)| match self.measure {
            Measure::Absolute if stem_and_unit(&self.key).1 == "m" => {
                (b - a).abs() <= NEGLIGIBLE_PLACE
            }
            Measure::Absolute => (b - a).abs() <= NEGLIGIBLE,
            Measure::Relative | Measure::Itself => self.size() <= NEGLIGIBLE,
        };
        self.a.zip(self.b).is_some_and(close)
    }
}

impl Comparison {
    /// Returns true if only times differ.
    #[must_use]
    pub(crate) fn is_same(&self) -> bool {
        self.case.is_empty() && self.figures.is_empty() && self.fields.is_empty()
    }

    /// Compares two results.
    #[must_use]
    pub(super) fn of(a: &Results, b: &Results) -> Self {
        let (figures, same_figures) = figures(a, b);
        let (fields, same_fields) = fields::differences(a, b);
        Self { case: keys(a, b), figures, same_figures, fields, same_fields, times: times(a, b) }
    }
}

fn keys(a: &Results, b: &Results) -> Vec<KeyDifference> {
    let [of_a, of_b] = [a, b].map(|one| dotted(&one.case));
    let all: std::collections::BTreeSet<&String> = of_a.keys().chain(of_b.keys()).collect();
    let of = |key: &&String| KeyDifference {
        key: (*key).clone(),
        a: of_a.get(*key).cloned(),
        b: of_b.get(*key).cloned(),
    };
    all.iter().map(of).filter(|one| one.a != one.b).collect()
}

/// Returns the figures that differ, and the number of equal ones.
fn figures(a: &Results, b: &Results) -> (Vec<FigureDifference>, usize) {
    let shown = [shown(a), shown(b)].concat();
    let described = [a.figures(), b.figures()].concat();
    let quantities = Quantities::of_figures(&described);
    let mut known: Vec<&str> = Vec::new();
    for one in a.figures().iter().chain(b.figures()).filter(|one| !one.is_of_a_list()) {
        // Differences below the shown digits of both values are rounding.
        let is_rounding = one.line.is_some() && !shown.contains(&one.key.as_str());
        if !is_rounding && !known.contains(&one.key.as_str()) {
            known.push(&one.key);
        }
    }
    let (mut different, mut same) = (Vec::new(), 0);
    for quantity in known.into_iter().map(|key| quantities.of(key)) {
        let values = [a, b].map(|one| quantity.value(one.summary.as_ref()?));
        match values {
            [None, None] => {}
            [Some(x), Some(y)] if x == y => same += 1,
            _ => different.push(FigureDifference::of(quantity, values)),
        }
    }
    different.sort_by(|one, other| other.size().total_cmp(&one.size()));
    (different, same)
}

/// Returns the keys of the figures that are shown on the terminal.
fn shown(of: &Results) -> Vec<&str> {
    let lines = groups(of.sections(), of.figures()).into_iter().filter_map(|group| match group {
        Group::Line(line) => Some(line.entries),
        Group::List(_) => None,
    });
    lines.flatten().map(|entry| entry.figure.key.as_str()).collect()
}

fn times(a: &Results, b: &Results) -> Vec<(String, [f64; 2])> {
    let [of_a, of_b] = [a, b].map(|one| one.summary.as_ref().map(|summary| summary.cost.times()));
    let of_b = of_b.unwrap_or_default();
    let both = of_a.unwrap_or_default().into_iter().filter_map(|(name, a)| {
        let (_, b) = of_b.iter().find(|(other, _)| *other == name)?;
        Some((name, [a, *b]))
    });
    both.collect()
}

/// Returns the keys of a case with their values as written; empty if the text is not a case.
fn dotted(text: &str) -> BTreeMap<String, String> {
    let mut all = BTreeMap::new();
    if let Ok(table) = toml::from_str::<toml::Table>(text) {
        spread(&Value::Table(table), String::new(), &mut all);
    }
    all
}

fn spread(value: &Value, key: String, all: &mut BTreeMap<String, String>) {
    match value {
        Value::Table(entries) if !entries.is_empty() => {
            for (name, value) in entries {
                let inner = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
                spread(value, inner, all);
            }
        }
        Value::String(text) => drop(all.insert(key, text.clone())),
        other => drop(all.insert(key, other.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_spread_and_empty_ones_stay() {
        let all = dotted("[a]\nb = \"1 kN\"\nc = [1, 2]\n[effects.x]\n[a.d]\ne = 2.5\n");
        let all: Vec<(&str, &str)> = all.iter().map(|(k, v)| (k.as_str(), v.as_str())).collect();
        let expected = [("a.b", "1 kN"), ("a.c", "[1, 2]"), ("a.d.e", "2.5"), ("effects.x", "{}")];
        assert_eq!(all, expected);
        assert!(dotted("= 3").is_empty());
    }
}
