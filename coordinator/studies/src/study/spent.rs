//! Cost of a run: time, memory and iterations.

use proto::run_dir::processor_seconds;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::time::Instant;

/// Start of a run in wall-clock time and in processor time of this process.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    /// Start of the run.
    pub since: Instant,
    processor: f64,
}

impl Stopwatch {
    /// Starts the stopwatch.
    #[must_use]
    pub fn start() -> Self {
        Self { since: Instant::now(), processor: processor_seconds() }
    }
}

/// Cost of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunCost {
    /// Wall-clock time from start to end, including planning and the start of processes \[s\].
    pub wall_s: f64,
    /// Time in the models and in the coupling \[s\]: the time of a run whose processes are already
    /// running.
    pub solve_s: f64,
    /// Processor time of each process, including the coordinator \[s\].
    pub cpu_s: BTreeMap<String, f64>,
    /// Largest resident memory of each participant \[byte\].
    pub peak_rss_bytes: BTreeMap<String, u64>,
    /// Total number of coupling iterations.
    pub iterations: u64,
}

impl RunCost {
    /// Cost of the run with this summary, from the start of the stopwatch until now.
    #[must_use]
    pub fn of(summary: &Value, stopwatch: &Stopwatch) -> Self {
        let section = summary["cost"].as_object();
        let of_role = |ending: &'static str| {
            let entries = section.into_iter().flatten();
            entries.filter_map(move |(key, value)| {
                Some((key.strip_suffix(ending)?.to_owned(), value.as_f64()?))
            })
        };
        // Every entry with resident memory is a participant; other times belong to the coordinator.
        let memory = of_role("_peak_rss_bytes").map(|(role, bytes)| (role, bytes as u64));
        let peak_rss_bytes: BTreeMap<String, u64> = memory.collect();
        let in_models =
            of_role("_s").filter(|(role, _)| peak_rss_bytes.contains_key(role)).map(|(_, s)| s);
        let coupling = summary["cost"]["coupling_s"].as_f64().unwrap_or(0.0);
        let mut cpu_s: BTreeMap<String, f64> = of_role("_cpu_s").collect();
        cpu_s.insert("coordinator".to_owned(), processor_seconds() - stopwatch.processor);
        Self {
            wall_s: stopwatch.since.elapsed().as_secs_f64(),
            solve_s: in_models.sum::<f64>() + coupling,
            cpu_s,
            peak_rss_bytes,
            iterations: summary["coupling"]["iterations"].as_u64().unwrap_or(0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn times_go_to_who_spent_them() {
        let summary = json!({
            "coupling": {"iterations": 3},
            "cost": {
                "wall_s": 9.0, "plan_s": 1.0, "mech_s": 2.0, "thermal_s": 0.5, "coupling_s": 0.25,
                "mech_cpu_s": 2.5, "mech_peak_rss_bytes": 1000, "thermal_peak_rss_bytes": 500,
                "bytes_exchanged": 64,
            },
        });
        let spent = RunCost::of(&summary, &Stopwatch::start());
        assert_eq!((spent.solve_s, spent.iterations), (2.75, 3));
        assert_eq!(spent.cpu_s["mech"], 2.5);
        assert!(spent.cpu_s.contains_key("coordinator") && !spent.cpu_s.contains_key("thermal"));
        assert_eq!(spent.peak_rss_bytes.len(), 2);
        assert!(spent.wall_s < 9.0, "measured here");
    }
}
