//! Results of runs and limits, by name and key.

use super::measurement::Comparison;
use super::perform::Outcome;
use super::study::{Limit, Study};
use crate::study::richardson::{Estimate, Sample};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// All results of a study.
#[derive(Clone, Debug)]
pub(super) struct Values {
    names: BTreeSet<String>,
    limits: Vec<Limit>,
    /// Fineness of the families.
    fineness: BTreeMap<String, f64>,
    /// Results by the name of the run; `None` in a rehearsal.
    outcomes: Option<BTreeMap<String, Outcome>>,
    /// Measured and computed values by the name of the measurement.
    comparisons: BTreeMap<String, Comparison>,
}

impl Values {
    /// Builds the results from finished runs; `None` gives placeholder values for a rehearsal.
    #[must_use]
    pub(super) fn new(study: &Study, outcomes: Option<BTreeMap<String, Outcome>>) -> Self {
        let fine = study.families.iter().filter_map(|f| Some((f.name.clone(), f.fineness?)));
        Self {
            names: study.names(),
            limits: study.limits.clone(),
            fineness: fine.collect(),
            outcomes,
            comparisons: BTreeMap::new(),
        }
    }

    /// Compares the measurements of the study, with their tables in `folder`, with their runs.
    ///
    /// # Errors
    /// A table cannot be read, or a run does not fit its table.
    pub(super) fn with_measurements(
        mut self,
        study: &Study,
        folder: &Path,
    ) -> Result<Self, String> {
        let outcomes = self.outcomes.iter().flatten().collect::<BTreeMap<_, _>>();
        let history = |name: &str| outcomes.get(&name.to_owned()).map(|of| &of.history);
        for measurement in &study.measurements {
            let comparison = measurement.compare(folder, history);
            let comparison =
                comparison.map_err(|why| format!("measurement `{}`: {why}", measurement.name))?;
            self.comparisons.insert(measurement.name.clone(), comparison);
        }
        Ok(self)
    }

    /// Looks up the values of a measurement.
    ///
    /// # Errors
    /// There is no measurement of this name.
    pub(super) fn comparison(&self, name: &str) -> Result<&Comparison, String> {
        self.comparisons.get(name).ok_or_else(|| {
            let known: Vec<&str> = self.comparisons.keys().map(String::as_str).collect();
            format!("there is no measurement `{name}`; known: {}", known.join(", "))
        })
    }

    /// Looks up a quantity of a run, limit or measurement; `None` if it does not exist.
    #[must_use]
    pub(super) fn find(&self, name: &str, key: &str) -> Option<f64> {
        if !self.names.contains(name) {
            return None;
        }
        let Some(outcomes) = &self.outcomes else { return Some(stand_in(name, key)) };
        match (outcomes.get(name), self.comparisons.get(name)) {
            (Some(outcome), _) => outcome.summary.value(key),
            (None, Some(comparison)) => comparison.quantity(key),
            (None, None) => self.extrapolated(name, key),
        }
    }

    /// Looks up a quantity that must exist.
    ///
    /// # Errors
    /// The run or the quantity does not exist.
    pub(super) fn get(&self, name: &str, key: &str) -> Result<f64, String> {
        self.known(name)?;
        self.find(name, key).ok_or_else(|| format!("the run `{name}` has no quantity `{key}`"))
    }

    /// Looks up a number in the case of a run \[SI\].
    ///
    /// # Errors
    /// The run does not exist, or its case has no plain number under the key.
    pub(super) fn input(&self, name: &str, key: &str) -> Result<f64, String> {
        self.known(name)?;
        let Some(outcomes) = &self.outcomes else { return Ok(stand_in(name, key)) };
        let case = outcomes.get(name).map(|outcome| &outcome.case);
        let mut parts = key.split('.');
        let first = parts.next().and_then(|part| case?.get(part));
        let value = parts.fold(first, |value, part| value?.get(part));
        let number = value.and_then(|v| v.as_float().or_else(|| v.as_integer().map(|n| n as f64)));
        number.ok_or_else(|| format!("the case of `{name}` has no number `{key}`"))
    }

    fn known(&self, name: &str) -> Result<(), String> {
        match self.names.contains(name) {
            true => Ok(()),
            false => {
                let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
                Err(format!("there is no run `{name}`; known: {}", names.join(", ")))
            }
        }
    }

    /// Extrapolates a quantity of `LIMIT` or `LIMIT/VALUE` from the two finest families of the
    /// limit.
    fn extrapolated(&self, name: &str, key: &str) -> Option<f64> {
        let (family, value) = name.split_once('/').map_or((name, None), |(f, v)| (f, Some(v)));
        let limit = self.limits.iter().find(|limit| limit.name == family)?;
        let sample = |family: &String| {
            let run = value.map_or_else(|| family.clone(), |value| format!("{family}/{value}"));
            let level = *self.fineness.get(family)?;
            Some(Sample { level, value: self.find(&run, key)?, slip_zone: None })
        };
        let samples: Vec<Sample> = limit.of.iter().filter_map(sample).collect();
        let finest = samples.last_chunk::<2>()?;
        Estimate::of(finest, limit.order).map(|estimate| estimate.limit)
    }
}

/// Placeholder from 1 to 2 for a quantity in a rehearsal. Every quantity gets another number, so
/// that a template may divide by differences.
fn stand_in(name: &str, key: &str) -> f64 {
    let mix = |sum: u32, byte: u8| sum.wrapping_mul(31).wrapping_add(u32::from(byte));
    1.0 + f64::from(name.bytes().chain(key.bytes()).fold(0, mix)) / f64::from(u32::MAX)
}
