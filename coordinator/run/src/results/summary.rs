//! `summary.json`, schema 1. An unknown quantity is absent, never 0.
//!
//! The sections of the participants are merged first ([`Sections::gather`]). Participants cannot
//! write the coordinator's own keys, nor change a value that another participant has given.

use super::history::Extremes;
use crate::format::counted;
use crate::plan::Plan;
use crate::warnings::{self, Warning};
use contract::message::Finished;
use coupling::windows::Windows;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

/// Status of a run at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Every window of an implicit scheme has converged.
    Converged,
    /// The run is complete without every window having converged: the scheme is explicit, or
    /// windows of an implicit scheme have not converged in a case that is not strict.
    Completed,
    /// An error has ended the run.
    Failed,
    /// The user has stopped the run.
    Interrupted,
}

impl Status {
    /// Statuses of a run that ended before its last window.
    pub const ENDED_EARLY: [Self; 2] = [Self::Failed, Self::Interrupted];

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

/// Counts of the coupling.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counts {
    /// Number of accepted windows.
    pub windows: u64,
    /// Number of iterations in all windows.
    pub iterations: u64,
    /// Number of skipped rows of a sequence, which have no answer.
    pub skipped: u64,
    /// Number of accepted windows that have not converged.
    pub not_converged: u64,
    /// Largest number of iterations in a window.
    pub max_iterations_in_window: u32,
    /// Largest relative residual of the last iteration.
    pub final_residual: Option<f64>,
    /// Gain of the loop in a steady case.
    #[serde(skip)]
    pub loop_gain: Option<f64>,
    /// Largest relative imbalance of the conservative fields in a window.
    pub energy_imbalance: Option<f64>,
    /// One bit for each participant: set if it consumes a conservative field and does not report
    /// the heat it receives. A resumed run determines the bits again.
    #[serde(skip)]
    pub unreported: u64,
    /// Duration of planning [s].
    pub plan_seconds: f64,
    /// Time from the start of the first participant to the first window [s].
    pub start_seconds: f64,
    /// Time in which windows were solved but no model computed [s].
    pub coupling_seconds: f64,
    /// Time spent on accepting windows, observing fields and writing results [s].
    pub output_seconds: f64,
    /// Time from the last window to the end of the participants [s].
    pub finish_seconds: f64,
    /// Size of the exchanged field values [byte].
    pub bytes_exchanged: u64,
    /// Number of windows that were solved again with another length; `None` with fixed windows.
    pub repeated_windows: Option<u64>,
    /// Shortest and longest window [s]; `None` with fixed windows.
    pub window_lengths: Option<(f64, f64)>,
    /// Window at which the run was resumed; durations count from there.
    pub resumed_at: Option<u64>,
}

impl Counts {
    /// Returns the warnings about windows that were passed over or have not converged. The log
    /// names each of them.
    #[must_use]
    pub fn warnings(&self) -> Vec<Warning> {
        let remark = |count: u64, key, what: String, status: &str| {
            let fix = format!("find them by the status {status} in history.csv");
            (count > 0).then(|| Warning::remark(key, what, &fix))
        };
        let Self { skipped, not_converged, .. } = *self;
        let rows = format!("passes over {} without a result", counted(skipped, "row"));
        let windows = format!("accepts {} without convergence", counted(not_converged, "window"));
        let rows = remark(skipped, "time.on_failure", rows, "no-answer");
        rows.into_iter()
            .chain(remark(not_converged, "coupling.strict", windows, "not-converged"))
            .collect()
    }

    /// Returns the counts with which a run continues from a checkpoint. Durations start anew with
    /// the new process, which has just planned.
    #[must_use]
    pub fn resumed(self, plan_seconds: f64) -> Self {
        Self {
            plan_seconds,
            start_seconds: 0.0,
            coupling_seconds: 0.0,
            output_seconds: 0.0,
            finish_seconds: 0.0,
            resumed_at: Some(self.windows),
            ..self
        }
    }
}

/// Content of the summary.
#[derive(Debug)]
pub struct SummaryInput<'a> {
    /// Plan of the run.
    pub plan: &'a Plan,
    /// Status at the end.
    pub status: Status,
    /// Reason for the status.
    pub reason: String,
    /// Counts of the coupling.
    pub counts: Counts,
    /// Summaries of the participants, in the order of the plan; empty if the run failed earlier.
    pub finished: &'a [Finished],
    /// Merged sections of these summaries.
    pub sections: &'a Sections,
    /// Warnings of the case, of the plan and of the run.
    pub warnings: &'a [Warning],
    /// Smallest and largest values over the windows of a complete run.
    pub extremes: Option<&'a Extremes>,
    /// Time since the start of the program [s].
    pub wall_seconds: f64,
}

/// Keys that only the coordinator writes.
const OWN: [&str; 9] =
    ["schema", "case", "status", "reason", "warnings", "extremes", "coupling", "cost", "effects"];

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

/// Builds the summary.
#[must_use]
pub fn build(of: &SummaryInput) -> Value {
    let mut summary = json!({
        "schema": 1,
        "case": of.plan.name,
        "status": of.status.word(),
        "reason": of.reason,
    });
    for (key, value) in &of.sections.merged {
        summary[key] = value.clone();
    }
    let rows = matches!(of.plan.windows, Windows::Sequence(_));
    let figures = warnings::of_figures(&summary, &of.plan.figures, of.extremes, rows);
    let found = of.warnings.iter().chain(&of.sections.warnings).cloned();
    let warnings: Vec<Warning> = found.chain(figures).collect();
    if !warnings.is_empty() {
        summary["warnings"] = json!(warnings);
    }
    if let Some(extremes) = of.extremes.and_then(|extremes| extremes.section(rows)) {
        summary["extremes"] = extremes;
    }
    summary["coupling"] = coupling(of);
    summary["cost"] = cost(of);
    summary["effects"] = json!({
        "active": effects(of.plan, true),
        "inactive": effects(of.plan, false),
    });
    summary
}

fn coupling(of: &SummaryInput) -> Value {
    let counts = &of.counts;
    let mut section = json!({
        "scheme": of.plan.scheme.scheme.word(),
        "acceleration": of.plan.acceleration().word(),
        "windows": counts.windows,
        "iterations": counts.iterations,
        "max_iterations_in_window": counts.max_iterations_in_window,
    });
    let optional = [
        ("final_residual", counts.final_residual),
        ("loop_gain", counts.loop_gain),
        ("energy_imbalance", counts.energy_imbalance),
    ];
    for (key, value) in optional {
        if let Some(value) = value.filter(|value| value.is_finite()) {
            section[key] = value.into();
        }
    }
    let roles = of.plan.participants.iter().enumerate();
    let silent = roles.filter(|(one, _)| counts.unreported >> one & 1 == 1);
    let silent: Vec<&str> = silent.map(|(_, participant)| participant.role.as_str()).collect();
    if !silent.is_empty() {
        section["heat_not_reported_by"] = silent.into();
    }
    if of.plan.skips {
        section["rows_without_answer"] = counts.skipped.into();
    }
    if let Some(repeated) = counts.repeated_windows {
        section["repeated_windows"] = repeated.into();
    }
    if let Some((shortest, longest)) = counts.window_lengths {
        section["shortest_window_s"] = shortest.into();
        section["longest_window_s"] = longest.into();
    }
    section
}

fn cost(of: &SummaryInput) -> Value {
    let counts = &of.counts;
    let mut section = Map::new();
    if let Some(window) = counts.resumed_at {
        section.insert("resumed_at_window".to_owned(), window.into());
    }
    section.insert("wall_s".to_owned(), of.wall_seconds.into());
    section.insert("plan_s".to_owned(), counts.plan_seconds.into());
    section.insert("start_s".to_owned(), counts.start_seconds.into());
    let finished = || of.plan.participants.iter().zip(of.finished);
    for (participant, finished) in finished() {
        let key = format!("{}_s", participant.role);
        // A role cannot replace a measurement of the coordinator.
        section.entry(key).or_insert_with(|| finished.model_seconds.into());
    }
    section.insert("coupling_s".to_owned(), counts.coupling_seconds.into());
    section.insert("output_s".to_owned(), counts.output_seconds.into());
    section.insert("finish_s".to_owned(), counts.finish_seconds.into());
    for (participant, finished) in finished().filter(|(_, f)| f.peak_rss_bytes > 0) {
        let key = format!("{}_peak_rss_bytes", participant.role);
        section.insert(key, finished.peak_rss_bytes.into());
    }
    for (participant, finished) in finished().filter(|(_, f)| f.cpu_seconds > 0.0) {
        let key = format!("{}_cpu_s", participant.role);
        section.entry(key).or_insert_with(|| finished.cpu_seconds.into());
    }
    section.insert("bytes_exchanged".to_owned(), counts.bytes_exchanged.into());
    Value::Object(section)
}

fn effects(plan: &Plan, active: bool) -> Vec<&str> {
    plan.effects.iter().filter(|e| e.active == active).map(|e| e.name.as_str()).collect()
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

    #[test]
    fn windows_without_an_answer_are_told() {
        let counts = Counts { skipped: 2, not_converged: 1, ..Counts::default() };
        let told: Vec<String> = counts.warnings().iter().map(Warning::to_string).collect();
        let expected = [
            "time.on_failure: passes over 2 rows without a result; find them by the status \
             no-answer in history.csv",
            "coupling.strict: accepts 1 window without convergence; find them by the status \
             not-converged in history.csv",
        ];
        assert_eq!(told, expected);
        assert_eq!(Counts::default().warnings(), []);
    }

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
