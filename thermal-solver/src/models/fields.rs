//! Fields that every model consumes and provides.

use proto::description::names;
use proto::field::{self, FieldSpec};

/// Surface temperature of each body, the upper and the lower body.
pub const SURFACES: [&FieldSpec; 2] = [&field::UPPER_TEMPERATURE, &field::LOWER_TEMPERATURE];
/// Section temperature of each body, the upper and the lower body.
pub const SECTIONS: [&FieldSpec; 2] =
    [&field::UPPER_SECTION_TEMPERATURE, &field::LOWER_SECTION_TEMPERATURE];
/// Integral of the rise over the depth of each body, the upper and the lower body.
pub const RISE_INTEGRALS: [&FieldSpec; 2] =
    [&field::UPPER_RISE_INTEGRAL, &field::LOWER_RISE_INTEGRAL];

/// Returns the names of the fields that every model consumes and provides.
pub(super) fn fields() -> (Vec<String>, Vec<String>) {
    let consumes = names(&[&field::FRICTION_POWER, &field::SURFACE_SPEED]);
    let provides = names(&[
        &field::LOWER_TEMPERATURE,
        &field::UPPER_TEMPERATURE,
        &field::LOWER_SECTION_TEMPERATURE,
        &field::UPPER_SECTION_TEMPERATURE,
    ]);
    (consumes, provides)
}
