//! Grids of the fields of an FMU, and the numbers of values of its variables.
//!
//! An array of an FMU has no coordinates. An input array corresponds to the elements of the grid of
//! the incoming field, or of `[ROLE.grid]` if the case has that table. Output arrays are on the
//! same grid. The value of a key lives on a grid of one point; so does a scalar output if no input
//! comes from a surface.

use crate::wiring::{Give, Measure, Take, Wiring};
use proto::configuration::{Configuration, FieldOnGrid, Input, Layout, Refusal};
use proto::description::KeySpec;
use proto::field::{FieldKind, Mapping};
use proto::grid::{Grid, Structured};
use proto::params::Params;

/// Estimated time of a step [s].
const SECONDS: f64 = 1e-5;
/// Name of the grid with one point.
const POINT: &str = "point";
/// Name of the grid defined in the case.
const OWN: &str = "fmu";
/// Keys of the edges and element counts of the grid defined in the case, with their help texts.
const EDGES: [(&str, &str); 4] = [
    ("x_from", "rear edge"),
    ("x_to", "front edge"),
    ("y_from", "right edge"),
    ("y_to", "left edge"),
];
const COUNTS: [(&str, &str); 2] = [("nx", "elements along x"), ("ny", "elements along y")];

/// Input with its field.
#[derive(Debug)]
pub struct PlacedTake {
    /// Variables, and the part of the field they receive.
    pub take: Take,
    /// True for a density: its integral is the received power.
    pub conservative: bool,
    /// Number of components of the field.
    pub components: usize,
}

/// Output with its field.
#[derive(Debug)]
pub struct PlacedGive {
    /// Variables, and the field they give.
    pub give: Give,
    /// True if every component is one value, uniform over the grid.
    pub uniform: bool,
}

/// All exchanged fields.
#[derive(Debug, Default)]
pub struct Placed {
    /// Inputs.
    pub takes: Vec<PlacedTake>,
    /// Requested outputs.
    pub gives: Vec<PlacedGive>,
}

/// Returns the keys of the grid.
pub fn keys(role: &str) -> Vec<KeySpec> {
    let path = |name: &str| format!("{role}.grid.{name}");
    let help = |words: &str| format!("{words} of the FMU's grid; absent: the grid of the inputs");
    let edges = EDGES.map(|(name, words)| KeySpec::quantity(&path(name), "m", &help(words)));
    let counts = COUNTS.map(|(name, words)| {
        KeySpec::integer(&path(name), &help(words)).at_least(1.0).at_most(1e5)
    });
    edges.into_iter().chain(counts).map(|key| key.together(&format!("{role}.grid"))).collect()
}

fn own_grid(role: &str, case: &Params) -> Result<Option<Grid>, Refusal> {
    let table = format!("{role}.grid");
    if !case.has(&table) {
        return Ok(None);
    }
    let key = |name: &str| format!("{table}.{name}");
    let edge = |(name, _): (&str, &str)| case.number(&key(name));
    let [left, right, low, high] = EDGES.map(edge);
    let ([left, right], [low, high]) = ([left?, right?], [low?, high?]);
    let [nx, ny] = COUNTS.map(|(name, _)| case.integer(&key(name)));
    let (nx, ny) = (nx?, ny?);
    if !(left < right && low < high && nx > 0 && ny > 0) {
        let reason = "has no area or no elements";
        return Err(Refusal::new(
            &table,
            reason,
            "set x_from below x_to, y_from below y_to, and nx and ny above 0",
        ));
    }
    let (dx, dy) = ((right - left) / nx as f64, (high - low) / ny as f64);
    let (x, y) = (left + 0.5 * dx, low + 0.5 * dy);
    Ok(Some(Grid::structured(
        OWN,
        Structured::contact_plane(x, y, dx, dy, nx as usize, ny as usize),
    )))
}

/// Assigns grids to the wired variables. Returns no [`Placed`] while the grid of an input is
/// unknown.
///
/// # Errors
/// Fails if the number of values does not match a grid, or `[ROLE.grid]` is invalid.
pub fn place(
    role: &str,
    wiring: &Wiring,
    configuration: &Configuration,
) -> Result<(Option<Placed>, Layout), Refusal> {
    let own = own_grid(role, &configuration.case)?;
    let mut layout = Layout { solve_seconds: SECONDS, ..Layout::default() };
    let mut takes = Vec::new();
    let (mut surface, mut known) = (own.clone(), true);
    for take in &wiring.takes {
        let Some(input) = configuration.inputs.iter().find(|one| one.field.name == take.spec.name)
        else {
            continue;
        };
        layout.remarks.extend(remark(take, &input.field));
        let wanted = own.as_ref().filter(|_| is_array(take, &input.field));
        if let Some(own) = wanted {
            layout.inputs.push(on(take.spec.name, own));
        }
        let Some(grid) = wanted.or(input.grid.as_ref()) else {
            known = false;
            continue;
        };
        if surface.is_none() && grid.points() > 1 {
            surface = Some(grid.clone());
        }
        takes.push(taken(role, take, input, grid)?);
    }
    let gives =
        given(role, wiring, configuration, surface.filter(|_| known).as_ref(), known, &mut layout)?;
    if layout.inputs.iter().any(|one| one.grid == OWN) {
        layout
            .grids
            .extend(own.filter(|own| layout.grids.iter().all(|grid| grid.name != own.name)));
    }
    Ok((known.then_some(Placed { takes, gives }), layout))
}

fn on(field: &str, grid: &Grid) -> FieldOnGrid {
    FieldOnGrid { field: field.to_owned(), grid: grid.name.clone() }
}

fn size(variables: &[crate::variable::Variable]) -> usize {
    variables.iter().map(|one| one.size).sum()
}

/// True if the variables receive more than one value for each component.
fn is_array(take: &Take, field: &FieldKind) -> bool {
    take.measure == Measure::Values && size(&take.variables) != field.components as usize
}

/// Returns a remark if the name of the field's unit differs from the unit of the variables.
fn remark(take: &Take, field: &FieldKind) -> Option<String> {
    let strange = take.variables.iter().find(|one| {
        let name = &one.unit.name;
        take.measure != Measure::Integral
            && !name.is_empty()
            && one.unit.is_si()
            && *name != field.unit
    })?;
    Some(format!(
        "`{}` is in {} for the FMU, and {} is in {}: the numbers are the same",
        strange.name, strange.unit.name, field.name, field.unit
    ))
}

fn taken(role: &str, take: &Take, input: &Input, grid: &Grid) -> Result<PlacedTake, Refusal> {
    let components = input.field.components as usize;
    if take.measure != Measure::Values && !grid.has_areas() {
        let name = &input.field.name;
        let reason = format!(
            "the FMU takes the integral or the mean of `{name}`, but the grid `{}` has no areas",
            grid.name
        );
        let fix = format!("give the FMU a grid of its own in [{role}.grid], and wire `{name}`");
        return Err(Refusal::new(&format!("{role}.command"), reason, fix));
    }
    let expected = match take.measure {
        Measure::Values => components * grid.points(),
        Measure::Integral | Measure::Mean => components,
    };
    let found = size(&take.variables);
    if found != expected {
        let names: Vec<&str> = take.variables.iter().map(|one| one.name.as_str()).collect();
        let fix = match take.measure {
            Measure::Values if grid.points() > 1 => format!(
                "give the FMU a grid of its own in [{role}.grid], or wire integral({0}) or mean({0})",
                input.field.name
            ),
            _ => "wire as many variables as the field has components".to_owned(),
        };
        let reason = format!(
            "`{}` has {found} values in the FMU, and `{}` has {expected} on the grid `{}`",
            names.join(", "),
            input.field.name,
            grid.name
        );
        return Err(Refusal::new(&format!("{role}.command"), reason, fix));
    }
    let conservative = input.field.mapping == Mapping::Conservative;
    Ok(PlacedTake { take: take.clone(), conservative, components })
}

fn given(
    role: &str,
    wiring: &Wiring,
    configuration: &Configuration,
    surface: Option<&Grid>,
    known: bool,
    layout: &mut Layout,
) -> Result<Vec<PlacedGive>, Refusal> {
    let point = Grid::structured(POINT, Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 1, 1));
    let asked = |give: &&Give| {
        configuration
            .outputs
            .iter()
            .chain(&configuration.observed)
            .any(|name| *name == give.kind.name)
    };
    let mut gives = Vec::new();
    for give in wiring.gives.iter().filter(asked) {
        let components = give.kind.components as usize;
        let scalar = size(&give.variables) == components;
        let is_key = give.kind.name.contains('.');
        if !(known || is_key) {
            continue;
        }
        let grid = surface.filter(|_| !is_key).unwrap_or(&point);
        let values = components * grid.points();
        if !scalar && size(&give.variables) != values {
            let reason = format!(
                "the FMU gives {} values of `{}`, which has {values} on the grid `{}`",
                size(&give.variables),
                give.kind.name,
                grid.name
            );
            let fix = format!("give the FMU a grid of its own in [{role}.grid]");
            return Err(Refusal::new(&format!("{role}.command"), reason, fix));
        }
        if layout.grids.iter().all(|other| other.name != grid.name) {
            layout.grids.push(grid.clone());
        }
        layout.fields.push(on(&give.kind.name, grid));
        gives.push(PlacedGive { give: give.clone(), uniform: scalar });
    }
    Ok(gives)
}
