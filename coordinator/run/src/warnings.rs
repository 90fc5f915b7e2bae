//! What is hardly so: values of a case and figures of its answer beyond what their descriptions expect.

use crate::plan::Participant;
use contract::description::KeySpec;
use contract::figure::{FigureSpec, value};
use contract::params::Params;
use contract::plausible::Plausible;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fmt;

/// A value that is not expected.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Warning {
    /// Dotted key of the case, or of the summary.
    pub key: String,
    /// Its value (SI).
    pub value: f64,
    /// Its SI unit.
    pub unit: String,
    /// The bound that it is beyond.
    pub bound: f64,
    /// Why that is a bound.
    pub why: String,
}

impl Warning {
    fn of(key: &str, value: f64, unit: &str, expected: &Plausible) -> Option<Self> {
        let bound = expected.bound_passed(value)?;
        let unit = if unit == "1" { String::new() } else { unit.to_owned() };
        Some(Self { key: key.to_owned(), value, unit, bound, why: expected.why.clone() })
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { key, value, unit, bound, why } = self;
        let side = if value.abs() < *bound { "at least" } else { "at most" };
        let space = if unit.is_empty() { "" } else { " " };
        write!(
            f,
            "{key} is {}{space}{unit}, {side} {}{space}{unit} is expected: {why}",
            plain(*value),
            plain(*bound)
        )
    }
}

/// A number as a person would write it.
fn plain(value: f64) -> String {
    let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    if (1e-3..1e6).contains(&rounded.abs()) { rounded.to_string() } else { format!("{rounded:e}") }
}

/// Of the values that participants read.
#[must_use]
pub fn of_case<'a>(participants: impl Iterator<Item = &'a Participant>) -> Vec<Warning> {
    let mut warnings: Vec<Warning> = Vec::new();
    for participant in participants {
        let (description, given) = (&participant.description, &participant.configuration);
        let model = description.models.iter().find(|model| model.name == given.model);
        let effects = description.effects.iter().filter(|effect| given.has_effect(&effect.name));
        let keys = description.keys.iter().chain(model.into_iter().flat_map(|model| &model.keys));
        for KeySpec { path, kind, plausible, .. } in
            keys.chain(effects.flat_map(|effect| &effect.keys))
        {
            let Some(expected) = plausible else { continue };
            for (key, value) in instances(&given.case, path) {
                let warning = Warning::of(&key, value, kind.unit(), expected);
                warnings.extend(
                    warning.filter(|one| warnings.iter().all(|other| other.key != one.key)),
                );
            }
        }
    }
    warnings
}

/// Those that a summary has.
#[must_use]
pub fn of_summary(summary: &Value) -> Vec<Warning> {
    summary.get("warnings").and_then(|list| Vec::deserialize(list).ok()).unwrap_or_default()
}

/// Of the figures of a summary.
#[must_use]
pub fn of_figures(summary: &Value, figures: &[FigureSpec]) -> Vec<Warning> {
    let of = |figure: &FigureSpec| {
        let expected = figure.plausible.as_ref()?;
        Warning::of(&figure.key, value(summary, &figure.key)?, &figure.unit, expected)
    };
    figures.iter().filter_map(of).collect()
}

/// The numbers of a case under a path in which `*` stands for any one name.
fn instances(case: &Params, path: &str) -> Vec<(String, f64)> {
    let mut found = vec![(String::new(), &case.0)];
    for part in path.split('.') {
        found = found
            .into_iter()
            .flat_map(|(key, value)| {
                let table = value.as_object().into_iter().flatten();
                table.filter(|(name, _)| part == "*" || part == *name).map(move |(name, value)| {
                    let key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
                    (key, value)
                })
            })
            .collect();
    }
    found.into_iter().filter_map(|(key, value)| Some((key, value.as_f64()?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn names_stand_for_stars() {
        let case =
            Params(json!({"bodies": {"a": {"r": 1.0}, "b": {"r": 2.0, "s": 3.0}}, "r": 4.0}));
        let found = instances(&case, "bodies.*.r");
        assert_eq!(found, [("bodies.a.r".to_owned(), 1.0), ("bodies.b.r".to_owned(), 2.0)]);
        assert!(instances(&case, "bodies.*.t").is_empty());
    }

    #[test]
    fn a_warning_says_all() {
        let expected =
            Plausible { least: None, most: Some(50.0), why: "no wheel is larger".to_owned() };
        let warning = Warning::of("bodies.wheel.radius_x", 460.0, "m", &expected).unwrap();
        let text = "bodies.wheel.radius_x is 460 m, at most 50 m is expected: no wheel is larger";
        assert_eq!(warning.to_string(), text);
        assert_eq!(Warning::of("x", 40.0, "m", &expected), None);
    }
}
