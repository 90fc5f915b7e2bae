//! What a participant says of a case that it cannot take.

use serde::{Deserialize, Serialize};

/// A case that a participant cannot take: a value, or a combination of values, is at fault.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[error("{key}: {reason}; {fix}")]
pub struct Refusal {
    /// Dotted key of the case at fault.
    pub key: String,
    /// Why it cannot be.
    pub reason: String,
    /// What to write instead.
    pub fix: String,
}

impl Refusal {
    /// A refusal that names the key, the reason and the fix.
    pub fn new(key: &str, reason: impl Into<String>, fix: impl Into<String>) -> Self {
        Self { key: key.to_owned(), reason: reason.into(), fix: fix.into() }
    }
}
