//! What is hardly so.

use super::super::page::{Block, Section};
use super::super::source::Results;
use run::warnings::of_summary;

/// Values and figures beyond what is expected, one after the other; nothing where there are none.
pub(super) fn section(results: &Results) -> Option<Section> {
    let warnings = of_summary(&results.summary);
    let blocks = warnings.iter().map(|warning| Block::Text(warning.to_string())).collect();
    Section::of("Warnings", blocks)
}
