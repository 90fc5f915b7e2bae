//! Request and results of the study: `cost.json`.

use crate::study::axis::Axis;
use crate::study::output::StudyFile;
use crate::study::quantity::{Quantity, show_error};
use crate::study::spent::RunCost;
use console::case_arguments::Changes;
use contract::accuracy::Simplification;
use contract::figure::Measure;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Request for a study.
#[derive(Clone, Debug)]
pub(super) struct Request {
    /// The case file.
    pub case: PathBuf,
    /// Changes common to all runs.
    pub base: Changes,
    /// Axes that replace the default plan. `ROLE.model` selects models, the key of a refinement its
    /// levels; any other key becomes an additional axis.
    pub vary: Vec<Axis>,
    /// Key of the quantity that ranks the runs; `None` for the first quantity of interest.
    pub quantity: Option<String>,
    /// References given by the user: key of the summary and value.
    pub references: Vec<(String, f64)>,
    /// Repetitions of each run; the shortest times count.
    pub repeat: u32,
    /// Runs with a longer expected solver time are skipped \[s\].
    pub longest_run: f64,
}

impl Request {
    /// Everything besides the case that determines the list of runs. The ranking quantity and the
    /// references have no influence.
    #[must_use]
    pub(super) fn decides_runs(&self) -> Value {
        let vary: Vec<_> = self.vary.iter().map(|axis| (&axis.key, &axis.values)).collect();
        json!([vary, self.repeat, self.longest_run])
    }
}

/// Contents of `cost.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Study {
    /// Version of the file's layout.
    pub schema: u32,
    /// Name of the case.
    pub case: String,
    /// Title of the case.
    pub title: Option<String>,
    /// The case file.
    pub file: String,
    /// Options common to all runs.
    pub options: Vec<String>,
    /// Compared quantities; the first one ranks the runs.
    pub quantities: Vec<Compared>,
    /// Combinations of models.
    pub levels: Vec<LevelSummary>,
    /// Combinations of models that cannot run the case, with the reason.
    pub refused: Vec<(String, String)>,
    /// Skipped runs, with the reason.
    pub left_out: Vec<(String, String)>,
    /// Most faithful models, if all of their runs were skipped or failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub more_faithful: Option<String>,
    /// Runs, level by level, coarsest first.
    pub runs: Vec<Run>,
    /// Recommended run for each target.
    pub picks: Vec<Recommendation>,
}

impl StudyFile for Study {
    const COMMAND: &'static str = "cost";
    const FILE: &'static str = "cost.json";
    const SCHEMA: u32 = 1;
}

impl Study {
    /// States that the most faithful models have no run, and what follows.
    #[must_use]
    pub(crate) fn missing_models(&self) -> Option<String> {
        let name = self.more_faithful.as_ref()?;
        let without = self.quantities.first().is_some_and(|one| one.reference.is_none());
        let what = if without { ", so that there is no reference" } else { "" };
        Some(format!(
            "{name}, the most faithful models, have no run{what}; raise --longest-run, or name the \
             value with --reference"
        ))
    }
}

/// A compared quantity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Compared {
    /// Key in the summary.
    pub key: String,
    /// Short name.
    pub name: String,
    /// Measure of the error.
    pub measure: Measure,
    /// Reference of the values; absent for a quantity that is an error itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<Reference>,
}

impl Compared {
    /// The quantity without its reference.
    #[must_use]
    pub(crate) fn quantity(&self) -> Quantity {
        let Self { key, name, measure, .. } = self.clone();
        Quantity::new(&key, &name, measure)
    }

    /// Formats an error of the quantity.
    #[must_use]
    pub(super) fn show_error(&self, error: f64) -> String {
        show_error(self.measure, error)
    }
}

/// Reference value of a quantity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Reference {
    /// Value in the unit of the key.
    pub value: f64,
    /// Uncertainty of the reference, in the measure of the quantity's errors: from its grids and
    /// from the simplifications of its models. 0 for exact or given values; absent if a single grid
    /// allows no estimate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<f64>,
    /// Source of the value.
    pub source: String,
}

/// A combination of models, and the results of its runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct LevelSummary {
    /// Names of the models.
    pub name: String,
    /// Simplifications of the models that matter in this case.
    pub left_out: Vec<Simplification>,
    /// Results for each quantity, by key.
    pub shows: BTreeMap<String, LevelEstimate>,
    /// Resolution from which further refinement does not pay, as part of a sentence, if there is
    /// one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stops_paying: Option<String>,
}

/// Results of a level for one quantity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct LevelEstimate {
    /// Order of convergence, if three resolutions show one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<f64>,
    /// Value extrapolated to an infinitely fine resolution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// Difference between limit and reference: the error of the models.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model_error: Option<f64>,
}

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Run {
    /// Index of the level.
    pub level: usize,
    /// Index of the resolution among those of the level, coarsest first.
    pub step: usize,
    /// Settings that distinguish the run from others of its level: keys and values.
    pub settings: Vec<(String, String)>,
    /// All options that reproduce the run with `coordinator run`.
    pub options: Vec<String>,
    /// Reason why the run has no quantities.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
    /// Cost of the run.
    pub cost: RunCost,
    /// Values of the quantities by key.
    pub values: BTreeMap<String, f64>,
    /// Errors of the quantities by key.
    pub errors: BTreeMap<String, f64>,
    /// Whether no other run is both cheaper and more accurate.
    pub pareto: bool,
}

/// Cheapest run that meets a target, as do all finer runs with the same models and settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Recommendation {
    /// Largest error of the first quantity, in its measure.
    pub target: f64,
    /// Index of the run; absent if no run meets the target.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub run: Option<usize>,
}

impl Run {
    /// Settings that distinguish the run from others of its level.
    #[must_use]
    pub(crate) fn settings_text(&self) -> String {
        let all: Vec<String> =
            self.settings.iter().map(|(key, value)| format!("{key} {value}")).collect();
        all.join(", ")
    }
}
