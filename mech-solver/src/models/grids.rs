//! Grids shared by the models, and the selection of those that a run needs.

use crate::terms::Observation;
use proto::configuration::{Configuration, FieldOnGrid, Layout};
use proto::field::{self, FieldSpec};
use proto::grid::{Grid, Shape, Structured};

/// Name of the grid that covers the contact.
pub const CONTACT_GRID: &str = "contact";
/// Name of the grid of quantities that belong to a whole body: one element as large as the
/// contact's grid.
pub const RIGID_GRID: &str = "rigid";

/// Name of the grid of slip and friction power: the contact's grid, or this grid shifted upstream
/// by half an element.
const PASSAGE_GRID: &str = "passage";

/// Returns whether the field belongs to a whole body or contact: one value per component.
pub(super) fn is_rigid(spec: &FieldSpec) -> bool {
    *spec == field::SURFACE_SPEED || *spec == field::CONTACT_FORCE
}

/// Returns the layout of the fields requested by a run, each on the grid named by `on`, with the
/// grids in use. Surface temperatures are requested on the grid of the contact: the participant
/// that sends them may have any grid.
pub(super) fn laid_out(
    configuration: &Configuration,
    on: impl Fn(&FieldSpec) -> &'static str,
    grids: Vec<(&'static str, impl Into<Shape>)>,
) -> Layout {
    let wanted = |spec: &&FieldSpec| {
        configuration.outputs.iter().chain(&configuration.observed).any(|name| name == spec.name)
    };
    let fields: Vec<FieldOnGrid> = field::TABLE
        .iter()
        .filter(wanted)
        .map(|spec| FieldOnGrid { field: spec.name.to_owned(), grid: on(spec).to_owned() })
        .collect();
    let temperatures = [field::UPPER_TEMPERATURE, field::LOWER_TEMPERATURE];
    let received = configuration.inputs.iter().map(|input| &input.field.name);
    let inputs: Vec<FieldOnGrid> = received
        .filter(|name| temperatures.iter().any(|spec| spec.name == *name))
        .map(|name| FieldOnGrid { field: name.clone(), grid: CONTACT_GRID.to_owned() })
        .collect();
    let used = |name: &str| fields.iter().chain(&inputs).any(|on| on.grid == name);
    let grids = grids.into_iter().filter(|(name, _)| used(name));
    let grid = |(name, shape): (&str, _)| Grid { name: name.to_owned(), revision: 1, shape };
    let grids = grids.map(|(name, shape)| grid((name, shape.into()))).collect();
    Layout { grids, fields, inputs, ..Layout::default() }
}

/// Returns the layout of the fields of a contact on this grid. Slip and friction power are shifted
/// along x by `upstream`, rigid fields have one element, and observations name their own grids.
pub(super) fn fields_over(
    configuration: &Configuration,
    grid: Structured,
    upstream: f64,
    observations: &[Box<dyn Observation>],
) -> Layout {
    let on = |spec: &FieldSpec| match *spec {
        _ if let Some(grid) = observations.iter().find_map(|term| term.grid_of(spec)) => grid,
        _ if is_rigid(spec) => RIGID_GRID,
        field::SLIP_VELOCITY | field::FRICTION_POWER => PASSAGE_GRID,
        _ => CONTACT_GRID,
    };
    let mut passage = grid;
    passage.origin[0] += upstream;
    let mut grids = vec![
        (CONTACT_GRID, grid.into()),
        (PASSAGE_GRID, passage.into()),
        (RIGID_GRID, whole(&grid).into()),
    ];
    grids.extend(observations.iter().flat_map(|term| term.grids()));
    laid_out(configuration, on, grids)
}

/// One element as large as a grid.
pub(super) fn whole(grid: &Structured) -> Structured {
    let (length, width) = (grid.dx() * grid.ni as f64, grid.dy() * grid.nj as f64);
    Structured::contact_plane(0.0, 0.0, length, width, 1, 1)
}
