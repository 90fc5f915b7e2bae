//! Values of the case that are given from outside as a run goes, and the limits that they keep to.
//!
//! A live value travels as a field of one component on a grid of one point, named like its dotted key. The
//! library of a participant gives what has come before each solve, so that a model reads it where it reads
//! the row of a table.

use crate::field::{Body, FieldKind, Mapping};
use crate::grid::{Grid, Structured};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Keys that are given from outside.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Live {
    /// Least and largest value of each key, in SI units.
    pub limits: BTreeMap<String, [f64; 2]>,
    /// The values that were given last; copies have them in common.
    #[serde(skip)]
    given: Arc<Mutex<BTreeMap<String, f64>>>,
}

impl PartialEq for Live {
    /// What is given as the run goes is no part of it.
    fn eq(&self, other: &Self) -> bool {
        self.limits == other.limits
    }
}

impl Live {
    /// More keys than this have too many corners to be laid out for.
    pub const MOST: usize = 8;

    /// Keys within these limits, of which nothing has been given yet.
    #[must_use]
    pub fn within(limits: BTreeMap<String, [f64; 2]>) -> Self {
        Self { limits, given: Arc::default() }
    }

    /// A value has come; every copy has it.
    pub fn give(&self, key: &str, value: f64) {
        let mut given = self.given.lock().unwrap_or_else(PoisonError::into_inner);
        match given.get_mut(key) {
            Some(place) => *place = value,
            None => {
                given.insert(key.to_owned(), value);
            }
        }
    }

    /// The value that was given last; `None` before the first.
    #[must_use]
    pub fn value(&self, key: &str) -> Option<f64> {
        self.given.lock().unwrap_or_else(PoisonError::into_inner).get(key).copied()
    }

    /// What is wrong with keys from outside, of histories of these ones.
    ///
    /// # Errors
    /// Other keys, too many, limits that are not finite and in order.
    pub(crate) fn check<'a>(
        &self,
        keys: impl Iterator<Item = &'a String> + Clone,
    ) -> Result<(), String> {
        if let Some(key) = keys.clone().find(|key| !self.limits.contains_key(*key)) {
            return Err(format!("`{key}` is among live values, and has no limits"));
        }
        if let Some(key) = self.limits.keys().find(|key| keys.clone().all(|known| known != *key)) {
            return Err(format!("the live value `{key}` has no first value"));
        }
        if self.limits.len() > Self::MOST {
            return Err(format!("{} live values, at most {}", self.limits.len(), Self::MOST));
        }
        for (key, [least, most]) in &self.limits {
            if !(least.is_finite() && most.is_finite() && least <= most) {
                return Err(format!("the limits of `{key}` are {least} and {most}"));
            }
        }
        Ok(())
    }

    /// The field as which the value of a key travels; `unit` is its SI unit.
    #[must_use]
    pub fn field(key: &str, unit: &str, meaning: &str) -> FieldKind {
        FieldKind {
            name: key.to_owned(),
            unit: unit.to_owned(),
            components: 1,
            mapping: Mapping::Consistent,
            body: Body::Interface,
            meaning: meaning.to_owned(),
        }
    }

    /// The grid on which the coordinator sends it: one point.
    #[must_use]
    pub fn grid() -> Grid {
        Grid::structured("live", Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 1, 1))
    }
}
