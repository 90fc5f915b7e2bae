//! Typed access to the case values inside a [`crate::configuration::Configuration`].
//!
//! The coordinator has already checked types, units and ranges, and filled in the defaults. A
//! participant started by another coordinator still gets an error here, not a panic.

use crate::refusal::Refusal;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Case values in SI units, addressed by dotted keys.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Params(pub Value);

impl Params {
    /// Returns the value or table at a dotted key.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Value> {
        key.split('.').try_fold(&self.0, |value, part| value.get(part))
    }

    /// Returns true if the key is present.
    #[must_use]
    pub fn has(&self, key: &str) -> bool {
        self.get(key).is_some()
    }

    /// Returns a required number [SI].
    pub fn number(&self, key: &str) -> Result<f64, Refusal> {
        self.maybe_number(key)?.ok_or_else(|| missing(key))
    }

    /// Returns an optional number [SI].
    pub fn maybe_number(&self, key: &str) -> Result<Option<f64>, Refusal> {
        match self.get(key) {
            None => Ok(None),
            Some(value) => match value.as_f64() {
                Some(number) if number.is_finite() => Ok(Some(number)),
                _ => Err(wrong(key, value, "a finite number")),
            },
        }
    }

    /// Returns a required whole number.
    pub fn integer(&self, key: &str) -> Result<i64, Refusal> {
        let value = self.get(key).ok_or_else(|| missing(key))?;
        value.as_i64().ok_or_else(|| wrong(key, value, "a whole number"))
    }

    /// Returns a required text or word.
    pub fn text(&self, key: &str) -> Result<&str, Refusal> {
        let value = self.get(key).ok_or_else(|| missing(key))?;
        value.as_str().ok_or_else(|| wrong(key, value, "a text"))
    }
}

fn missing(key: &str) -> Refusal {
    Refusal::new(key, "missing", format!("add `{key}`"))
}

fn wrong(key: &str, value: &Value, expected: &str) -> Refusal {
    Refusal::new(key, format!("{value} is not {expected}"), format!("write {expected}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dotted_access_and_errors() {
        let params = Params(serde_json::json!({"load": {"normal_force": 134e3}, "case": {"n": 3}}));
        assert_eq!(params.number("load.normal_force"), Ok(134e3));
        assert_eq!(params.integer("case.n"), Ok(3));
        assert_eq!(params.maybe_number("load.other"), Ok(None));
        assert!(params.number("load").unwrap_err().to_string().contains("not a finite number"));
        assert_eq!(params.number("nope.x").unwrap_err().key, "nope.x");
    }
}
