//! Lists of models and effects: their entries, and which model supports which effect.

pub mod entry;
pub(crate) mod support;
