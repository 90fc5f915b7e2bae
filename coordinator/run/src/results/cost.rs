//! The section `cost` of the summary: times, memory and exchanged bytes of a run.

use super::counts::Counts;
use crate::plan::Plan;
use contract::message::Finished;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Cost of a run. In the file each participant has the keys `ROLE_s`, `ROLE_cpu_s` and
/// `ROLE_peak_rss_bytes`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(into = "Map<String, Value>", from = "Map<String, Value>")]
pub struct Cost {
    /// Window at which the run was resumed; durations count from there.
    pub resumed_at_window: Option<u64>,
    /// Time since the start of the program \[s\].
    pub wall_s: f64,
    /// Duration of planning \[s\].
    pub plan_s: f64,
    /// Time from the start of the first participant to the first window \[s\].
    pub start_s: f64,
    /// Time in which windows were solved but no model computed \[s\].
    pub coupling_s: f64,
    /// Time spent on accepting windows, observing fields and writing results \[s\].
    pub output_s: f64,
    /// Time from the last window to the end of the participants \[s\].
    pub finish_s: f64,
    /// Size of the exchanged field values \[byte\].
    pub bytes_exchanged: u64,
    /// Participants, in the order of the plan; none if the run failed before their end.
    pub participants: Vec<ParticipantCost>,
}

/// Cost of a participant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParticipantCost {
    /// Role in the run.
    pub role: String,
    /// Time spent in the model \[s\].
    pub model_s: f64,
    /// Processor time of the process \[s\]; `None` if unknown.
    pub cpu_s: Option<f64>,
    /// Peak resident memory of the process \[byte\]; `None` if unknown.
    pub peak_rss_bytes: Option<u64>,
}

/// Endings of the keys of a participant.
const CPU: &str = "_cpu_s";
const MEMORY: &str = "_peak_rss_bytes";
const TIME: &str = "_s";

impl Cost {
    /// Returns the cost of a run that took this long \[s\].
    #[must_use]
    pub fn of(plan: &Plan, counts: &Counts, finished: &[Finished], wall_s: f64) -> Self {
        let participant = |(role, of): (&String, &Finished)| ParticipantCost {
            role: role.clone(),
            model_s: of.model_seconds,
            cpu_s: of.cpu_seconds,
            peak_rss_bytes: of.peak_rss_bytes,
        };
        let roles = plan.participants.iter().map(|participant| &participant.role);
        Self {
            resumed_at_window: counts.resumed_at,
            wall_s,
            plan_s: counts.plan_seconds,
            start_s: counts.start_seconds,
            coupling_s: counts.coupling_seconds,
            output_s: counts.output_seconds,
            finish_s: counts.finish_seconds,
            bytes_exchanged: counts.bytes_exchanged,
            participants: roles.zip(finished).map(participant).collect(),
        }
    }

    /// Returns all times with the names of their parts \[s\], in the order of the file.
    #[must_use]
    pub fn times(&self) -> Vec<(String, f64)> {
        let time = |(key, value): (String, Value)| {
            Some((key.strip_suffix(TIME)?.to_owned(), value.as_f64()?))
        };
        Map::from(self.clone()).into_iter().filter_map(time).collect()
    }
}

impl From<Cost> for Map<String, Value> {
    fn from(cost: Cost) -> Self {
        let mut section = Self::new();
        let mut add = |key: String, value: Value| {
            // A role cannot replace a measurement of the coordinator.
            section.entry(key).or_insert(value);
        };
        if let Some(window) = cost.resumed_at_window {
            add("resumed_at_window".to_owned(), window.into());
        }
        for (name, seconds) in
            [("wall", cost.wall_s), ("plan", cost.plan_s), ("start", cost.start_s)]
        {
            add(format!("{name}{TIME}"), seconds.into());
        }
        let own =
            [("coupling", cost.coupling_s), ("output", cost.output_s), ("finish", cost.finish_s)];
        for ParticipantCost { role, model_s, .. } in &cost.participants {
            if own.iter().all(|(name, _)| name != role) {
                add(format!("{role}{TIME}"), (*model_s).into());
            }
        }
        for (name, seconds) in own {
            add(format!("{name}{TIME}"), seconds.into());
        }
        for ParticipantCost { role, peak_rss_bytes, .. } in &cost.participants {
            if let Some(bytes) = peak_rss_bytes {
                add(format!("{role}{MEMORY}"), (*bytes).into());
            }
        }
        for ParticipantCost { role, cpu_s, .. } in &cost.participants {
            if let Some(seconds) = cpu_s {
                add(format!("{role}{CPU}"), (*seconds).into());
            }
        }
        add("bytes_exchanged".to_owned(), cost.bytes_exchanged.into());
        section
    }
}

impl From<Map<String, Value>> for Cost {
    fn from(mut section: Map<String, Value>) -> Self {
        let mut take = |key: &str| section.shift_remove(key);
        let window = take("resumed_at_window").and_then(|window| window.as_u64());
        let bytes = take("bytes_exchanged").and_then(|bytes| bytes.as_u64());
        let mut seconds = |key: &str| take(key).and_then(|time| time.as_f64()).unwrap_or(0.0);
        let mut cost = Self {
            resumed_at_window: window,
            wall_s: seconds("wall_s"),
            plan_s: seconds("plan_s"),
            start_s: seconds("start_s"),
            coupling_s: seconds("coupling_s"),
            output_s: seconds("output_s"),
            finish_s: seconds("finish_s"),
            bytes_exchanged: bytes.unwrap_or(0),
            participants: Vec::new(),
        };
        for (key, value) in &section {
            let role = key.strip_suffix(TIME).filter(|_| !key.ends_with(CPU));
            let (Some(role), Some(model_s)) = (role, value.as_f64()) else { continue };
            let of = |ending: &str| section.get(&format!("{role}{ending}"));
            cost.participants.push(ParticipantCost {
                role: role.to_owned(),
                model_s,
                cpu_s: of(CPU).and_then(Value::as_f64),
                peak_rss_bytes: of(MEMORY).and_then(Value::as_u64),
            });
        }
        cost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_gives_its_cost_back() {
        let participant = |role: &str, cpu_s, peak_rss_bytes| ParticipantCost {
            role: role.to_owned(),
            model_s: 0.25,
            cpu_s,
            peak_rss_bytes,
        };
        let participants =
            vec![participant("mech", Some(0.5), Some(1000)), participant("thermal", None, None)];
        let cost = Cost {
            wall_s: 2.0,
            finish_s: 0.125,
            bytes_exchanged: 64,
            participants,
            ..Cost::default()
        };
        let section = Map::from(cost.clone());
        let keys: Vec<&str> = section.keys().map(String::as_str).collect();
        let expected = [
            "wall_s",
            "plan_s",
            "start_s",
            "mech_s",
            "thermal_s",
            "coupling_s",
            "output_s",
            "finish_s",
            "mech_peak_rss_bytes",
            "mech_cpu_s",
            "bytes_exchanged",
        ];
        assert_eq!(keys, expected);
        assert_eq!(Cost::from(section), cost);
        let times: Vec<String> = cost.times().into_iter().map(|(name, _)| name).collect();
        assert_eq!(times[..5], ["wall", "plan", "start", "mech", "thermal"]);
    }

    #[test]
    fn a_role_replaces_no_measurement() {
        let named = |role: &str| ParticipantCost {
            role: role.to_owned(),
            model_s: 9.0,
            ..Default::default()
        };
        let participants = vec![named("wall"), named("coupling")];
        let section =
            Map::from(Cost { wall_s: 2.0, coupling_s: 1.0, participants, ..Cost::default() });
        assert_eq!((&section["wall_s"], &section["coupling_s"]), (&2.0.into(), &1.0.into()));
    }
}
