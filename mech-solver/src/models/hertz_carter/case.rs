//! A case before the model is built.

use super::contact::CreepLaw;
use crate::case::scene::GivenPatch;
use crate::terms::Terms;
use proto::grid::Structured;

/// A checked case.
pub(super) struct Case {
    /// Ellipse given by the case, if any.
    pub(super) given: Option<GivenPatch>,
    pub(super) law: CreepLaw,
    /// Terms of the active effects.
    pub(super) terms: Terms,
    pub(super) grid: Structured,
}
