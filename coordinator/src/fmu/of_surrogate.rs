//! The FMU of a surrogate.

use super::pack::Entry;
use super::variables::Variables;
use super::whole::{self, Parts};
use contact_fmu::manifest::{Of, SURROGATE};
use run::error::RunError;
use std::path::PathBuf;
use surrogate::Document;

/// Writes it; what to print.
///
/// # Errors
/// The file system.
pub(super) fn make(document: &Document, path: Option<PathBuf>) -> Result<String, RunError> {
    let text = serde_json::to_string(document).expect("a surrogate is plain data");
    let entry = Entry {
        name: format!("resources/{SURROGATE}"),
        content: text.clone().into_bytes(),
        executable: false,
    };
    let parts = Parts {
        name: &document.origin.case,
        title: None,
        text: &text,
        of: Of::Surrogate,
        variables: &Variables::of_surrogate(document),
        entries: vec![entry],
    };
    whole::write(parts, path)
}
