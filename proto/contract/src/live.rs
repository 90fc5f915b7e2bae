//! Case values given from outside during a run, and their limits.
//!
//! A live value travels as a one-component field on a one-point grid, named by its dotted key. The
//! participant library stores the received values before each solve, so that a model reads them
//! like a row of a table.

use crate::field::{Body, FieldKind, Mapping};
use crate::grid::{Grid, Structured};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Keys given from outside.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Live {
    /// Smallest and largest value of each key, in SI units.
    pub limits: BTreeMap<String, [f64; 2]>,
    /// Latest values, shared by all clones.
    #[serde(skip)]
    given: Arc<Mutex<BTreeMap<String, f64>>>,
}

impl PartialEq for Live {
    /// Compares the limits; values given during a run are ignored.
    fn eq(&self, other: &Self) -> bool {
        self.limits == other.limits
    }
}

impl Live {
    /// Maximum number of keys; a model is laid out for all 2ⁿ corners of the box of limits.
    pub const MOST: usize = 8;

    /// Returns keys with these limits, without values yet.
    #[must_use]
    pub fn within(limits: BTreeMap<String, [f64; 2]>) -> Self {
        Self { limits, given: Arc::default() }
    }

    /// Stores a value for all clones.
    pub fn give(&self, key: &str, value: f64) {
        let mut given = self.given.lock().unwrap_or_else(PoisonError::into_inner);
        match given.get_mut(key) {
            Some(place) => *place = value,
            None => {
                given.insert(key.to_owned(), value);
            }
        }
    }

    /// Returns the latest value; `None` before the first.
    #[must_use]
    pub fn value(&self, key: &str) -> Option<f64> {
        self.given.lock().unwrap_or_else(PoisonError::into_inner).get(key).copied()
    }

    /// Checks limits received from another process against the keys of their histories.
    ///
    /// # Errors
    /// Fails if the keys differ, if there are too many, or if limits are not finite and ordered.
    pub(crate) fn check<'a>(
        &self,
        keys: impl Iterator<Item = &'a String> + Clone,
    ) -> Result<(), String> {
        if let Some(key) = keys.clone().find(|key| !self.limits.contains_key(*key)) {
            return Err(format!("the live value `{key}` has no limits"));
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

    /// Returns the field that carries the value of a key; `unit` is its SI unit.
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

    /// Returns the one-point grid on which the coordinator sends a live value.
    #[must_use]
    pub fn grid() -> Grid {
        Grid::structured("live", Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 1, 1))
    }
}
