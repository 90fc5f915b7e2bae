//! What is known before the model is built.

use super::contact::{Contact, CreepLaw};
use crate::case::scene::Scene;
use crate::terms::Terms;
use proto::field::FieldSpec;
use proto::grid::Structured;

/// A checked case.
pub(super) struct Case {
    pub(super) scene: Scene,
    pub(super) contact: Contact,
    pub(super) law: CreepLaw,
    /// The terms of the active effects.
    pub(super) terms: Terms,
    pub(super) grid: Structured,
    /// The fields that this run asks for.
    pub(super) wanted: Vec<&'static FieldSpec>,
}
