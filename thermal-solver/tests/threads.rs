//! Results are bit-identical for any number of threads.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so does what it calls")]

mod support;

use proto::configuration::Mode;
use proto::grid::Structured;
use support::{Run, steel};

/// Returns the rises of both bodies and the work of every window.
fn answers(
    model: &str,
    threads: usize,
    mode: Mode,
    grid: Structured,
    windows: usize,
) -> Vec<Vec<u64>> {
    let mut run = Run::on(threads, model, mode, grid, steel());
    run.given.speeds = vec![0.9 * support::SPEED, support::SPEED];
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<u64>>();
    let mut all = Vec::new();
    for window in 0..windows {
        let flux: Vec<f64> =
            (0..grid.points()).map(|i| ((i * (window + 3)) % 17) as f64 * 1e7).collect();
        let report = run.advance(&flux, 3e-5);
        let heat = report.received_power.unwrap().to_bits();
        all.extend([bits(run.rail()), bits(run.wheel()), vec![report.work, heat]]);
    }
    all
}

#[test]
fn results_are_the_same_on_any_number_of_threads() {
    // Large enough for every sweep to run on several threads.
    let steady = Structured::contact_plane(-8e-3, -6e-3, 2e-5, 2e-5, 501, 403);
    let transient = Structured::contact_plane(-8e-3, -6e-3, 1e-4, 1e-4, 161, 121);
    for (mode, grid, windows) in [(Mode::Steady, steady, 1), (Mode::Transient, transient, 6)] {
        for model in ["columns", "moving-source", "fe"] {
            let one = answers(model, 1, mode, grid, windows);
            for threads in [2, 3, 8] {
                let several = answers(model, threads, mode, grid, windows);
                assert!(several == one, "{model}, {mode:?}, {threads} threads");
            }
        }
    }
}
