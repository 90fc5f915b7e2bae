//! Warnings about a case, a plan or a result that may not be as intended.
//!
//! There is a single list. Planning starts it ([`crate::plan::Plan::warnings`]). `check` and `plan`
//! print it; commands that run a case write it to standard error and the log. A run adds its own
//! warnings, and the summary holds all of them. With `--strict` each of them is an error.

use crate::results::history::HistoryRanges;
use case::Problem;
use contract::figure::{FigureSpec, value};
use contract::plausible::Plausible;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fmt;

/// A warning: the case runs, but may not be as intended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Warning {
    /// A value beyond what its description expects.
    Value(Implausible),
    /// Any other warning.
    Remark(Remark),
}

/// A value beyond what its description expects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Implausible {
    /// Dotted key of the case, or of the summary.
    pub key: String,
    /// Place in the case; absent for a key of the summary.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<String>,
    /// Name of a derived quantity, if the value is not that of the key itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quantity: Option<String>,
    /// Value in SI units.
    pub value: f64,
    /// SI unit.
    pub unit: String,
    /// Bound that the value exceeds, or falls below.
    pub bound: f64,
    /// Reason for the bound.
    pub why: String,
}

/// Any other warning, as text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Remark {
    /// Dotted key of the case, or of the summary; several are separated by commas.
    pub key: String,
    /// Place in the case, if it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<String>,
    /// Reason for the warning.
    pub reason: String,
    /// Advice to the user.
    pub fix: String,
}

impl Warning {
    /// Returns a remark about a key of the summary, or about a key without a place in the case.
    pub(crate) fn remark(key: &str, reason: impl Into<String>, fix: &str) -> Self {
        let (key, reason, fix) = (key.to_owned(), reason.into(), fix.to_owned());
        Self::Remark(Remark { key, place: None, reason, fix })
    }

    /// Returns a warning about a value that is beyond its expected bounds; `None` if it is within
    /// them.
    pub(crate) fn of(
        key: &str,
        place: Option<String>,
        value: f64,
        unit: &str,
        expected: &Plausible,
    ) -> Option<Self> {
        let bound = expected.bound_passed(value)?;
        let unit = if unit == "1" { String::new() } else { unit.to_owned() };
        let (key, why) = (key.to_owned(), expected.why.clone());
        Some(Self::Value(Implausible { key, place, quantity: None, value, unit, bound, why }))
    }

    /// Returns whether another warning has the same text, even if its key stands elsewhere.
    pub(crate) fn says_the_same(&self, other: &Self) -> bool {
        self.to_string() == other.to_string()
    }

    /// Returns the dotted key of the case, or of the summary.
    #[must_use]
    pub fn key(&self) -> &str {
        match self {
            Self::Value(Implausible { key, .. }) | Self::Remark(Remark { key, .. }) => key,
        }
    }
}

/// Turns a problem that is no error into a remark with place, reason and fix.
impl From<Problem> for Warning {
    fn from(problem: Problem) -> Self {
        let Problem { place, key, reason, fix } = problem;
        Self::Remark(Remark { key, place: Some(place.to_string()), reason, fix })
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value(implausible) => implausible.fmt(f),
            Self::Remark(Remark { key, reason, fix, .. }) => write!(f, "{key}: {reason}; {fix}"),
        }
    }
}

impl fmt::Display for Implausible {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { key, quantity, value, unit, bound, why, .. } = self;
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

/// Formats a number as written by hand.
pub(crate) fn plain(value: f64) -> String {
    let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    if (1e-3..1e6).contains(&rounded.abs()) { rounded.to_string() } else { format!("{rounded:e}") }
}

/// Returns the warnings about the figures of a run: of its end, and of all windows, where one
/// of them is farther outside the plausible range than the end. `rows` names windows rows.
#[must_use]
pub fn of_figures(
    sections: &Value,
    figures: &[FigureSpec],
    history: Option<&HistoryRanges>,
    rows: bool,
) -> Vec<Warning> {
    let of = |figure: &FigureSpec| {
        let expected = figure.plausible.as_ref()?;
        let last = value(sections, &figure.key);
        let excess = last.and_then(|last| expected.excess(last)).unwrap_or(1.0);
        let worst = history.and_then(|history| history.unexpected(&figure.key, rows));
        let worse = worst.filter(|worst| expected.excess(worst.value) > Some(excess));
        let told = worse.as_ref().map(|worst| worst.value).or(last)?;
        let mut warning = Warning::of(&figure.key, None, told, &figure.unit, expected)?;
        if let Warning::Value(implausible) = &mut warning {
            implausible.quantity = worse.map(|worst| format!("value in {}", worst.place));
        }
        Some(warning)
    };
    figures.iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn radius() -> Warning {
        let expected =
            Plausible { least: None, most: Some(50.0), why: "no wheel is larger".to_owned() };
        assert_eq!(Warning::of("x", None, 40.0, "m", &expected), None);
        Warning::of("bodies.wheel.radius_x", None, 460.0, "m", &expected).unwrap()
    }

    #[test]
    fn a_warning_says_all() {
        let text = "bodies.wheel.radius_x is 460 m, at most 50 m is expected: no wheel is larger";
        assert_eq!(radius().to_string(), text);
        let remark =
            Warning::remark("mapping.method", "the density is not bounded", "choose another");
        assert_eq!(
            remark.to_string(),
            "mapping.method: the density is not bounded; choose another"
        );
    }
}
