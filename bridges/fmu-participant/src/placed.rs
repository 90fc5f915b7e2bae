//! Where the fields of an FMU live, and how many values its variables have of them.
//!
//! An array of an FMU has no places. Those of its inputs are the elements of the grid that the field comes on, or of
//! `[ROLE.grid]`, where the case has that; its outputs are on the same grid. A value of a key, and what a scalar gives where
//! nothing comes from a surface, is on a grid of one point.

use crate::wiring::{Give, Measure, Take, Wiring};
use proto::configuration::{Configuration, FieldOnGrid, Input, Layout, Refusal};
use proto::description::KeySpec;
use proto::field::{FieldKind, Mapping};
use proto::grid::{Grid, Structured};
use proto::params::Params;

/// Time of a step, a guess [s].
const SECONDS: f64 = 1e-5;
/// Name of the grid of one point.
const POINT: &str = "point";
/// Name of the grid that the case gives.
const OWN: &str = "fmu";
/// The edges of that grid, and the numbers of its elements.
const EDGES: [(&str, &str); 4] = [
    ("x_from", "rear edge"),
    ("x_to", "front edge"),
    ("y_from", "right edge"),
    ("y_to", "left edge"),
];
const COUNTS: [(&str, &str); 2] = [("nx", "elements along x"), ("ny", "elements along y")];

/// An input that is placed.
#[derive(Debug)]
pub struct PlacedTake {
    /// Its variables, and what they receive.
    pub take: Take,
    /// It is a density: its integral is the power that is received.
    pub conservative: bool,
    /// Components of the field.
    pub components: usize,
}

/// An output that is placed.
#[derive(Debug)]
pub struct PlacedGive {
    /// Its variables, and what they give.
    pub give: Give,
    /// Every component is one value, the same everywhere.
    pub uniform: bool,
}

/// All that crosses.
#[derive(Debug, Default)]
pub struct Placed {
    /// Inputs.
    pub takes: Vec<PlacedTake>,
    /// Outputs that are asked for.
    pub gives: Vec<PlacedGive>,
}

/// Keys of the grid.
pub fn keys(role: &str) -> Vec<KeySpec> {
    let path = |name: &str| format!("{role}.grid.{name}");
    let help = |words: &str| format!("{words} of the FMU's grid; absent: the grid of its inputs");
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
        let reason = "has no area, or no elements";
        return Err(Refusal::new(
            &table,
            reason,
            "let x_from be below x_to, and y_from below y_to",
        ));
    }
    let (dx, dy) = ((right - left) / nx as f64, (high - low) / ny as f64);
    let (x, y) = (left + 0.5 * dx, low + 0.5 * dy);
    Ok(Some(Grid::structured(
        OWN,
        Structured::contact_plane(x, y, dx, dy, nx as usize, ny as usize),
    )))
}

/// Places the wires; nothing is placed as long as the grid of an input is not known.
///
/// # Errors
/// Numbers of values that do not fit, an impossible grid.
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

/// It receives more than one value of a component.
fn is_array(take: &Take, field: &FieldKind) -> bool {
    take.measure == Measure::Values && size(&take.variables) != field.components as usize
}

/// A field whose unit is called otherwise than that of the variables.
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
