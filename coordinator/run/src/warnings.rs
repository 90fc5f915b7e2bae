//! What is hardly so: values of a case and figures of its answer beyond what their descriptions expect.

use contract::figure::{FigureSpec, value};
use contract::plausible::Plausible;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fmt;

/// A value that is not expected.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Warning {
    /// Dotted key of the case, or of the summary.
    pub key: String,
    /// What of it the value is, if it is not its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quantity: Option<String>,
    /// The value (SI).
    pub value: f64,
    /// Its SI unit.
    pub unit: String,
    /// The bound that it is beyond.
    pub bound: f64,
    /// Why that is a bound.
    pub why: String,
}

impl Warning {
    /// Of a value, if it is beyond what is expected.
    pub(crate) fn of(key: &str, value: f64, unit: &str, expected: &Plausible) -> Option<Self> {
        let bound = expected.bound_passed(value)?;
        let unit = if unit == "1" { String::new() } else { unit.to_owned() };
        let (key, why) = (key.to_owned(), expected.why.clone());
        Some(Self { key, quantity: None, value, unit, bound, why })
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { key, quantity, value, unit, bound, why } = self;
        let side = if value.abs() < *bound { "at least" } else { "at most" };
        let space = if unit.is_empty() { "" } else { " " };
        let is = match quantity {
            Some(quantity) => format!("has a {quantity} of"),
            None => "is".to_owned(),
        };
        write!(
            f,
            "{key} {is} {}{space}{unit}, {side} {}{space}{unit} is expected: {why}",
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

#[cfg(test)]
mod tests {
    use super::*;

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
