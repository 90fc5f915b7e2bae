//! `summary.json`, schema 1. An unknown quantity is absent, never 0.
//!
//! The coordinator's own entries are typed. The sections of the participants are merged
//! ([`Sections::gather`]) and hold the figures that their descriptions name. A figure is read by
//! its dotted key ([`Summary::value`]). Participants cannot write the coordinator's own keys, nor
//! change a value that another participant has given.

use super::cost::Cost;
use super::counts::Counts;
use super::extremes::Extremes;
use super::stated::Stated;
use crate::plan::Plan;
use crate::warnings::Warning;
use contract::figure;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Status of a run at its end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Every window of an implicit scheme has converged.
    Converged,
    /// The run is complete without every window having converged: the scheme is explicit, or
    /// windows of an implicit scheme have not converged in a case that is not strict.
    Completed,
    /// An error has ended the run.
    #[default]
    Failed,
    /// The user has stopped the run.
    Interrupted,
}

impl Status {
    /// Returns whether the run ended before its last window.
    #[must_use]
    pub fn ended_early(self) -> bool {
        matches!(self, Self::Failed | Self::Interrupted)
    }

    /// Returns the word in `summary.json`.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Completed => "completed",
            Self::Failed => "failed",
            Self::Interrupted => "interrupted",
        }
    }
}

/// Contents of `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Version of the layout.
    pub schema: u32,
    /// Name of the case.
    pub case: String,
    /// Status at the end.
    pub status: Status,
    /// Reason for the status.
    pub reason: String,
    /// Sections of the participants, as one object.
    #[serde(flatten)]
    pub sections: Value,
    /// Warnings of the case, of the plan and of the run.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<Warning>,
    /// Smallest and largest values over several windows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extremes: Option<Extremes>,
    /// Counts of the coupling.
    #[serde(default)]
    pub coupling: CouplingSummary,
    /// Times, memory and exchanged bytes.
    #[serde(default)]
    pub cost: Cost,
    /// Effects of the case.
    #[serde(default)]
    pub effects: Effects,
    /// Stated error of the result, if it was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<Stated>,
}

/// Section `coupling`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct CouplingSummary {
    /// Word of the scheme.
    pub scheme: String,
    /// Word of the acceleration.
    pub acceleration: String,
    /// Number of accepted windows.
    pub windows: u64,
    /// Number of iterations in all windows.
    pub iterations: u64,
    /// Largest number of iterations in a window.
    pub max_iterations_in_window: u32,
    /// Largest relative residual of the last iteration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub final_residual: Option<f64>,
    /// Gain of the loop in a steady case.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loop_gain: Option<f64>,
    /// Largest relative imbalance of the conservative fields in a window.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_imbalance: Option<f64>,
    /// Participants that consume a conservative field and do not report the power they receive.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub heat_not_reported_by: Vec<String>,
    /// Number of skipped rows; `None` where rows are not skipped.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rows_without_answer: Option<u64>,
    /// Number of windows that were solved again with another length; `None` with fixed windows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repeated_windows: Option<u64>,
    /// Shortest window \[s\]; `None` with fixed windows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shortest_window_s: Option<f64>,
    /// Longest window \[s\]; `None` with fixed windows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub longest_window_s: Option<f64>,
}

/// Section `effects`: names of the effects that a case names, and of all others.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Effects {
    /// Effects of the case.
    pub active: Vec<String>,
    /// Other effects.
    pub inactive: Vec<String>,
}

impl Default for Summary {
    fn default() -> Self {
        Self {
            schema: Self::SCHEMA,
            case: String::new(),
            status: Status::default(),
            reason: String::new(),
            sections: Value::Object(Map::new()),
            warnings: Vec::new(),
            extremes: None,
            coupling: CouplingSummary::default(),
            cost: Cost::default(),
            effects: Effects::default(),
            accuracy: None,
        }
    }
}

impl Summary {
    /// Version of the layout.
    pub const SCHEMA: u32 = 1;

    /// Returns the summary of a run that has sent nothing but these sections.
    #[must_use]
    pub fn of_sections(sections: Value) -> Self {
        Self { sections, ..Self::default() }
    }

    /// Returns the number under a dotted key: a figure of a participant, or any other number.
    #[must_use]
    pub fn value(&self, key: &str) -> Option<f64> {
        figure::value(&self.sections, key).or_else(|| {
            let own = key.split('.').next().is_some_and(|section| OWN.contains(&section));
            own.then(|| figure::value(&self.to_value(), key)).flatten()
        })
    }

    /// Returns the content of the file as JSON.
    #[must_use]
    pub fn to_value(&self) -> Value {
        serde_json::to_value(self).expect("a summary is plain data")
    }

    /// Returns the text of the file.
    #[must_use]
    pub fn to_json(&self) -> Vec<u8> {
        serde_json::to_vec_pretty(self).expect("a summary is plain data")
    }
}

impl CouplingSummary {
    /// Returns the section of a run with this plan and these counts.
    #[must_use]
    pub fn of(plan: &Plan, counts: &Counts) -> Self {
        let finite = |value: Option<f64>| value.filter(|value| value.is_finite());
        let silent = plan.participants.iter().enumerate();
        let silent = silent.filter(|(one, _)| counts.unreported >> one & 1 == 1);
        Self {
            scheme: plan.scheme.scheme.word().to_owned(),
            acceleration: plan.acceleration().word().to_owned(),
            windows: counts.windows,
            iterations: counts.iterations,
            max_iterations_in_window: counts.max_iterations_in_window,
            final_residual: finite(counts.final_residual),
            loop_gain: finite(counts.loop_gain),
            energy_imbalance: finite(counts.energy_imbalance),
            heat_not_reported_by: silent.map(|(_, participant)| participant.role.clone()).collect(),
            rows_without_answer: plan.skips.then_some(counts.skipped),
            repeated_windows: counts.repeated_windows,
            shortest_window_s: counts.window_lengths.map(|(shortest, _)| shortest),
            longest_window_s: counts.window_lengths.map(|(_, longest)| longest),
        }
    }
}

impl Effects {
    /// Returns the effects of a plan.
    #[must_use]
    pub fn of(plan: &Plan) -> Self {
        let named = |active| {
            let effects = plan.effects.iter().filter(|effect| effect.active == active);
            effects.map(|effect| effect.name.clone()).collect()
        };
        Self { active: named(true), inactive: named(false) }
    }
}

/// Keys that only the coordinator writes.
const OWN: [&str; 10] = [
    "schema", "case", "status", "reason", "warnings", "extremes", "coupling", "cost", "effects",
    "accuracy",
];

/// Sections of all participants, in one object.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sections {
    /// Merged sections.
    pub merged: Map<String, Value>,
    /// Role and dotted key of the first quantity that is not finite; the quantity is omitted.
    pub not_finite: Option<(String, String)>,
    /// Warnings about omitted entries.
    pub warnings: Vec<Warning>,
}

impl Sections {
    /// Merges the sections of all roles. Invalid entries are omitted, with a warning.
    #[must_use]
    pub fn gather<'a>(said: impl IntoIterator<Item = (&'a str, &'a Value)>) -> Self {
        let mut sections = Self::default();
        for (role, summary) in said {
            match summary {
                Value::Object(summary) => sections.take(role, summary),
                _ => sections.leave_out(role, "its summary is not an object"),
            }
        }
        sections
    }

    fn take(&mut self, role: &str, summary: &Map<String, Value>) {
        for (key, value) in summary {
            if OWN.contains(&key.as_str()) {
                self.leave_out(key, &format!("{role} writes a section of the coordinator"));
                continue;
            }
            let mut not_finite = Vec::new();
            let value = finite(value, key, &mut not_finite);
            for key in not_finite {
                self.leave_out(&key, &format!("{role} reports a quantity that is not finite"));
                self.not_finite.get_or_insert_with(|| (role.to_owned(), key));
            }
            if let Some(value) = value {
                let mut twice = Vec::new();
                merge(&mut self.merged, key, value, String::new(), &mut twice);
                for key in twice {
                    self.leave_out(
                        &key,
                        &format!(
                            "{role} reports a value that another participant has already reported"
                        ),
                    );
                }
            }
        }
    }

    /// Warns that an entry of a participant's summary is omitted.
    fn leave_out(&mut self, key: &str, reason: &str) {
        let warning = Warning::remark(key, reason, "the entry is omitted");
        tracing::warn!("{warning}");
        self.warnings.push(warning);
    }
}

/// Returns the value without quantities that are not finite, which JSON writes as `null`. A list
/// with such a quantity is omitted as a whole. Notes the dotted keys of the omitted quantities.
fn finite(value: &Value, key: &str, not_finite: &mut Vec<String>) -> Option<Value> {
    match value {
        Value::Null => {
            not_finite.push(key.to_owned());
            None
        }
        Value::Array(items) => {
            let item = |(n, item)| finite(item, &format!("{key}[{n}]"), not_finite);
            items.iter().enumerate().map(item).collect::<Option<Vec<_>>>().map(Value::Array)
        }
        Value::Object(entries) => {
            let entry = |(name, value): (&String, &Value)| {
                let value = finite(value, &format!("{key}.{name}"), not_finite)?;
                Some((name.clone(), value))
            };
            Some(Value::Object(entries.iter().filter_map(entry).collect()))
        }
        other => Some(other.clone()),
    }
}

/// Merges objects key by key. Of two other values with the same key the first one stays, and the
/// dotted key is noted in `twice`.
fn merge(
    into: &mut Map<String, Value>,
    key: &str,
    value: Value,
    section: String,
    twice: &mut Vec<String>,
) {
    match (into.get_mut(key), value) {
        (None, value) => {
            into.insert(key.to_owned(), value);
        }
        (Some(Value::Object(there)), Value::Object(more)) => {
            for (name, value) in more {
                merge(there, &name, value, format!("{section}{key}."), twice);
            }
        }
        (Some(_), _) => twice.push(format!("{section}{key}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn sections_merge() {
        let mech = json!({"contact": {"semi_axis_a_m": 0.008}});
        let thermal = json!({
            "temperature": {"rail": {"x_m": -0.004}, "wheel": {}},
            "contact": {"area_m2": 1.0},
        });
        let sections = Sections::gather([("mech", &mech), ("thermal", &thermal)]);
        let expected = json!({
            "contact": {"semi_axis_a_m": 0.008, "area_m2": 1.0},
            "temperature": {"rail": {"x_m": -0.004}, "wheel": {}},
        });
        assert_eq!(Value::Object(sections.merged), expected);
        assert_eq!(sections.not_finite, None);
    }

    #[test]
    fn nobody_writes_the_coordinators_keys_or_anothers_figures() {
        let good = json!({"contact": {"area_m2": 1.0}});
        let forged = json!({
            "schema": 7, "case": "x", "status": "failed", "reason": "x",
            "coupling": 3, "cost": {"wall_s": 0.0}, "effects": null,
            "contact": {"area_m2": 2.0},
        });
        let scalar = json!({"contact": 3, "temperature": 3});
        for other in [&Value::Null, &json!([1]), &json!("x"), &forged] {
            let sections = Sections::gather([("mech", &good), ("other", other)]);
            assert_eq!(Value::Object(sections.merged), good);
            assert_eq!(sections.not_finite, None);
        }
        let sections = Sections::gather([("mech", &good), ("other", &scalar)]);
        assert_eq!(sections.warnings[0].key(), "contact");
        let sections = Sections::gather([("mech", &good), ("other", &forged)]);
        let keys: Vec<&str> = sections.warnings.iter().map(Warning::key).collect();
        assert_eq!(keys.len(), 8, "{keys:?}");
        assert!(keys.contains(&"contact.area_m2"), "{keys:?}");
        let sections = Sections::gather([("mech", &good), ("other", &scalar)]);
        let expected = json!({"contact": {"area_m2": 1.0}, "temperature": 3});
        assert_eq!(Value::Object(sections.merged), expected);
    }

    #[test]
    fn a_figure_that_is_not_finite_is_absent_and_reported() {
        let said = json!({"contact": {"area_m2": f64::NAN, "list": [1.0, f64::INFINITY], "n": 1}});
        let sections = Sections::gather([("mech", &said)]);
        assert_eq!(Value::Object(sections.merged), json!({"contact": {"n": 1}}));
        let entry = sections.not_finite.unwrap();
        assert_eq!(entry, ("mech".to_owned(), "contact.area_m2".to_owned()));
    }
}
