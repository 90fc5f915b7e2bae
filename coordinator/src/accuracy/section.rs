//! What is stated of the error of an answer: the section `accuracy` of the summary.

use super::{Search, Trial};
use serde::Serialize;

/// The error of an answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stated {
    /// Key of the quantity.
    pub quantity: String,
    /// Largest relative error that was asked for.
    pub target: f64,
    /// Estimated relative error: that of the grid and that of the models.
    pub estimated_error: f64,
    /// Of which the grid, with a factor of safety.
    pub grid_error: f64,
    /// Of which the models, as they expect of themselves.
    pub model_error: f64,
    /// The estimated error is within the target.
    pub met: bool,
    /// The quantity.
    pub value: f64,
    /// The quantity on an infinitely fine grid, as far as the grids tell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extrapolated: Option<f64>,
    /// The models that were chosen.
    pub models: String,
    /// The runs, coarsest first.
    pub runs: Vec<StatedRun>,
}

/// One run on the way to the answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StatedRun {
    /// What sets its resolution.
    pub settings: Vec<(String, u32)>,
    /// The quantity.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// Seconds that it took.
    pub wall_s: f64,
}

impl Search {
    /// What the runs so far say of the last one's error.
    pub(super) fn stated(&self) -> Stated {
        let value = self.trials.last().and_then(|trial| trial.values[0]).unwrap_or(f64::NAN);
        let estimate = self.estimate(0);
        // Models without a resolution have no error of a grid.
        let grid_error = self.grid_error().unwrap_or(0.0);
        let model_error = self.level.model_error();
        let estimated_error = grid_error + model_error;
        let run = |trial: &Trial| StatedRun {
            settings: self.level.keys_at(trial.step).map(|(r, n)| (r.key.clone(), n)).collect(),
            value: trial.values[0],
            wall_s: trial.wall_s,
        };
        Stated {
            quantity: self.quantities[0].key.clone(),
            target: self.target.relative,
            estimated_error,
            grid_error,
            model_error,
            met: estimated_error <= self.target.relative,
            value,
            extrapolated: estimate.map(|estimate| estimate.limit),
            models: self.level.name(),
            runs: self.trials.iter().map(run).collect(),
        }
    }
}
