//! The figures of runs and limits, by name and key.

use super::record::Outcome;
use super::study::{Limit, Study};
use crate::study::richardson::{Estimate, Sample};
use contract::figure::value;
use std::collections::{BTreeMap, BTreeSet};

/// The figures of a study.
#[derive(Clone, Debug)]
pub(super) struct Values {
    names: BTreeSet<String>,
    limits: Vec<Limit>,
    /// Fineness of families.
    fineness: BTreeMap<String, f64>,
    /// By the names of the runs; `None` before anything has run.
    outcomes: Option<BTreeMap<String, Outcome>>,
}

impl Values {
    /// The figures of runs; without runs, a rehearsal with stand-ins.
    #[must_use]
    pub(super) fn new(study: &Study, outcomes: Option<BTreeMap<String, Outcome>>) -> Self {
        let fine = study.families.iter().filter_map(|f| Some((f.name.clone(), f.fineness?)));
        Self {
            names: study.names(),
            limits: study.limits.clone(),
            fineness: fine.collect(),
            outcomes,
        }
    }

    /// A figure of a run or limit; `None` if it has none under this key, or there is no such run.
    #[must_use]
    pub(super) fn find(&self, name: &str, key: &str) -> Option<f64> {
        if !self.names.contains(name) {
            return None;
        }
        let Some(outcomes) = &self.outcomes else { return Some(stand_in(name, key)) };
        match outcomes.get(name) {
            Some(outcome) => value(&outcome.summary, key),
            None => self.extrapolated(name, key),
        }
    }

    /// The same.
    ///
    /// # Errors
    /// There is no such run, or it has no such figure.
    pub(super) fn get(&self, name: &str, key: &str) -> Result<f64, String> {
        self.known(name)?;
        self.find(name, key).ok_or_else(|| format!("the run `{name}` has no quantity `{key}`"))
    }

    /// A number of the case that a run was of \[SI\].
    ///
    /// # Errors
    /// There is no such run, or its case has no such key or no plain number there.
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
                Err(format!("there is no run `{name}`; there is {}", names.join(", ")))
            }
        }
    }

    /// The figure of `LIMIT` or `LIMIT/VALUE` from the two finest families of the limit.
    fn extrapolated(&self, name: &str, key: &str) -> Option<f64> {
        let (family, value) = name.split_once('/').map_or((name, None), |(f, v)| (f, Some(v)));
        let limit = self.limits.iter().find(|limit| limit.name == family)?;
        let sample = |family: &String| {
            let run = value.map_or_else(|| family.clone(), |value| format!("{family}/{value}"));
            let level = *self.fineness.get(family)?;
            Some(Sample { level, value: self.find(&run, key)? })
        };
        let samples: Vec<Sample> = limit.of.iter().filter_map(sample).collect();
        let finest = samples.last_chunk::<2>()?;
        Estimate::of(finest, limit.order).map(|estimate| estimate.limit)
    }
}

/// A number from 1 to 2 that stands for a figure before anything has run: another one for each, so
/// that a template may divide by differences.
fn stand_in(name: &str, key: &str) -> f64 {
    let mix = |sum: u32, byte: u8| sum.wrapping_mul(31).wrapping_add(u32::from(byte));
    1.0 + f64::from(name.bytes().chain(key.bytes()).fold(0, mix)) / f64::from(u32::MAX)
}
