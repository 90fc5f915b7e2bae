//! Counts of the coupling, kept in checkpoints.

use crate::format::counted;
use crate::warnings::Warning;
use serde::{Deserialize, Serialize};

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
    /// the power it receives. A resumed run determines the bits again.
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
}
