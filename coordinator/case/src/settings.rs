//! Checked values, read by dotted key.

use contract::bodies::Bodies;
use contract::params::Params;
use serde_json::Value as Json;

/// The coordinator's own settings, from values that have been checked and have their defaults.
pub(super) struct Settings<'a>(pub(super) &'a Params);

impl Settings<'_> {
    pub(super) fn number(&self, key: &str) -> Option<f64> {
        self.0.get(key).and_then(Json::as_f64)
    }

    /// The contract's name of a field that is written as a person reads it.
    pub(super) fn field_name(&self, written: &str) -> String {
        Bodies::read(self.0).map_or_else(|_| written.to_owned(), |bodies| bodies.named(written))
    }

    pub(super) fn text(&self, key: &str) -> Option<String> {
        self.0.get(key).and_then(Json::as_str).map(str::to_owned)
    }
}
