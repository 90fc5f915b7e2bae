//! What is stated of the error of an answer: the section `accuracy` of the summary.

use serde::Serialize;

/// The error of an answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Stated {
    /// Key of the quantity.
    pub quantity: String,
    /// Largest relative error that was asked for, if one was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<f64>,
    /// Estimated relative error: that of the grid and that of the models.
    pub estimated_error: f64,
    /// Of which the grids, with a factor of safety.
    pub grid_error: f64,
    /// Of which the models, as they expect of themselves.
    pub model_error: f64,
    /// The estimated error is within the target.
    pub met: bool,
    /// What the errors are those of.
    pub taken: Taken,
    /// The quantity: of the finest run, or extrapolated.
    pub value: f64,
    /// The quantity on an infinitely fine grid, as far as the grids tell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extrapolated: Option<f64>,
    /// The figures on an infinitely fine grid, where that is what is taken.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub figures: Vec<StatedFigure>,
    /// The models that were chosen.
    pub models: String,
    /// The runs, coarsest first.
    pub runs: Vec<StatedRun>,
}

/// What is taken as the answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Taken {
    /// The finest run.
    Run,
    /// What the three finest grids are extrapolated to.
    Extrapolated,
}

/// A figure on an infinitely fine grid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct StatedFigure {
    /// Its key.
    pub key: String,
    /// The figure.
    pub value: f64,
    /// Estimated relative error of the grids.
    pub grid_error: f64,
}

/// One run on the way to the answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct StatedRun {
    /// What sets its resolution.
    pub settings: Vec<(String, u32)>,
    /// The quantity.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// Seconds that it took.
    pub wall_s: f64,
}
