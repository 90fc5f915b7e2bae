//! What models expect of their errors.

use crate::case::resolution::RESOLUTION;
use proto::accuracy::Refinement;

/// Where the expected errors of the models were measured.
pub(super) const STUDY: &str = "`coordinator cost` of the cases wheel-rail and full-slip";

/// How the error of a model falls with the elements per semi-axis, from this error at ten on.
pub(super) fn refinement(order: f64, error: f64) -> Refinement {
    Refinement {
        key: RESOLUTION.to_owned(),
        levels: vec![10, 20, 40, 80, 160, 320],
        order,
        error,
        source: STUDY.to_owned(),
    }
}
