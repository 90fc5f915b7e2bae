//! What the study has found: `states.json`.

use crate::study::Variant;
use crate::study::output::Kept;
use crate::study::quantity::Quantity;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Most runs.
const MOST: u32 = 1000;

/// What the runs start from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Starts {
    /// The key that varies.
    pub key: String,
    /// Its first value [SI].
    pub from: f64,
    /// Its last value [SI].
    pub to: f64,
    /// Number of runs.
    pub runs: u32,
}

impl Starts {
    /// Reads `KEY=FROM..TO/RUNS`.
    ///
    /// # Errors
    /// What is wrong, for a person.
    pub(super) fn read(text: &str) -> Result<Self, String> {
        let form = || format!("`{text}` is not of the form KEY=FROM..TO/RUNS, like KEY=0..300/7");
        let (key, range) = text.split_once('=').ok_or_else(form)?;
        let (ends, runs) = range.rsplit_once('/').ok_or_else(form)?;
        let (from, to) = ends.split_once("..").ok_or_else(form)?;
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|value| value.is_finite());
        let (Some(from), Some(to)) = (number(from), number(to)) else { return Err(form()) };
        let runs = runs.trim().parse().map_err(|_| form())?;
        if !(2..=MOST).contains(&runs) {
            return Err(format!("{runs} runs; write 2 to {MOST}"));
        }
        Ok(Self { key: key.trim().to_owned(), from, to, runs })
    }

    /// The values, one for each run.
    pub(super) fn values(&self) -> impl Iterator<Item = f64> + '_ {
        let step = (self.to - self.from) / f64::from(self.runs - 1);
        (0..self.runs).map(move |run| self.from + step * f64::from(run))
    }

    /// The case with one of them.
    pub(super) fn variant(&self, base: &Variant, value: f64) -> Variant {
        base.with(&self.key, value)
    }
}

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
    pub starts: Starts,
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
    const SCHEMA: u32 = 1;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_are_read() {
        let starts = Starts::read("bodies.one.start=-10..50/4").unwrap();
        assert_eq!(starts.values().collect::<Vec<_>>(), [-10.0, 10.0, 30.0, 50.0]);
        assert_eq!(starts.key, "bodies.one.start");
        for wrong in ["a", "a=1..2", "a=1/3", "a=x..2/3", "a=1..inf/3", "a=1..2/1", "a=1..2/2.5"] {
            assert!(Starts::read(wrong).is_err(), "{wrong}");
        }
    }
}
