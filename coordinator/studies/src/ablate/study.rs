//! What the study has found: `ablate.json`.

use crate::study::output::Kept;
use crate::study::quantity::Quantity;
use crate::study::spent::{Spent, Stopwatch};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// A study, as `ablate.json` has it.
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
    /// The quantities of interest that the runs have.
    pub quantities: Vec<Quantity>,
    /// The case as it is.
    pub whole: Run,
    /// The case without each of its effects.
    pub without: Vec<Run>,
    /// The case with each effect that it does not have, and that is advised.
    #[serde(default)]
    pub with: Vec<Run>,
    /// What was advised before anything ran, and whether the runs agree.
    #[serde(default)]
    pub advice: Vec<Judged>,
}

/// Advice beside what the runs have found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Judged {
    /// The effect.
    pub effect: String,
    /// Key of the figure that it was to move most; empty where the scene was to have no answer with it.
    pub figure: String,
    /// By how much, of its value without the effect; absent where there is none without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub advised: Option<f64>,
    /// By how much it did; absent where one of the runs does not have the figure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured: Option<f64>,
    /// In sign, and in size to a factor of three; or both below what matters.
    pub agrees: bool,
}

impl Kept for Study {
    const COMMAND: &'static str = "ablate";
    const FILE: &'static str = "ablate.json";
    const SCHEMA: u32 = 3;
}

/// One run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Run {
    /// The effect that is off; empty for the case as it is.
    pub effect: String,
    /// Why it has no quantities.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
    /// Its quantities by key.
    pub values: BTreeMap<String, f64>,
    /// Its quantities' change against the case as it is, by key: relative, or the difference for a
    /// place or a share; absent for a quantity that one of the two does not have.
    pub changes: BTreeMap<String, f64>,
    /// What it cost.
    pub cost: Spent,
}

impl Run {
    /// Takes these quantities of a run, and its cost if it is the least so far.
    pub(super) fn take(&mut self, summary: &Value, of: &[Quantity], stopwatch: &Stopwatch) {
        let cost = Spent::of(summary, stopwatch);
        if self.values.is_empty() || cost.solve_s < self.cost.solve_s {
            self.cost = cost;
        }
        let value = |one: &Quantity| Some((one.key.clone(), one.value(summary)?));
        self.values = of.iter().filter_map(value).collect();
    }

    /// Takes the changes of its figures against those of the case as it is.
    pub(super) fn compare(&mut self, whole: &Self, quantities: &[Quantity]) {
        let change = |quantity: &Quantity| {
            let key = &quantity.key;
            let (value, with) = (*self.values.get(key)?, *whole.values.get(key)?);
            Some((key.clone(), quantity.change(with, value)?))
        };
        self.changes = quantities.iter().filter_map(change).collect();
    }
}
