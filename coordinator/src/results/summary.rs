//! `summary.json`, schema 1. A quantity that nobody can give is absent, never 0.

use crate::plan::Plan;
use proto::message::Finished;
use serde_json::{Map, Value, json};

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Every window met its convergence measures.
    Converged,
    /// An explicit scheme went through; there was nothing to converge.
    Completed,
    /// It did not.
    Failed,
}

impl Status {
    /// The word in `summary.json`.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Completed => "completed",
            Self::Failed => "failed",
        }
    }
}

/// What the coupling counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// Windows accepted.
    pub windows: u64,
    /// Iterations in all.
    pub iterations: u64,
    /// Most iterations in one window.
    pub max_iterations_in_window: u32,
    /// Residual of the last iteration.
    pub final_residual: Option<f64>,
    /// Largest heat imbalance of a window, relative.
    pub energy_imbalance: Option<f64>,
    /// Seconds in the window loop that are neither a model's nor the output's.
    pub coupling_seconds: f64,
    /// Seconds spent on writing results.
    pub output_seconds: f64,
    /// Bytes of field values exchanged.
    pub bytes_exchanged: u64,
}

/// Everything that goes into the summary.
#[derive(Debug)]
pub struct Ingredients<'a> {
    /// What ran.
    pub plan: &'a Plan,
    /// How it ended.
    pub status: Status,
    /// Why it ended so.
    pub reason: String,
    /// What the coupling counted.
    pub counts: Counts,
    /// What the participants say, in the plan's order; empty when the run failed.
    pub finished: &'a [Finished],
    /// Seconds from the start of the program.
    pub wall_seconds: f64,
}

/// Builds the summary.
#[must_use]
pub fn build(of: &Ingredients) -> Value {
    let mut summary = json!({
        "schema": 1,
        "case": of.plan.name,
        "status": of.status.word(),
        "reason": of.reason,
    });
    for finished in of.finished {
        merge(&mut summary, &finished.summary);
    }
    place_over_semi_axis(&mut summary);
    merge(
        &mut summary,
        &json!({
            "coupling": coupling(of),
            "cost": cost(of),
            "effects": {
                "active": effects(of.plan, true),
                "inactive": effects(of.plan, false),
            },
        }),
    );
    summary
}

fn coupling(of: &Ingredients) -> Value {
    let counts = &of.counts;
    let mut section = json!({
        "scheme": of.plan.scheme.name,
        "acceleration": "none",
        "windows": counts.windows,
        "iterations": counts.iterations,
        "max_iterations_in_window": counts.max_iterations_in_window,
    });
    let optional =
        [("final_residual", counts.final_residual), ("energy_imbalance", counts.energy_imbalance)];
    for (key, value) in optional {
        if let Some(value) = value {
            section[key] = value.into();
        }
    }
    section
}

fn cost(of: &Ingredients) -> Value {
    let mut section = Map::new();
    section.insert("wall_s".to_owned(), of.wall_seconds.into());
    for (participant, finished) in of.plan.participants.iter().zip(of.finished) {
        section.insert(format!("{}_s", participant.role), finished.model_seconds.into());
    }
    section.insert("coupling_s".to_owned(), of.counts.coupling_seconds.into());
    section.insert("output_s".to_owned(), of.counts.output_seconds.into());
    for (participant, finished) in of.plan.participants.iter().zip(of.finished) {
        if finished.peak_rss_bytes > 0 {
            let key = format!("{}_peak_rss_bytes", participant.role);
            section.insert(key, finished.peak_rss_bytes.into());
        }
    }
    section.insert("bytes_exchanged".to_owned(), of.counts.bytes_exchanged.into());
    Value::Object(section)
}

fn effects(plan: &Plan, active: bool) -> Vec<&str> {
    plan.effects.iter().filter(|e| e.active == active).map(|e| e.name.as_str()).collect()
}

/// `x_over_a` of every hottest point, with the semi-axis a of this run.
fn place_over_semi_axis(summary: &mut Value) {
    let Some(a) = summary.pointer("/contact/semi_axis_a_m").and_then(Value::as_f64) else { return };
    let bodies = summary.get_mut("temperature").and_then(Value::as_object_mut);
    for body in bodies.into_iter().flat_map(Map::values_mut) {
        if let Some(x) = body.get("x_m").and_then(Value::as_f64) {
            body["x_over_a"] = (x / a).into();
        }
    }
}

/// Objects are merged key by key; anything else replaces.
fn merge(into: &mut Value, from: &Value) {
    match (into, from) {
        (Value::Object(into), Value::Object(from)) => {
            for (key, value) in from {
                merge(into.entry(key.as_str()).or_insert(Value::Null), value);
            }
        }
        (into, from) => *into = from.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_merge_and_places_are_scaled() {
        let mut summary = json!({"contact": {"semi_axis_a_m": 0.008}});
        merge(&mut summary, &json!({"temperature": {"rail": {"x_m": -0.004}, "wheel": {}}}));
        merge(&mut summary, &json!({"contact": {"area_m2": 1.0}}));
        place_over_semi_axis(&mut summary);
        let expected = json!({
            "contact": {"semi_axis_a_m": 0.008, "area_m2": 1.0},
            "temperature": {"rail": {"x_m": -0.004, "x_over_a": -0.5}, "wheel": {}},
        });
        assert_eq!(summary, expected);
    }
}
