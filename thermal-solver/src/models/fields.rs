//! The fields of every model.

use proto::description::names;
use proto::field::{self, FieldSpec};

/// Surface temperature of each body, wheel and rail.
pub const SURFACES: [&FieldSpec; 2] = [&field::WHEEL_TEMPERATURE, &field::RAIL_TEMPERATURE];
/// Section temperature of each body, wheel and rail.
pub const SECTIONS: [&FieldSpec; 2] =
    [&field::WHEEL_SECTION_TEMPERATURE, &field::RAIL_SECTION_TEMPERATURE];

/// The fields that every model consumes and provides, by name.
pub(super) fn fields() -> (Vec<String>, Vec<String>) {
    let consumes = names(&[&field::FRICTION_POWER, &field::SURFACE_SPEED]);
    let provides = names(&[
        &field::RAIL_TEMPERATURE,
        &field::WHEEL_TEMPERATURE,
        &field::RAIL_SECTION_TEMPERATURE,
        &field::WHEEL_SECTION_TEMPERATURE,
    ]);
    (consumes, provides)
}
