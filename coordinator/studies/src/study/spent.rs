//! Cost of a run: time, memory and iterations.

use proto::run_dir::processor_seconds;
use run::results::summary::Summary;
use serde::{Deserialize, Serialize};
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
    pub fn of(summary: &Summary, stopwatch: &Stopwatch) -> Self {
        let Summary { cost, coupling, .. } = summary;
        let of_roles = || cost.participants.iter();
        let cpu_s = of_roles().filter_map(|one| Some((one.role.clone(), one.cpu_s?)));
        let own = ("coordinator".to_owned(), processor_seconds() - stopwatch.processor);
        let memory = of_roles().filter_map(|one| Some((one.role.clone(), one.peak_rss_bytes?)));
        Self {
            wall_s: stopwatch.since.elapsed().as_secs_f64(),
            solve_s: of_roles().map(|one| one.model_s).sum::<f64>() + cost.coupling_s,
            cpu_s: cpu_s.chain([own]).collect(),
            peak_rss_bytes: memory.collect(),
            iterations: coupling.iterations,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use run::results::cost::{Cost, ParticipantCost};

    #[test]
    fn times_go_to_who_spent_them() {
        let participant = |role: &str, model_s, cpu_s, bytes| ParticipantCost {
            role: role.to_owned(),
            model_s,
            cpu_s,
            peak_rss_bytes: Some(bytes),
        };
        let participants =
            vec![participant("mech", 2.0, Some(2.5), 1000), participant("thermal", 0.5, None, 500)];
        let cost =
            Cost { wall_s: 9.0, plan_s: 1.0, coupling_s: 0.25, participants, ..Cost::default() };
        let mut summary = Summary { cost, ..Summary::default() };
        summary.coupling.iterations = 3;
        let spent = RunCost::of(&summary, &Stopwatch::start());
        assert_eq!((spent.solve_s, spent.iterations), (2.75, 3));
        assert_eq!(spent.cpu_s["mech"], 2.5);
        assert!(spent.cpu_s.contains_key("coordinator") && !spent.cpu_s.contains_key("thermal"));
        assert_eq!(spent.peak_rss_bytes.len(), 2);
        assert!(spent.wall_s < 9.0, "measured here");
    }
}
