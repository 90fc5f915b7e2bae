//! What a run cost.

use proto::run_dir::processor_seconds;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::time::Instant;

/// When a run began, in time and in this process's own work.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    /// The instant.
    pub since: Instant,
    processor: f64,
}

impl Stopwatch {
    /// A run begins now.
    #[must_use]
    pub fn start() -> Self {
        Self { since: Instant::now(), processor: processor_seconds() }
    }
}

/// What a run cost.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spent {
    /// Seconds from its beginning to its end, planning and starting of processes included.
    pub wall_s: f64,
    /// Seconds in the models and in the coupling: what is left where processes are long started.
    pub solve_s: f64,
    /// Processor seconds of each process, the coordinator's among them.
    pub cpu_s: BTreeMap<String, f64>,
    /// Largest resident memory of each participant \[byte\].
    pub peak_rss_bytes: BTreeMap<String, u64>,
    /// Iterations of the coupling in all.
    pub iterations: u64,
}

impl Spent {
    /// What the run with this summary, begun then and ending now, has cost.
    #[must_use]
    pub fn of(summary: &Value, stopwatch: &Stopwatch) -> Self {
        let section = summary["cost"].as_object();
        let of_role = |ending: &'static str| {
            let entries = section.into_iter().flatten();
            entries.filter_map(move |(key, value)| {
                Some((key.strip_suffix(ending)?.to_owned(), value.as_f64()?))
            })
        };
        // Whatever has resident memory is a participant; other times are the coordinator's.
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
        let spent = Spent::of(&summary, &Stopwatch::start());
        assert_eq!((spent.solve_s, spent.iterations), (2.75, 3));
        assert_eq!(spent.cpu_s["mech"], 2.5);
        assert!(spent.cpu_s.contains_key("coordinator") && !spent.cpu_s.contains_key("thermal"));
        assert_eq!(spent.peak_rss_bytes.len(), 2);
        assert!(spent.wall_s < 9.0, "measured here");
    }
}
