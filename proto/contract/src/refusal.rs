//! Refusal of a case by a participant.

use serde::{Deserialize, Serialize};

/// Refusal of a case: a value, or a combination of values, is not supported.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[error("{key}: {reason}; {fix}")]
pub struct Refusal {
    /// Dotted key of the case at fault.
    pub key: String,
    /// Reason for the refusal.
    pub reason: String,
    /// Suggested correction.
    pub fix: String,
}

impl Refusal {
    /// Returns a refusal that names the key, the reason and the fix.
    pub fn new(key: &str, reason: impl Into<String>, fix: impl Into<String>) -> Self {
        Self { key: key.to_owned(), reason: reason.into(), fix: fix.into() }
    }
}
