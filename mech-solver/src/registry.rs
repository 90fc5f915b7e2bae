//! Lists of models and effects: their entries, and the support of effects by models.

pub mod entry;
pub(crate) mod support;
