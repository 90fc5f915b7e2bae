//! The grids that models have in common, and which of them a run needs.

use proto::configuration::{Configuration, FieldOnGrid};
use proto::field::{self, FieldSpec};
use proto::grid::{Grid, Shape};

/// Name of the grid that covers the contact.
pub const CONTACT_GRID: &str = "contact";
/// Name of the grid of quantities that belong to a whole body: one element as large as the
/// contact's grid.
pub const RIGID_GRID: &str = "rigid";

/// The field belongs to a whole body or contact: it has one value for each component.
pub(super) fn is_rigid(spec: &FieldSpec) -> bool {
    *spec == field::SURFACE_SPEED || *spec == field::CONTACT_FORCE
}

/// The fields that a run asks for, each on the grid that `on` names, and those of the grids that have any.
pub(super) fn laid_out(
    configuration: &Configuration,
    on: impl Fn(&FieldSpec) -> &'static str,
    grids: Vec<(&'static str, impl Into<Shape>)>,
) -> (Vec<Grid>, Vec<FieldOnGrid>) {
    let wanted = |spec: &&FieldSpec| {
        configuration.outputs.iter().chain(&configuration.observed).any(|name| name == spec.name)
    };
    let fields: Vec<FieldOnGrid> = field::TABLE
        .iter()
        .filter(wanted)
        .map(|spec| FieldOnGrid { field: spec.name.to_owned(), grid: on(spec).to_owned() })
        .collect();
    let used = |name: &str| fields.iter().any(|on| on.grid == name);
    let grids = grids.into_iter().filter(|(name, _)| used(name));
    let grid = |(name, shape): (&str, _)| Grid { name: name.to_owned(), revision: 1, shape };
    (grids.map(|(name, shape)| grid((name, shape.into()))).collect(), fields)
}
