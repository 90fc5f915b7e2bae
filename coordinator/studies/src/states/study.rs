//! What the study has found: `states.json`.

use crate::study::axis::Axis;
use crate::study::output::Kept;
use crate::study::quantity::Quantity;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A study, as `states.json` has it.
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
    /// What the runs started from.
    pub starts: Axis,
    /// The quantities in which states differ.
    pub quantities: Vec<Quantity>,
    /// The states, in the order of the first start that led to each.
    pub states: Vec<State>,
    /// Starts that led to none, and why.
    pub failed: Vec<(f64, String)>,
}

impl Kept for Study {
    const COMMAND: &'static str = "states";
    const FILE: &'static str = "states.json";
    const SCHEMA: u32 = 2;
}

/// A steady state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    /// The starts that led there [SI].
    pub starts: Vec<f64>,
    /// Gain of the loop; absent where no two iterations differed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loop_gain: Option<f64>,
    /// It lasts in time, as far as the gain tells.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stable: Option<bool>,
    /// Its quantities by key.
    pub values: BTreeMap<String, f64>,
}
