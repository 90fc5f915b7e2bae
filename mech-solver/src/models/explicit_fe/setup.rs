//! A checked case, and the bodies built from it.

use super::creep_curve::CreepCurve;
use super::heated::Heated;
use super::keys::{DENSITY, DEPTH, Extent, MASS_SCALING, PENALTY, RESOLUTION, own_keys};
use super::outcome::{self, Fields};
use super::passage::{Passage, Report};
use super::surfaces::Surfaces;
use crate::case::ellipse::{Ellipse, Prescribed};
use crate::case::keys::CheckedParams;
use crate::case::resolution;
use crate::case::scene::{Drive, GivenPatch, Load, Scene};
use crate::models::contact_model::ContactModel;
use crate::models::precomputed::{self, Precomputed};
use crate::terms::softening::Softening;
use crate::terms::{Kind, Terms};
use explicit_fe::block::{Block, Solid, Support};
use explicit_fe::contact::Law;
use explicit_fe::kernel::Flow;
use explicit_fe::plane::Plane;
use explicit_fe::quality::Quality;
use explicit_fe::rolling::{Options, Rolling};
use explicit_fe::section::{Section, Sizes};
use explicit_fe::steady_rolling::{expected_steps, expected_steps_again, settle};
use proto::configuration::{Configuration, Mode, Refusal};
use proto::field::FieldSpec;
use proto::grid::Structured;
use proto::model::{Model, Setup};
use proto::params::Params;
use proto::progress::Progress;
use proto::readable::quantity;

/// Largest growth of the contact's length and width under varying forces, relative to that under
/// the load.
const GROWTH: f64 = 1.6;
/// Minimum distance to an irregularity, in half lengths of the contact.
const CLEAR: f64 = 1.2;
/// Elements computed per second on one core, measured.
const ELEMENTS_PER_SECOND: f64 = 5e7;
/// Memory per element [byte]: state with forces on planes, and a saved state.
const BYTES_PER_ELEMENT: [u64; 2] = [60, 65];
/// Approximate length of a step, relative to the time of a wave through an element.
const STEP: f64 = 0.85;
/// Approximate number of elements between progress reports.
const REPORT: u64 = 20_000_000;

/// A checked case.
struct Prepared {
    element: f64,
    sections: [Section; 2],
    curve: CreepCurve,
    solids: [Solid; 2],
    columns: usize,
    asked: Options,
    scene: Scene,
    terms: Terms,
    grid: Structured,
    first_row: usize,
    wanted: Vec<&'static FieldSpec>,
}

/// Checks a case.
///
/// # Errors
/// Values that are missing or out of range; features that this model does not support.
pub(super) fn configure(configuration: &Configuration, terms: Terms) -> Result<Setup, Refusal> {
    let case = &configuration.case;
    let mut scene = Scene::read(case)?;
    check(configuration, &scene, &terms)?;
    for (body, softening) in scene.bodies.iter_mut().zip(&terms.softening) {
        let [stiffness, _] = softening.as_ref().map_or([1.0; 2], Softening::of_body);
        body.material.youngs_modulus *= stiffness;
    }
    let resolution = resolution::read(case, RESOLUTION)?;
    let surfaces = Surfaces::read(configuration, &scene, resolution)?;
    let element = surfaces.ellipse.semi_axis_a / resolution as f64;
    let growth = if terms.axle.is_some() { GROWTH } else { 1.0 };
    let Extent { length, whole, fine, watched } = Extent::read(case, &scene, &surfaces, growth)?;
    let sizes = Sizes { element, middle: surfaces.middle, fine, whole };
    let section = |body: usize| Section::new(&sizes, |y| surfaces.drop(body, y));
    let sections = [section(0), section(1)];
    let columns = (length / element).ceil() as usize;
    let (grid, first_row) = contact_grid(&sections[1], &sizes, watched);
    let asked = asked(configuration, &scene, &surfaces, &terms)?;
    let [across, deep] = sections[1].counts;
    let elements = 2 * columns.next_multiple_of(8) * across * deep;
    let solid = |body: usize| solid(case, &scene, &terms, body, surfaces.radii[body]);
    let solids = [solid(0)?, solid(1)?];
    let step = STEP * element / solids.iter().map(wave_speed).fold(0.0, f64::max);
    let steps = expected_steps(&asked, step);
    let cores = configuration.threads.clamp(1, 2) as f64;
    let per_step = elements as f64 / (cores * ELEMENTS_PER_SECOND);
    let wanted = precomputed::wanted_fields(configuration);
    let mut layout = precomputed::layout(configuration, grid, steps * per_step);
    layout.memory_bytes += elements as u64 * BYTES_PER_ELEMENT[0];
    layout.remarks.push(format!(
        "{elements} elements of {:.4} mm in the contact, about {steps:.0} steps of {:.1} ns over {:.1} mm of rolling",
        1e3 * element,
        1e9 * step,
        1e3 * steps * step * asked.speed
    ));
    if terms.warms() {
        layout.memory_bytes += elements as u64 * BYTES_PER_ELEMENT[1];
        layout.solve_seconds += expected_steps_again(&asked, step) * per_step;
    }
    if terms.axle.is_some() {
        layout.memory_bytes += elements as u64 * BYTES_PER_ELEMENT[1];
        layout.seconds_per_second = per_step / step;
        layout.remarks[0] = format!(
            "rolls steadily first; from there a millisecond takes {:.0} steps",
            1e-3 / step
        );
    }
    refuse_at_once(&terms, asked.half_length)?;
    layout.remarks.extend(surfaces.remarks);
    for (which, section) in sections.iter().enumerate() {
        let quality = Quality::of(section, element, solids[which].radius);
        layout.remarks.push(mesh_quality(&scene.names.0[which], &quality)?);
    }
    let speed = scene.speeds.rolling;
    let friction = scene.friction_coefficient;
    let curve =
        CreepCurve::new(configuration, resolution, friction, speed, asked.law.flexibility[1]);
    let prepared = Prepared {
        curve,
        element,
        sections,
        solids,
        columns,
        asked,
        scene,
        terms,
        grid,
        first_row,
        wanted,
    };
    Ok(Setup::new(layout, |progress| prepared.build(progress)))
}

/// Refuses an irregularity that lies within the contact from the start; `half_length` is that of
/// the contact [m].
fn refuse_at_once(terms: &Terms, half_length: f64) -> Result<(), Refusal> {
    let irregularity = terms.axle.and_then(|axle| axle.irregularity);
    let (Some(irregularity), Some(effect)) = (irregularity, terms.effect_of(Kind::Axle)) else {
        return Ok(());
    };
    let least = CLEAR * half_length;
    if irregularity.begins() >= least {
        return Ok(());
    }
    let begins = irregularity.begins();
    Err(Refusal::new(
        &format!("effects.{effect}.at"),
        format!(
            "the irregularity begins after {begins}, under the contact of steady rolling",
            begins = quantity(begins, "m", 5)
        ),
        format!("write {} or more", quantity(irregularity.at + least - begins, "m", 5)),
    ))
}

/// Remark of the plan on the mesh quality of a body.
fn mesh_quality(body: &str, quality: &Quality) -> Result<String, Refusal> {
    let Quality { aspect, jacobian, growth, shortest } = quality;
    if *jacobian <= 0.0 {
        return Err(Refusal::new(
            DEPTH,
            format!("elements of the {body} fold over: their scaled Jacobian is {jacobian:.2}"),
            "write a smaller width or depth, or a larger radius",
        ));
    }
    Ok(format!(
        "elements of the {body}: aspect ratio up to {aspect:.0}, growth up to {growth:.2}, scaled Jacobian from {jacobian:.3}, \
         shortest edge {:.4} mm",
        1e3 * shortest
    ))
}

/// Refuses features that this model does not support.
fn check(configuration: &Configuration, scene: &Scene, terms: &Terms) -> Result<(), Refusal> {
    if let Some(effect) = terms.effect_of(Kind::Axle) {
        if configuration.mode == Mode::Steady {
            return Err(Refusal::new(
                &format!("effects.{effect}"),
                "steady rolling does not depend on the axle that carries the load",
                "write time.mode = \"transient\" with a window and an end, or remove the effect",
            ));
        }
        let warm = [Kind::Expansion, Kind::Softening].into_iter();
        if let Some(other) = warm.filter_map(|kind| terms.effect_of(kind)).next() {
            return Err(Refusal::new(
                &format!("effects.{other}"),
                format!(
                    "heat changes explicit elements in steady rolling, not on the axle of effects.{effect}"
                ),
                "remove one of them",
            ));
        }
        if CheckedParams::new(&configuration.case, own_keys()).number(MASS_SCALING)? > 1.0 {
            return Err(Refusal::new(
                MASS_SCALING,
                "mass scaling is for steady rolling",
                "leave it out",
            ));
        }
    }
    if configuration.histories.is_some() {
        return Err(Refusal::new(
            "mech.model",
            "explicit elements do not support histories",
            "write numbers in place of columns, or mech.model = \"half-space\"",
        ));
    }
    Ellipse::refuse_rest(scene)?;
    if GivenPatch::read(&configuration.case)?.is_some() {
        return Err(Refusal::new(
            "contact",
            "explicit elements compute the contact themselves",
            "remove [contact], or write mech.model = \"half-space\"",
        ));
    }
    if let Load::Approach(_) = scene.load {
        return Err(Refusal::new(
            "load.approach",
            "explicit elements need a prescribed normal force",
            "write load.normal_force",
        ));
    }
    let [upper, lower] = &scene.bodies;
    let names = &scene.names;
    if !(upper.radius_x.is_finite() && upper.radius_x > 0.0) {
        let reason = "explicit elements need an upper body that rolls";
        return Err(Refusal::new(&names.key(0, "radius_x"), reason, "write its radius of rolling"));
    }
    if lower.radius_x.is_finite() && lower.radius_x < 0.0 {
        let reason = "explicit elements need a lower body that is straight or convex along x";
        return Err(Refusal::new(
            &names.key(1, "radius_x"),
            reason,
            "write mech.model = \"half-space\"",
        ));
    }
    if let Drive::Creepage { eta, phi, .. } = scene.drive
        && (eta, phi) != (0.0, 0.0)
    {
        return Err(Refusal::new(
            "motion.creepage",
            "explicit elements roll straight ahead, without lateral creepage and spin",
            "remove eta and phi, or write mech.model = \"half-space\"",
        ));
    }
    if scene.speeds.prescribed.is_some() {
        return Err(Refusal::new(
            &names.key(0, "surface_speed"),
            "explicit elements roll with a speed and a creepage",
            "write motion.speed with motion.creepage or motion.traction_coefficient",
        ));
    }
    Ok(())
}

fn asked(
    configuration: &Configuration,
    scene: &Scene,
    surfaces: &Surfaces,
    terms: &Terms,
) -> Result<Options, Refusal> {
    let Surfaces { ellipse, stiffness, .. } = surfaces;
    let own = CheckedParams::new(&configuration.case, own_keys());
    let yields = own.maybe_number(PENALTY)?.map_or(0.0, |stiffness| 1.0 / stiffness);
    let (creepage, force) = match ellipse.prescribed(scene)? {
        Prescribed::Creepage { xi, .. } => (xi, None),
        Prescribed::ForceRatio(ratio) => (0.0, Some(ratio)),
    };
    Ok(Options {
        speed: scene.speeds.rolling,
        load: ellipse.normal_force,
        law: Law {
            coefficient: scene.friction_coefficient,
            sticks: terms.adhesion,
            flexibility: [yields, yields + terms.layer()],
        },
        creepage,
        force,
        half_length: ellipse.semi_axis_a,
        stiffness: *stiffness,
        threads: configuration.threads,
    })
}

fn solid(
    case: &Params,
    scene: &Scene,
    terms: &Terms,
    which: usize,
    radius: f64,
) -> Result<Solid, Refusal> {
    let body = &scene.bodies[which];
    let name = case.text(&scene.names.key(which, "material"))?;
    let own = CheckedParams::new(case, own_keys());
    let density = own.number(&format!("materials.{name}.{DENSITY}"))? * own.number(MASS_SCALING)?;
    let (e, nu) = (body.material.youngs_modulus, body.material.poisson_ratio);
    if nu >= 0.4999 {
        return Err(Refusal::new(
            &format!("materials.{name}.poisson_ratio"),
            format!("with {nu} the wave speed is unbounded"),
            "write 0.499 or less",
        ));
    }
    let softer = terms.softening[which].as_ref().map_or([1.0; 2], Softening::of_body);
    let flow = terms.flow[which].map(|flow| Flow {
        yield_stress: softer[1] * flow.yield_stress,
        hardening: flow.hardening.map(|modulus| softer[0] * modulus),
    });
    let lambda = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    Ok(Solid { lame: [lambda, body.material.shear_modulus()], density, flow, radius })
}

fn wave_speed(solid: &Solid) -> f64 {
    ((solid.lame[0] + 2.0 * solid.lame[1]) / solid.density).sqrt()
}

/// Grid over the watched part of the contact plane, with one row per fine row of nodes.
fn contact_grid(mesh: &Section, sizes: &Sizes, reach: [f64; 2]) -> (Structured, usize) {
    let Sizes { element, middle, .. } = *sizes;
    let columns = 2 * (reach[0] / element).ceil() as usize + 1;
    let x0 = -0.5 * (columns - 1) as f64 * element;
    let rows: Vec<usize> = (mesh.fine[0] + 1..mesh.fine[1])
        .filter(|row| (mesh.nodes[*row][0] - middle).abs() <= reach[1])
        .collect();
    let (first, y0) = (rows[0], mesh.nodes[rows[0]][0]);
    (Structured::contact_plane(x0, y0, element, element, columns, rows.len()), first)
}

impl Prepared {
    /// Rolls the bodies until they are steady.
    fn build(self, progress: &Progress) -> Result<Box<dyn Model>, Refusal> {
        let Self {
            element,
            sections,
            solids,
            columns,
            mut asked,
            scene,
            terms,
            grid,
            first_row,
            wanted,
            curve,
        } = self;
        if let Some(ratio) = asked.force {
            asked.creepage = curve.creepage(ratio)?;
            // Without adhesion everything slides at this creepage.
            asked.force = asked.force.filter(|_| asked.law.sticks);
        }
        let [upper, lower] = sections;
        let block = |section: Section, solid: Solid| {
            Block::new(columns, element, section, solid, Support::Faces)
        };
        let bodies = [block(upper, solids[0]), block(lower, solids[1])];
        let elements: u64 = bodies.iter().map(|body| body.elements() as u64).sum();
        let mut rolling = Rolling::new(bodies, Plane::new(grid, first_row), asked);
        let every = (REPORT / elements).max(1);
        let progress = progress.clone();
        let mut report: Report = Box::new(move |done: u64, of: u64| {
            if done.is_multiple_of(every) {
                progress.report(done, of, "rolling");
            }
        });
        let (means, met) = settle(&mut rolling, |ratio| curve.creepage(ratio), &mut *report)?;
        outcome::check(&rolling, &means)?;
        outcome::met_force(&means, met)?;
        let fields = Fields { scene, terms };
        if let Some(axle) = fields.terms.axle {
            rolling.begin(&means);
            let passage = Passage::new(rolling, &means, axle, fields, report);
            return Ok(Box::new(ContactModel::new(passage)));
        }
        if fields.terms.warms() {
            let heated = Heated::new(rolling, &means, curve, fields, report);
            return Ok(Box::new(ContactModel::new(heated)));
        }
        let values = precomputed::fields(&wanted, &rolling.plane.grid, |spec, values| {
            fields.write(spec, &rolling, values);
        });
        let Fields { scene, terms } = fields;
        let (summary, work) =
            (outcome::summary(&scene, &rolling, &means), rolling.steps() * elements);
        Ok(Precomputed { summary, work, fields: values, terms }.model())
    }
}
