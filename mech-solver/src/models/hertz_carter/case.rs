//! What is known before the model is built.

use super::contact::CreepLaw;
use crate::case::scene::GivenPatch;
use crate::terms::Terms;
use proto::grid::Structured;

/// A checked case.
pub(super) struct Case {
    /// The ellipse that the case gives, if it does.
    pub(super) given: Option<GivenPatch>,
    pub(super) law: CreepLaw,
    /// The terms of the active effects.
    pub(super) terms: Terms,
    pub(super) grid: Structured,
}
