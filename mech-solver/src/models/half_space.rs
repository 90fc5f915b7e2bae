//! Model `half-space`: exact contact of elastic half-spaces by boundary elements.
//!
//! Normal problem on the undeformed distance of the bodies ([`gap`]), or the elliptic pressure that
//! the case gives under `[contact]`. Then the tangential problem: steady rolling ([`steady`]), or
//! transient rolling and shifting ([`transient`]). Each of longitudinal, lateral and spin creepage
//! is prescribed directly or through its force ([`drive`]). Without terms of adhesion the whole
//! contact slides: the traction is f p_n against the rigid slip, and the slip is the rigid slip.
//!
//! Pressure and traction are constant in an element and belong to the grid `contact`. Slip and
//! friction power belong to the grid `passage`. With the upwind difference they refer to the step
//! of a particle from an element's centre to the next one's, half an element upstream; with Fromm's
//! difference to the element centres. The total friction power equals the power of the forces over
//! the creepages, exactly and at every resolution ([`half_space::tangential`]).

mod answer;
mod balance;
mod case;
mod contact;
mod creeping;
mod drive;
mod expansion;
mod friction;
pub(super) mod gap;
pub(super) mod geometry;
mod power;
mod retardation;
mod spacing;
mod steady;
mod transient;

use crate::case::difference;
use crate::case::ellipse::Ellipse;
use crate::case::keys::CheckedParams;
use crate::case::resolution;
use crate::case::scene::{GivenPatch, Scene, contact_keys, given_patch_keys, width_key};
use crate::effects;
use crate::models::contact_model::ContactModel;
use crate::models::expected::refinement;
use crate::models::grids::fields_over;
use crate::models::varying::Varying;
use crate::registry::entry::ModelEntry;
use crate::terms::{Kind, Place, Terms};
use case::Case;
use drive::Driven;
use elastic::Elasticity;
use half_space::difference::Difference;
use half_space::retarded::Delay;
use half_space::viscoelastic::Bodies;
use proto::accuracy::Accuracy;
use proto::configuration::{Configuration, Layout, Mode, Refusal};
use proto::description::{KeySpec, ModelSpec, names};
use proto::field;
use proto::model::Setup;
use proto::readable::{number, quantity};
use steady::{Following, Steady};
use transient::Transient;

/// Solution time divided by elements^1.25, measured [s]: 0.04, 0.2 and 0.9 s with 40, 80 and 160
/// elements per semi-axis.
const SECONDS: f64 = 8e-7;
const GROWTH: f64 = 1.25;
/// Working memory per element, measured [byte].
const BYTES: f64 = 700.0;

/// Ratio of the semi-axis a to a body's radius above which a remark is printed.
const LARGEST_SHARE: f64 = 0.2;

const ROLLING: &str = "mech.rolling";

const START: &str = "mech.start";

fn start_key() -> KeySpec {
    let help = "start of the solution of a row: the solution of the previous row, or none";
    KeySpec::choice(START, &["warm", "cold"], help).default_value("warm")
}

const BEGIN: &str = "mech.begin";

fn begin_key() -> KeySpec {
    let help = "start of rolling with memory: bodies pressed together without tractions, or their steady rolling";
    KeySpec::choice(BEGIN, &["pressed", "steady"], help).default_value("pressed")
}

/// Returns whether a transient contact starts from steady rolling.
fn begins_steady(
    configuration: &Configuration,
    scene: &Scene,
    memory: bool,
) -> Result<bool, Refusal> {
    let case = CheckedParams::new(&configuration.case, vec![begin_key()]);
    let steady = case.text(BEGIN)? == "steady";
    if steady && !(memory && scene.speeds.rolling > 0.0) {
        let reason = "only a contact that rolls with memory can start from a steady state";
        let fix =
            "write mech.rolling = \"transient\" and a motion.speed above 0, or remove the key";
        return Err(Refusal::new(BEGIN, reason, fix));
    }
    Ok(steady)
}

/// Refuses friction that depends on the slip of every element if the slip is not solved for.
fn refuse_local(case: &Case) -> Result<(), Refusal> {
    if case.terms.friction.follows_elements().is_none() {
        return Ok(());
    }
    if !case.terms.adhesion {
        let reason = "friction depends on the slip of every element, which must be solved for";
        return Err(effects::lacking(Kind::Adhesion, reason));
    }
    Ok(())
}

fn rolling_key() -> KeySpec {
    KeySpec::choice(
        ROLLING,
        &["steady", "transient"],
        "steady: every instant in its steady state; transient: starting from the previous tractions",
    )
    .default_value("steady")
}

/// Registry entry of this model.
pub(super) const MODEL: ModelEntry = ModelEntry {
    name: "half-space",
    spec,
    takes: &[
        Kind::Gap,
        Kind::FrictionFactor,
        Kind::LocalSlip,
        Kind::TractionBound,
        Kind::PressureBound,
        Kind::Adhesion,
        Kind::Layer,
        Kind::Yield,
        Kind::Axle,
        Kind::Expansion,
        Kind::Retardation,
        Kind::HeatShare,
        Kind::Removal,
        Kind::Observation,
    ],
    configure,
};
/// Default number of elements per semi-axis.
const RESOLUTION: usize = 40;

/// Description of this model: keys, fields and accuracy.
fn spec() -> ModelSpec {
    let mut keys = [contact_keys(), given_patch_keys()].concat();
    keys.push(width_key());
    keys.extend(geometry::keys());
    keys.extend(drive::keys());
    keys.push(rolling_key());
    keys.push(begin_key());
    keys.push(difference::key());
    keys.push(start_key());
    keys.push(resolution::key(RESOLUTION));
    ModelSpec {
        name: MODEL.name.to_owned(),
        summary: "elastic half-spaces by boundary elements: exact partial slip, all creepages"
            .to_owned(),
        source: "Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990) ch. 4; \
                 Vollebregt, Wear 314 (2014)"
            .to_owned(),
        steady: true,
        transient: true,
        rewinds: true,
        varies_step: true,
        consumes: Vec::new(),
        provides: names(&[
            &field::PRESSURE,
            &field::TRACTION,
            &field::SLIP_VELOCITY,
            &field::CONTACT_FORCE,
        ]),
        keys,
        accuracy: Accuracy { refinement: Some(refinement(1.5, 0.01)), ..Accuracy::default() },
    }
}

/// Checks a configuration without allocating any lasting field.
///
/// # Errors
/// A case that is incomplete or out of range; shapes that do not touch or touch too steeply; a
/// force beyond f N; a grid that is too large.
fn configure(configuration: &Configuration, mut terms: Terms) -> Result<Setup, Refusal> {
    let scene = Scene::read(&configuration.case)?;
    let patch = GivenPatch::read(&configuration.case)?;
    let given = patch.map(|patch| Ellipse::solve(&scene, Some(patch))).transpose()?;
    let materials = scene.materials();
    let (bodies, delays) = match scene.speeds.rolling > 0.0 {
        true => {
            let bodies = Bodies::rolling(&materials, &terms.retardation, scene.speeds.rolling);
            (bodies, Vec::new())
        }
        false => {
            let [upper, lower] = &materials;
            let delays = Delay::of(&materials, &terms.retardation);
            (Elasticity::of_pair(upper, lower).into(), delays)
        }
    };
    let memory = memory(configuration, &scene, terms.adhesion)?;
    let varying = Varying::of(configuration, &terms, patch)?;
    retardation::refuse(&scene, patch, &terms, memory, varying.is_some())?;
    let extent = varying.as_ref().map(|varying| varying.extent(patch)).transpose()?;
    let difference = difference::read(&configuration.case)?;
    let shapes = geometry::Shapes {
        scene: &scene,
        given,
        extent: extent.as_ref(),
        bodies: &bodies,
        delays: &delays,
        terms: &terms,
        resolution: resolution::read(&configuration.case, RESOLUTION)?,
        // Steps with memory are as long as elements, rows of a history share a grid, and bodies of
        // different constants slip under their pressure, too.
        follows_slip: scene.speeds.rolling > 0.0
            && !memory
            && varying.is_none()
            && terms.adhesion
            && !bodies.are_coupled()
            && difference == Difference::Fromm,
    };
    let footprint = geometry::footprint(configuration, &shapes)?;
    let ellipse = footprint.ellipse.as_ref();
    let driven = Driven::read(configuration, &scene, given.as_ref(), ellipse, terms.adhesion)?;
    let (grid, semi_axes) = (footprint.grid, footprint.semi_axes);
    let place = Place { grid, semi_axes, peak_y: footprint.peak_y.unwrap_or(0.0) };
    terms.observations.iter_mut().for_each(|term| term.place(&place));
    terms.removal.iter_mut().for_each(|removal| removal.place(&grid));
    let mut case = Case {
        memory,
        difference,
        begins_steady: begins_steady(configuration, &scene, memory)?,
        terms,
        shift_duration: 0.0,
        first_step: false,
        scene,
        bodies,
        delays,
        driven,
        footprint,
        rises: Vec::new(),
        heated: None,
    };
    if case.bodies.are_coupled() && case.footprint.gap.is_none() {
        return Err(Refusal::new(
            "contact",
            "bodies of different elastic constants change the pressure, but the case gives it",
            "remove [contact], or give both bodies the same material",
        ));
    }
    if let Some(effect) = case.terms.effect_of(Kind::PressureBound) {
        refuse_bound(&case, effect)?;
    }
    refuse_local(&case)?;
    if let Some(effect) = case.terms.effect_of(Kind::Yield) {
        refuse_layer(&case.terms, effect)?;
    }
    if let Some(effect) = case.terms.effect_of(Kind::Expansion) {
        expansion::refuse(&case, effect)?;
        case.expand_observed()?;
    }
    if let Some(effect) = case
        .terms
        .friction_effect()
        .filter(|_| case.scene.speeds.rolling == 0.0 && case.terms.friction.follows_slip())
    {
        return Err(Refusal::new(
            &format!("effects.{effect}"),
            "friction depends on the slip velocity of rigid bodies, and a shift without rolling has none",
            "write a motion.speed above 0, or remove the effect",
        ));
    }
    if let (true, Some(key)) = (case.memory, case.terms.friction.memory_of_rows()) {
        return Err(Refusal::new(
            key,
            "friction has a memory along the rows of a steady contact, not from step to step",
            "write 0, mech.rolling = \"steady\" and a motion.speed above 0, or slip = \"rigid\"",
        ));
    }
    let mut layout = layout(configuration, &case);
    if let (Some(varying), Some(extent)) = (&varying, &extent) {
        refuse_varying(&case, configuration)?;
        layout.remarks.push(varying.remark(extent));
        (layout.solve_seconds, layout.build_seconds) = (layout.build_seconds, 0.0);
    }
    let warm = CheckedParams::new(&configuration.case, vec![start_key()]).text(START)? == "warm";
    let following = varying.map(|varying| Following { varying, patch, warm });
    Ok(Setup::new(layout, move |_| {
        if !case.memory {
            return Ok(Box::new(ContactModel::new(Steady::new(case, following))));
        }
        let fix = "check the shapes, the load and the units";
        let transient = Transient::new(case, following)
            .map_err(|error| Refusal::new("load", error.to_string(), fix))?;
        Ok(Box::new(ContactModel::new(transient)))
    }))
}

/// Refuses a pressure bound for bodies of different elastic constants: the power of the yielding
/// material is missing in the power balance.
fn refuse_bound(case: &Case, effect: &str) -> Result<(), Refusal> {
    if !case.bodies.are_coupled() {
        return Ok(());
    }
    Err(Refusal::new(
        &format!("effects.{effect}"),
        "bodies of different elastic constants slip under their pressure, and the power of the yielding \
         material is missing in the balance",
        "give both bodies the same material, or remove the effect",
    ))
}

/// Refuses a yielding layer where nothing sticks, and a layer that softens faster than it unloads.
fn refuse_layer(terms: &Terms, effect: &str) -> Result<(), Refusal> {
    if !terms.adhesion {
        let reason = "the plastic flow of a layer is a part of the slip, which must be solved for";
        return Err(effects::lacking(Kind::Adhesion, reason));
    }
    let softening = -terms.yields.map_or(0.0, |law| law.hardening);
    match softening * terms.layer() < 1.0 {
        true => Ok(()),
        false => Err(Refusal::new(
            &format!("effects.{effect}.hardening"),
            format!(
                "the layer softens by {softening} Pa/m, but its flexibility unloads it by {} Pa/m only: its traction would jump",
                number(terms.layer().recip(), 4),
                softening = number(softening, 4)
            ),
            "reduce the softening, or make the layer stiffer",
        )),
    }
}

/// Refuses features that do not support values varying in time.
fn refuse_varying(case: &Case, configuration: &Configuration) -> Result<(), Refusal> {
    if case.memory && configuration.histories.as_ref().is_some_and(|histories| histories.rows) {
        return Err(Refusal::new(
            "time.mode",
            "rows of a sequence are independent contacts, without time for tractions to build up",
            "write time.mode = \"transient\" with a time.window and a time.end",
        ));
    }
    let profile = case.footprint.gap.as_ref().is_some_and(|gap| !gap.is_quadric());
    if profile {
        return Err(Refusal::new(
            "mech.model",
            "measured profiles do not support a varying load: their contact would need another grid in every window",
            "give radii, or write numbers in place of columns and no axle",
        ));
    }
    if case.memory && case.terms.axle.is_some() {
        return Err(Refusal::new(
            ROLLING,
            "rolling with memory does not support the load under an axle",
            "write mech.rolling = \"steady\", or a column of the load in place of the axle",
        ));
    }
    match case.terms.effect_of(Kind::Removal) {
        Some(effect) if case.memory => Err(Refusal::new(
            &format!("effects.{effect}"),
            "tractions with memory do not support removal of material by passages",
            "write mech.rolling = \"steady\" and a motion.speed above 0, or remove the effect",
        )),
        _ => Ok(()),
    }
}

/// Returns whether the tractions of one step affect the next step.
fn memory(configuration: &Configuration, scene: &Scene, partial: bool) -> Result<bool, Refusal> {
    let case = CheckedParams::new(&configuration.case, vec![rolling_key()]);
    let transient = case.text(ROLLING)? == "transient";
    let rolls = scene.speeds.rolling > 0.0;
    if transient && configuration.mode == Mode::Steady {
        return Err(Refusal::new(
            ROLLING,
            "a steady case has no time for tractions to build up",
            "write time.mode = \"transient\", or remove the key",
        ));
    }
    if (transient || !rolls) && !partial {
        let reason = "a contact that slides everywhere has no tractions to build up";
        return Err(effects::lacking(Kind::Adhesion, reason));
    }
    Ok(transient || !rolls)
}

fn layout(configuration: &Configuration, case: &Case) -> Layout {
    let grid = case.footprint.grid;
    let upstream = case.passage().middle;
    let elements = grid.points() as f64;
    let how = match case.memory {
        true => "one step per element rolled, or one for a shift",
        false if case.terms.follow_inputs() => "solved in every iteration",
        false => "solved once, in the first window",
    };
    let size = format!(
        "{} x {} elements of {:.4} x {:.4} mm; {how}",
        grid.ni,
        grid.nj,
        1e3 * grid.dx(),
        1e3 * grid.dy()
    );
    let [a, _] = case.footprint.semi_axes;
    let too_large = (a > LARGEST_SHARE * case.scene.smallest_radius_x()).then(|| {
        format!(
            "a = {a} is not small compared with a body's radius: the half-space assumption \
                 does not hold",
            a = quantity(a, "m", 4)
        )
    });
    let layer = case.terms.effect_of(Kind::Layer).filter(|_| !case.terms.adhesion);
    let idle = layer.map(|layer| {
        format!("{layer} has no influence {}", effects::without(Kind::Adhesion))
            + "the whole contact slides"
    });
    let seconds = SECONDS * elements.powf(GROWTH);
    let once = !case.memory && !case.terms.follow_inputs();
    let peak =
        case.footprint.peak_y.map(|y| (field::FRICTION_POWER.name.to_owned(), [0.0, y, 0.0]));
    let smooth = case.footprint.ellipse.as_ref().filter(|_| case.is_hertzian());
    let given = case.footprint.ellipse.filter(|_| case.footprint.gap.is_none());
    let remark = given.and_then(|ellipse| ellipse.remark(&case.scene));
    let slips = case.footprint.slips.map(|half| (field::FRICTION_POWER.name.to_owned(), half));
    Layout {
        peaks: peak.into_iter().collect(),
        extents: slips.into_iter().collect(),
        solve_seconds: if once { 0.0 } else { seconds },
        build_seconds: if once { seconds } else { 0.0 },
        closed_forms: smooth.map(Ellipse::closed_forms).unwrap_or_default(),
        memory_bytes: (BYTES * elements) as u64,
        remarks: std::iter::once(size)
            .chain(case.footprint.remarks.iter().cloned())
            .chain(remark)
            .chain(too_large)
            .chain(idle)
            .collect(),
        warnings: case.footprint.gap.iter().flat_map(|gap| gap.warnings(&case.scene)).collect(),
        ..fields_over(configuration, grid, upstream, &case.terms.observations)
    }
}
