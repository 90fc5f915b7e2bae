//! Expected discretisation errors of the models.

use crate::case::resolution::RESOLUTION;
use proto::accuracy::Refinement;

/// Source of the expected errors of the models.
pub(super) const STUDY: &str = "`coordinator cost` of the cases wheel-rail and full-slip";

/// Convergence of a model with the elements per semi-axis: order, and error at ten elements.
pub(super) fn refinement(order: f64, error: f64) -> Refinement {
    Refinement {
        key: RESOLUTION.to_owned(),
        levels: vec![10, 20, 40, 80, 160, 320],
        order,
        error,
        source: STUDY.to_owned(),
    }
}
