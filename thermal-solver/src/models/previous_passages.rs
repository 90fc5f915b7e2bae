//! Temperature rises left by earlier passages, to which the flash temperature is added
//! ([`crate::effects::bulk_heating`]).

use super::frame::Frame;
use crate::effects::bulk_heating::PassageHistory;
use heat::window::Drive;
use proto::model::StepError;
use proto::readable::quantity;
use std::f64::consts::PI;

/// Distance, in units of √(2κt), beyond which lateral spread is negligible.
const SPREAD: f64 = 8.0;

/// Temperature rises of the bodies before a passage.
#[derive(Clone, Debug)]
pub(super) struct Background {
    memories: [PassageHistory; 2],
    /// Rise of the whole body [K].
    bulk: [f64; 2],
    /// Rise left by earlier passages, row by row [K].
    residual: [Vec<f64>; 2],
}

impl Background {
    /// Creates the state before the first passage.
    pub(super) fn new(memories: [PassageHistory; 2], rows: usize) -> Self {
        Self { memories, bulk: [0.0; 2], residual: [vec![0.0; rows], vec![0.0; rows]] }
    }

    /// Computes the rises for passages with the given flux at the interface [W/m²] and power into
    /// each body [W].
    ///
    /// # Errors
    /// A passage interval shorter than the passage itself.
    pub(super) fn take(
        &mut self,
        frame: &Frame,
        drive: &Drive,
        flux: &[f64],
        power: [f64; 2],
    ) -> Result<(), StepError> {
        let grid = &frame.grid;
        for (body, power) in power.into_iter().enumerate() {
            let PassageHistory { loss, passages, interval } = self.memories[body];
            self.bulk[body] = loss.map_or(0.0, |loss| power / loss);
            let passing = grid.ni as f64 * grid.dx() / drive.speeds[body];
            if passages > 0 && interval <= passing {
                let name = frame.scene.names.key(body, "passage_interval");
                return Err(StepError::NoSolution(format!(
                    "`{name}` is {interval} s, and a place takes {passing} to pass the contact: write a longer interval",
                    passing = quantity(passing, "s", 4)
                )));
            }
            let per_area = drive.shares[body] * grid.dx() / drive.speeds[body];
            let left: Vec<f64> =
                flux.chunks_exact(grid.ni).map(|row| per_area * row.iter().sum::<f64>()).collect();
            self.residual[body].fill(0.0);
            for passage in 1..=passages {
                let time = passage as f64 * interval;
                self.add(frame, body, &left, time);
            }
        }
        Ok(())
    }

    /// Adds the rise that a heat per area [J/m²] leaves after some time [s].
    fn add(&mut self, frame: &Frame, body: usize, left: &[f64], time: f64) {
        let material = &frame.scene.materials[body];
        let width = frame.grid.dy();
        let spread = (2.0 * material.diffusivity() * time).sqrt();
        let depth = 1.0 / (material.effusivity() * (PI * time).sqrt());
        // Mean of the Gaussian over an element, from the error function at its edges.
        let reach = ((SPREAD * spread / width) as usize + 1).min(left.len());
        let edge = |rows: f64| 0.5 * libm::erf(rows * width / (spread * std::f64::consts::SQRT_2));
        let weights: Vec<f64> =
            (0..=reach).map(|k| edge(k as f64 + 0.5) - edge(k as f64 - 0.5)).collect();
        for (row, sum) in self.residual[body].iter_mut().enumerate() {
            let (first, last) = (row.saturating_sub(reach), (row + reach).min(left.len() - 1));
            let mean: f64 =
                (first..=last).map(|from| weights[from.abs_diff(row)] * left[from]).sum();
            *sum += depth * mean;
        }
    }

    /// Rise of a row before the passage [K].
    pub(super) fn at(&self, body: usize, row: usize) -> f64 {
        self.bulk[body] + self.residual[body][row]
    }

    /// Rise of the whole body, and the largest rise left by earlier passages [K].
    pub(super) fn figures(&self, body: usize) -> [f64; 2] {
        [self.bulk[body], self.residual[body].iter().copied().fold(0.0, f64::max)]
    }

    /// Iterates over all numbers of the state.
    pub(super) fn numbers(&self) -> impl Iterator<Item = &f64> {
        self.bulk.iter().chain(self.residual.iter().flatten())
    }

    /// Iterates over all numbers of the state, to restore them.
    pub(super) fn numbers_mut(&mut self) -> impl Iterator<Item = &mut f64> {
        self.bulk.iter_mut().chain(self.residual.iter_mut().flatten())
    }
}
