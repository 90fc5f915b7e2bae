//! Setup of a model from a configuration: checks, grids, cost.

use super::conduction::Conduction;
use super::conduction_model::ConductionModel;
use super::elements;
use super::elements::WAKE;
use super::ends::Ends;
use super::fields::{RISE_INTEGRALS, SECTIONS, SURFACES};
use super::frame::{CONTACT, Frame, SECTION_GRIDS};
use super::inputs;
use crate::capability::Capability;
use crate::effects::body_properties;
use crate::effects::bulk_heating;
use crate::effects::contact_conductance::Conductance;
use crate::effects::friction_heat::{self, Partition};
use crate::effects::integrated;
use crate::effects::joule_heat;
use crate::effects::phase_transformation;
use crate::effects::volume_temperature::VOLUMES;
use crate::scene::{CREEPAGE, Scene};
use crate::{LOWER, UPPER};
use proto::configuration::{Configuration, FieldOnGrid, Input, Layout, Mode, Refusal};
use proto::description::KeySpec;
use proto::field::{self, FieldSpec};
use proto::grid::{Grid, Structured};
use proto::model::Setup;
use proto::readable::quantity;

/// Key of the number of elements along the larger extent of the grid.
const RESOLUTION: &str = "thermal.resolution";

/// Key of the number of elements across the grid.
const RESOLUTION_ACROSS: &str = "thermal.resolution_across";

const SECTION_Y: &str = "thermal.section_y";

/// Returns the key for the lateral position of the sections.
#[must_use]
pub fn section_key() -> KeySpec {
    let help = "lateral coordinate of the sections; absent: where most heat is expected (of several \
                patches the one with the highest friction power), or 0, or the middle of a grid without y = 0";
    KeySpec::quantity(SECTION_Y, "m", help)
}

/// Returns the lateral coordinate of the sections below a grid of the heat flux [m].
fn section_y(given: &Configuration, grid: &Structured) -> Result<f64, Refusal> {
    if given.case.has(SECTION_Y) {
        return given.case.number(SECTION_Y);
    }
    let heat = given.inputs.iter().find(|input| is_heat(input));
    if let Some(peak) = heat.and_then(|input| input.peak) {
        return Ok(peak[1]);
    }
    let [first, last] = [0, grid.nj - 1].map(|row| grid.y(row));
    Ok(if first <= 0.0 && 0.0 <= last { 0.0 } else { 0.5 * (first + last) })
}

/// Returns the key for a resolution that differs from that of the heat flux's grid.
#[must_use]
pub fn resolution() -> KeySpec {
    let help = "elements along the larger extent of the heat flux's grid; absent: its grid";
    KeySpec::integer(RESOLUTION, help).at_least(2.0).at_most(1e5)
}

/// Returns the key for elements that are not square.
#[must_use]
pub fn resolution_across() -> KeySpec {
    let help = "elements across the heat flux's grid; absent: square elements, or its grid";
    KeySpec::integer(RESOLUTION_ACROSS, help).at_least(1.0).at_most(1e5)
}

/// Returns the key for the extent of the grid behind the contact.
#[must_use]
pub fn wake() -> KeySpec {
    let help = "distance behind the middle of the contact up to which temperatures are given; absent: that of \
                the heat flux's grid";
    KeySpec::quantity(WAKE, "m", help).above(0.0)
}

/// Checks a configuration and prepares the model for it.
///
/// # Errors
/// A configuration that the model does not support; a value that is missing or out of range.
pub fn configure<C: Conduction>(given: &Configuration) -> Result<Setup, Refusal> {
    if given.mode == Mode::Transient && !C::TRANSIENT {
        return Err(Refusal::new(
            "time.mode",
            format!("model `{}` supports only steady cases", given.model),
            "write mode = \"steady\", or [thermal] model = \"columns\"",
        ));
    }
    if !given.has_effect(friction_heat::NAME) {
        return Err(Refusal::new(
            "effects.friction_heat",
            "no other effect gives this participant any heat",
            "add the table `[effects.friction_heat]`",
        ));
    }
    let Some(arriving) = heat_grid(given)? else {
        // Checks that do not need the grid.
        check_scene::<C>(given, &Scene::read(&given.case)?)?;
        Conductance::read(&given.case, Partition::read(&given.case)?)?;
        let mut layout = Layout::default();
        layout.remarks.push("grid and cost follow the grid of friction_power".to_owned());
        return Ok(Setup::new(layout, |_| {
            Err(Refusal::new(
                "effects.friction_heat",
                "the grid of `friction_power` is not known",
                "configure the participant that computes it first",
            ))
        }));
    };
    let frame = frame::<C>(given, &arriving)?;
    let mut layout = lay_out::<C>(&frame, given);
    let moves = given.inputs.iter().any(|input| input.moves && is_heat(input));
    if frame.grid != arriving || moves {
        layout.inputs.push(on(&field::FRICTION_POWER, CONTACT));
    }
    if moves {
        layout.remarks.push("friction_power is mapped to its first grid".to_owned());
    }
    if frame.feels_pressure() {
        layout.inputs.extend(pressure(given, &frame.grid)?);
    }
    let asked = |spec: &FieldSpec| layout.grid_of(spec.name).is_some();
    let volumes = [LOWER, UPPER].map(|body| asked(&VOLUMES[body]).then_some(body));
    let expands = RISE_INTEGRALS.into_iter().any(asked);
    Ok(Setup::new(layout, move |_| {
        let volumes = volumes.into_iter().flatten().filter_map(|body| C::volume(&frame, body));
        let volumes = volumes.collect();
        Ok(Box::new(ConductionModel::<C>::new(frame, volumes, expands)))
    }))
}

/// Reads the bodies and the effects of a case, on the grid of the heat flux.
fn frame<C: Conduction>(given: &Configuration, arriving: &Structured) -> Result<Frame, Refusal> {
    let scene = Scene::read(&given.case)?;
    check_scene::<C>(given, &scene)?;
    let partition = Partition::read(&given.case)?;
    let conductance = Conductance::read(&given.case, partition)?;
    let mut grid = own_grid(given, arriving)?;
    if !C::ELEMENTS && given.case.has(WAKE) {
        grid = with_wake(grid, given.case.number(WAKE)?)?;
    }
    let memories = match given.has_effect(bulk_heating::NAME) {
        true => Some(bulk_heating::read(given, &scene)?),
        false => None,
    };
    let elements = if C::ELEMENTS { Some(elements::read(given, &scene)?) } else { None };
    let known = Frame {
        section_y: section_y(given, &grid)?,
        body_properties: body_properties(given, &scene)?,
        criterion: phase_transformation::read(given, &scene, C::REPEATS)?,
        current: joule_heat::read(given, &scene)?,
        ends: Ends::read(&given.case, &scene.names)?,
        slowest: [UPPER, LOWER].map(|body| scene.speed_range(given, body)[0]),
        mode: given.mode,
        windows: given.windows,
        slowest_motion: [UPPER, LOWER].map(|body| slowest_motion(&scene, body, given)),
        arriving: *arriving,
        heated: given.inputs.iter().find(|input| is_heat(input)).and_then(|input| input.extent),
        threads: given.threads,
        scene,
        partition,
        conductance,
        grid,
        elements,
        memories,
    };
    elements::check(&known)?;
    C::check(&known)?;
    Ok(known)
}

/// Returns the slowest motion of a body [m/s]. Models for which it matters have no steady contact
/// at rest.
fn slowest_motion(scene: &Scene, body: usize, given: &Configuration) -> f64 {
    let speeds = scene.speeds_in(body, given);
    let least = |speeds: &mut dyn Iterator<Item = f64>| speeds.fold(f64::INFINITY, f64::min);
    match given.mode {
        Mode::Transient => least(&mut speeds.into_iter()),
        Mode::Steady => least(&mut speeds.into_iter().filter(|speed| *speed > 0.0)),
    }
}

/// Refuses stationary bodies that the model or the partition of the heat does not support.
fn check_scene<C: Conduction>(given: &Configuration, scene: &Scene) -> Result<(), Refusal> {
    for body in [UPPER, LOWER] {
        let speeds = scene.speeds_in(body, given);
        if let Some(speed) = speeds.into_iter().find(|speed| *speed < 0.0) {
            let reason = inputs::runs_backwards(&scene.names.0[body], speed);
            return Err(Refusal::new(CREEPAGE, reason, "write a creepage of 1 or less"));
        }
    }
    if !C::SOLVES_STATIONARY_BODY {
        refuse_rest(given, scene)?;
    }
    let first = [UPPER, LOWER]
        .into_iter()
        .find_map(|body| scene.resting_row(body, given).map(|row| (body, row)));
    if let Some((body, row)) = first.filter(|_| !C::REPEATS)
        && Partition::read(&given.case)? == Partition::Effusivity
    {
        let name = &scene.names.0[body];
        return Err(Refusal::new(
            friction_heat::PARTITION_KEY,
            format!(
                "`{name}` is at rest{}: by effusivity and speed it gets no heat",
                in_row(given, row)
            ),
            touching::<C>(),
        ));
    }
    match integrated::active(given).filter(|_| !C::ENDS) {
        Some(effect) => integrated::refuse_rest(scene, given.mode, effect),
        None => Ok(()),
    }
}

/// Advice for a body at rest: surfaces that touch have the same temperature.
fn touching<C: Conduction>() -> &'static str {
    match C::CAPABILITIES.contains(&Capability::Exchange) {
        true => "write \"continuity\"",
        false => "write \"continuity\" and [thermal] model = \"moving-source\"",
    }
}

/// Names a row of the case's tables, counted from 1, to follow a statement.
fn in_row(given: &Configuration, row: usize) -> String {
    match given.histories {
        Some(_) => format!(" in row {}", row + 1),
        None => String::new(),
    }
}

/// Warns of a heat partition that ignores that a body at rest gets hotter and hotter.
fn warn_of_rest<C: Conduction>(frame: &Frame, given: &Configuration) -> Option<Refusal> {
    let rests = [UPPER, LOWER].map(|body| frame.scene.resting_row(body, given));
    let (body, row) = match rests {
        [Some(row), None] => (UPPER, row),
        [None, Some(row)] => (LOWER, row),
        _ => return None,
    };
    let equal = frame.partition == Partition::Equal && frame.conductance.is_none();
    let [own, other] = [body, UPPER + LOWER - body].map(|body| &frame.scene.names.0[body]);
    (equal && !C::REPEATS).then(|| {
        let row = in_row(given, row);
        let reason = format!(
            "`{own}` is at rest{row} and gets half of the heat, whatever its temperature: it becomes \
             hotter than `{other}`, which it touches"
        );
        Refusal::new(friction_heat::PARTITION_KEY, reason, touching::<C>())
    })
}

/// Refuses a steady case with a stationary body. With conduction normal to the surface only, a
/// point that is heated permanently has no steady temperature.
fn refuse_rest(given: &Configuration, scene: &Scene) -> Result<(), Refusal> {
    if scene.at_rest == [true; 2] {
        return Err(Refusal::new(
            "motion.speed",
            "nothing moves: without a speed no heat is carried through the contact",
            "write a speed above 0 m/s, or [thermal] model = \"moving-source\"",
        ));
    }
    let first = (0..2).find_map(|body| scene.resting_row(body, given).map(|row| (body, row)));
    let Some((body, row)) = first.filter(|_| given.mode == Mode::Steady) else { return Ok(()) };
    let own = scene.names.key(body, "surface_speed");
    let key = if given.case.has(&own) || body == LOWER { &own } else { CREEPAGE };
    let reason = inputs::never_steady(&scene.names.0[body], &in_row(given, row));
    Err(Refusal::new(key, reason, inputs::OF_RESTING_BODIES))
}

fn is_heat(input: &Input) -> bool {
    input.field.name == field::FRICTION_POWER.name
}

/// Maps the pressure to the grid of the heat flux, if it arrives on another grid.
fn pressure(given: &Configuration, grid: &Structured) -> Result<Option<FieldOnGrid>, Refusal> {
    let name = field::PRESSURE.name;
    let Some(input) = given.inputs.iter().find(|input| input.field.name == name) else {
        return Err(Refusal::new(
            "effects",
            format!(
                "no participant provides `{name}`, which contact_conductance, joule_heat and \
                 friction_heat.partition = \"continuity\" need"
            ),
            "remove it, or name a model that provides the pressure",
        ));
    };
    let arriving = input.grid.as_ref().and_then(|arriving| arriving.as_structured());
    Ok((arriving != Some(grid) || input.moves).then(|| on(&field::PRESSURE, CONTACT)))
}

/// Returns the grid on which the heat flux arrives, once it is known. A grid that is not a contact
/// plane is refused.
fn heat_grid(given: &Configuration) -> Result<Option<Structured>, Refusal> {
    let name = field::FRICTION_POWER.name;
    let Some(input) = given.inputs.iter().find(|input| is_heat(input)) else {
        return Err(Refusal::new(
            "effects.friction_heat",
            format!("no participant provides `{name}`"),
            "name a model that provides the friction power",
        ));
    };
    let Some(grid) = &input.grid else { return Ok(None) };
    let plane = |s: &&Structured| {
        let flat = s.step_i[1] == 0.0 && s.step_i[2] == 0.0 && s.step_j[0] == 0.0;
        flat && s.step_j[2] == 0.0 && s.dx() > 0.0 && s.dy() > 0.0 && s.points() > 0
    };
    match grid.as_structured().filter(plane) {
        Some(shape) => Ok(Some(*shape)),
        None => Err(not_a_plane(input)),
    }
}

/// Returns the grid with the resolution of the case: it covers the arriving grid with whole
/// elements that are as square as possible.
fn own_grid(given: &Configuration, arriving: &Structured) -> Result<Structured, Refusal> {
    let counts = [arriving.ni, arriving.nj];
    let extents = [counts[0] as f64 * arriving.dx(), counts[1] as f64 * arriving.dy()];
    let mut elements = counts.map(|count| count as f64);
    if given.case.has(RESOLUTION) {
        let (along, largest) = (given.case.integer(RESOLUTION)? as f64, extents[0].max(extents[1]));
        // Keep rounding from adding an element to a whole number.
        elements = extents.map(|extent| (along * extent / largest * (1.0 - 1e-12)).ceil());
    }
    if given.case.has(RESOLUTION_ACROSS) {
        elements[1] = given.case.integer(RESOLUTION_ACROSS)? as f64;
    }
    let [ni, nj] = elements.map(|count| count as usize);
    if [ni, nj] == counts {
        return Ok(*arriving);
    }
    let [dx, dy] = [extents[0] / elements[0], extents[1] / elements[1]];
    let mut origin = arriving.origin;
    origin[0] += 0.5 * (dx - arriving.dx());
    origin[1] += 0.5 * (dy - arriving.dy());
    Ok(Structured { origin, step_i: [dx, 0.0, 0.0], step_j: [0.0, dy, 0.0], ni, nj })
}

/// Largest number of columns of a grid with its part behind the contact.
const MOST_COLUMNS: f64 = 1e5;

/// Extends the grid by as many columns as it needs to reach this far behind its middle [m].
fn with_wake(grid: Structured, wake: f64) -> Result<Structured, Refusal> {
    let (dx, columns) = (grid.dx(), grid.ni as f64);
    let more = ((wake / dx - 0.5 * columns) * (1.0 - 1e-12)).ceil().max(0.0);
    if columns + more > MOST_COLUMNS {
        return Err(Refusal::new(
            WAKE,
            format!(
                "{wake} m need {more} elements of {dx}; at most {MOST_COLUMNS} are possible",
                dx = quantity(dx, "m", 4)
            ),
            "make it shorter, or elements longer with thermal.resolution",
        ));
    }
    let mut origin = grid.origin;
    origin[0] -= more * dx;
    Ok(Structured { origin, ni: grid.ni + more as usize, ..grid })
}

fn not_a_plane(input: &Input) -> Refusal {
    Refusal::new(
        &format!("{}.model", input.producer),
        "its grid is not made of rows along x in a contact plane",
        "name a model with such a grid",
    )
}

fn lay_out<C: Conduction>(frame: &Frame, given: &Configuration) -> Layout {
    let asked = |spec: &FieldSpec| {
        given.outputs.iter().chain(&given.observed).any(|name| name == spec.name)
    };
    let cost = C::cost(frame);
    let mut layout = Layout {
        grids: vec![Grid::structured(CONTACT, frame.grid)],
        fields: SURFACES.iter().map(|surface| on(surface, CONTACT)).collect(),
        solve_seconds: cost.solve_seconds,
        memory_bytes: cost.memory_bytes,
        remarks: C::remarks(frame),
        warnings: C::warnings(frame),
        left_out: C::left_out(frame).into_iter().collect(),
        ..Layout::default()
    };
    layout.warnings.extend(warn_of_rest::<C>(frame, given));
    let [upper, lower] = frame.scene.initial_temperatures;
    let flows = frame.conductance.is_some() || frame.partition == Partition::Continuity;
    if upper != lower && !flows {
        layout.remarks.push(format!(
            "the bodies begin at {upper} K and {lower} K: the heat that flows between them is \
             neglected without effects.contact_conductance"
        ));
    }
    for body in [LOWER, UPPER] {
        if asked(RISE_INTEGRALS[body]) {
            layout.fields.push(on(RISE_INTEGRALS[body], CONTACT));
            if C::KEEPS_WINDOWS && frame.mode == Mode::Transient && body == LOWER {
                layout.remarks.push(
                    "rise integrals keep an influence of every past window, in addition to the memory and time above"
                        .to_owned(),
                );
            }
        }
        if asked(SECTIONS[body]) {
            layout.grids.push(frame.section_grid(body));
            layout.fields.push(on(SECTIONS[body], SECTION_GRIDS[body]));
        }
        if asked(&VOLUMES[body])
            && let Some(grid) = C::volume(frame, body)
        {
            layout.fields.push(on(&VOLUMES[body], &grid.name));
            layout.grids.push(grid.announced());
        }
    }
    layout
}

fn on(spec: &FieldSpec, grid: &str) -> FieldOnGrid {
    FieldOnGrid { field: spec.name.to_owned(), grid: grid.to_owned() }
}
