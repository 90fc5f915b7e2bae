//! What the study is asked, and what it has found: `cost.json`.

use crate::study::Variant;
use crate::study::axis::Axis;
use crate::study::output::Kept;
use crate::study::quantity::{Quantity, show_error};
use crate::study::spent::Spent;
use contract::accuracy::Simplification;
use contract::figure::Measure;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// What is to be studied.
#[derive(Clone, Debug)]
pub(super) struct Request {
    /// The case file.
    pub case: PathBuf,
    /// What is changed in it for all runs.
    pub base: Variant,
    /// What is varied in place of the default plan: a `ROLE.model` chooses among the models, the key
    /// of a refinement its levels, any other key is varied besides.
    pub vary: Vec<Axis>,
    /// The quantity by which runs are ranked, a key of the summary; `None` for the first of
    /// interest.
    pub quantity: Option<String>,
    /// References given by hand: key of the summary and value.
    pub references: Vec<(String, f64)>,
    /// How often each run is made; its times are the least.
    pub repeat: u32,
    /// No run is begun that is expected to take longer than this in its solvers \[s\].
    pub longest_run: f64,
}

/// A study, as `cost.json` has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Study {
    /// Version of this layout.
    pub schema: u32,
    /// Name of the case.
    pub case: String,
    /// What the case is about.
    pub title: Option<String>,
    /// The case file.
    pub file: String,
    /// Options that were given for all runs.
    pub options: Vec<String>,
    /// The quantities that are compared; the first one ranks the runs.
    pub quantities: Vec<Compared>,
    /// The choices of models.
    pub levels: Vec<LevelSeen>,
    /// Choices of models that cannot run the case: their names, and why.
    pub refused: Vec<(String, String)>,
    /// Runs that were left out: what they are, and why.
    pub left_out: Vec<(String, String)>,
    /// The runs, level by level, coarsest first.
    pub runs: Vec<Run>,
    /// What to run for an error.
    pub picks: Vec<Pick>,
}

impl Kept for Study {
    const COMMAND: &'static str = "cost";
    const FILE: &'static str = "cost.json";
    const SCHEMA: u32 = 1;
}

/// A quantity that is compared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Compared {
    /// Key of the summary.
    pub key: String,
    /// What it is, in few words.
    pub name: String,
    /// How its error is measured.
    pub measure: Measure,
    /// What its values are compared with; absent for what is an error itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<Reference>,
}

impl Compared {
    /// The quantity itself.
    #[must_use]
    pub(crate) fn quantity(&self) -> Quantity {
        let Self { key, name, measure, .. } = self.clone();
        Quantity::new(&key, &name, measure)
    }

    /// An error of it, as it is measured.
    #[must_use]
    pub(super) fn show_error(&self, error: f64) -> String {
        show_error(self.measure, error)
    }
}

/// What the values of a quantity are compared with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Reference {
    /// Its value, in the unit of the key.
    pub value: f64,
    /// How far off it may be itself, as errors are measured: its grids, and what its models leave out.
    /// 0 for what is exact or given; absent if one grid alone tells nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<f64>,
    /// Where it comes from.
    pub source: String,
}

/// A choice of models, and what its runs show.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct LevelSeen {
    /// Its models, in one word.
    pub name: String,
    /// What they leave out that matters in this case.
    pub left_out: Vec<Simplification>,
    /// What its runs show of each quantity, by key.
    pub shows: BTreeMap<String, Shows>,
    /// From which resolution on refining it does not pay, if there is one, in a sentence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stops_paying: Option<String>,
}

/// What the runs of a level show of one quantity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Shows {
    /// Order of convergence with the resolution, if three resolutions show one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<f64>,
    /// Its value at an infinitely fine resolution, as far as the runs tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// Error of that limit against the reference: the error of the models.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model_error: Option<f64>,
}

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Run {
    /// Index of its level.
    pub level: usize,
    /// Its resolution: the place among those of its level, coarsest first.
    pub step: usize,
    /// Keys that tell it from the other runs of its level, and their values.
    pub settings: Vec<(String, String)>,
    /// All options that make it with `coordinator run`.
    pub options: Vec<String>,
    /// Why it has no quantities.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
    /// What it cost.
    pub cost: Spent,
    /// Its quantities by key.
    pub values: BTreeMap<String, f64>,
    /// Their errors by key.
    pub errors: BTreeMap<String, f64>,
    /// No other run is as cheap and as accurate.
    pub pareto: bool,
}

/// The cheapest run that meets a target, and so do all finer ones of its models and settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Pick {
    /// Largest error of the first quantity, relative or absolute as it is measured.
    pub target: f64,
    /// Index of the run; absent if none meets the target.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub run: Option<usize>,
}

impl Run {
    /// What tells it from the other runs of its level.
    #[must_use]
    pub(crate) fn settings_text(&self) -> String {
        let all: Vec<String> =
            self.settings.iter().map(|(key, value)| format!("{key} {value}")).collect();
        all.join(", ")
    }
}
