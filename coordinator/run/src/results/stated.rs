//! The section `accuracy` of the summary, which states the error of a result.

use serde::{Deserialize, Serialize};

/// Error of a result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stated {
    /// Key of the quantity.
    pub quantity: String,
    /// Requested relative error, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<f64>,
    /// Estimated relative error, the sum of grid and model error.
    pub estimated_error: f64,
    /// Relative error of the grid, including the factor of safety.
    pub grid_error: f64,
    /// Relative error of the models, as the models expect.
    pub model_error: f64,
    /// Whether the estimated error is within the target.
    pub met: bool,
    /// Source of the result: the finest run or the limit.
    pub taken: ResultSource,
    /// Value of the quantity, from the finest run or extrapolated.
    pub value: f64,
    /// Extrapolated value on an infinitely fine grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extrapolated: Option<f64>,
    /// Width of the slip zone on the coarsest grid \[element\], if it is too narrow to extrapolate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub narrow_slip_zone: Option<f64>,
    /// Extrapolated figures, if the limit is the result.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub figures: Vec<StatedFigure>,
    /// Chosen models.
    pub models: String,
    /// The runs, coarsest first.
    pub runs: Vec<StatedRun>,
}

/// Source of the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ResultSource {
    /// The finest run.
    Run,
    /// The limit extrapolated from the three finest grids.
    Extrapolated,
}

/// A figure extrapolated to an infinitely fine grid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StatedFigure {
    /// Key of the figure.
    pub key: String,
    /// Value of the figure.
    pub value: f64,
    /// Estimated relative grid error.
    pub grid_error: f64,
}

/// One run of the search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StatedRun {
    /// Keys that set the resolution, with their values.
    pub settings: Vec<(String, u32)>,
    /// Value of the quantity.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// Time of the run \[s\].
    pub wall_s: f64,
}
