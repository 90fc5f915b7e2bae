//! The participant under test.

use contract::description::Description;
use contract::field::{self, FieldKind};
use run::programs::Program;
use std::time::Duration;

/// The participant under test.
pub(super) struct Subject {
    /// The role that it plays.
    pub(super) role: String,
    /// The executable.
    pub(super) program: Program,
    /// What it said when it was asked first; empty if it did not.
    pub(super) description: Description,
    /// Longest wait for an answer.
    pub(super) patience: Duration,
}

impl Subject {
    /// The kind of a field that it speaks of: of the table, or one that it describes.
    pub(super) fn kind(&self, name: &str) -> Option<FieldKind> {
        kind(&self.description.fields, name)
    }
}

/// The kind of a field: of the table, or of those that a participant describes.
pub(super) fn kind(described: &[FieldKind], name: &str) -> Option<FieldKind> {
    let own = || described.iter().find(|kind| kind.name == name).cloned();
    field::find(name).map(field::FieldSpec::kind).or_else(own)
}
