//! Model `fastsim`: Kalker's simplified theory on Hertz's ellipse.
//!
//! Normal: [`crate::reference::hertz`], or the ellipse that the case gives under `[contact]`.
//! Tangential, for longitudinal, lateral and spin creepage: the surfaces are beds of springs whose
//! flexibility follows from Kalker's linear theory ([`crate::reference::kalker`]), and Coulomb's law
//! holds with the bound f · 2N/(π a b) · (1 − x²/a² − y²/b²). The parabola is for the traction only:
//! its stick zone is what the springs can follow up to the leading edge, and it is up to 4/3 of f
//! times the pressure of Hertz, which the field `pressure` gives. Without terms of adhesion
//! the whole contact slides, with f times Hertz's pressure.
//!
//! A prescribed longitudinal force is met by ξ alone, η = φ = 0; it is monotone in ξ, from 0 to f N
//! at a finite creepage.
//!
//! | module | what |
//! |---|---|
//! | `flexibility` | the springs |
//! | `march` | strips, cells and the march with Coulomb's law |
//! | `sliding` | the contact without a stick zone |
//! | `contact` | prescribed force, sums over the contact |
//! | `fields` | element means on the contact's grid |
//!
//! The model is quasi-static and has no memory. It is computed once, when the model is built.
//!
//! Source: J. J. Kalker, A fast algorithm for the simplified theory of rolling contact, Vehicle
//! System Dynamics 11 (1982) 1–13. Deviations: the strips are closer together towards the sides; a
//! cell's traction is the mean of its two ends, which keeps the energy balance; one flexibility for
//! all creepages is the default, see `flexibility`; bodies of different materials are taken as two
//! of the combined G and ν, without coupling to the normal problem.

mod bound;
mod contact;
mod fields;
mod flexibility;
mod march;
mod reduction;
mod sliding;
mod strip_theory;

use crate::effects;
use crate::ellipse::{Ellipse, Prescribed};
use crate::entry::ModelEntry;
use crate::keys::CheckedParams;
use crate::models::expected::{STUDY, refinement};
use crate::models::precomputed::{self, Precomputed};
use crate::models::row_by_row::{RowByRow, Rows};
use crate::models::varying::Varying;
use crate::reference::kalker::{self, CreepCoefficients};
use crate::resolution;
use crate::scene::{GivenPatch, Scene, contact_keys, given_patch_keys};
use crate::terms::{Kind, Terms};
use bound::Bound;
use contact::{Contact, Problem};
use flexibility::Flexibilities;
use march::Lattice;
use proto::accuracy::{Accuracy, Simplification};
use proto::advice::Known;
use proto::configuration::{Configuration, Layout, Refusal};
use proto::description::{KeySpec, ModelSpec, names};
use proto::field::{self, FieldSpec};
use proto::grid::Structured;
use proto::model::{Model, Setup};
use proto::params::Params;
use proto::progress::Progress;
use reduction::Reduction;
use serde_json::Value;
use std::f64::consts::PI;

const FLEXIBILITY: &str = "mech.flexibility";
const TRACTION_BOUND: &str = "mech.traction_bound";
const STICK_ZONE: &str = "mech.stick_zone";
/// Fewest strips: the force of a contact that sticks is then exact to 1e-4.
const FEWEST_STRIPS: usize = 16;
/// Time to pass over a cell, measured [s].
const SECONDS_PER_CELL: f64 = 4e-8;
/// Passes that the creepage for a prescribed force takes, about.
const PASSES: usize = 25;

/// Its entry in the list.
pub(super) const MODEL: ModelEntry = ModelEntry {
    name: "fastsim",
    spec,
    takes: &[Kind::Adhesion, Kind::Axle, Kind::HeatShare],
    configure,
};
/// Elements per semi-axis, unless the case says otherwise.
const RESOLUTION: usize = 40;

/// The same for an estimate.
const COARSE: usize = 15;

/// What the description says of this model.
fn spec() -> ModelSpec {
    let mut keys = [contact_keys(), given_patch_keys()].concat();
    keys.extend(own_keys());
    keys.push(resolution::key(RESOLUTION));
    ModelSpec {
        name: MODEL.name.to_owned(),
        summary: "Hertz ellipse and Kalker's simplified theory (FASTSIM), all three creepages"
            .to_owned(),
        source:
            "Kalker, Vehicle System Dynamics 11 (1982) 1-13; Kalker, Three-Dimensional Elastic \
                 Bodies in Rolling Contact (1990), table E.3"
                .to_owned(),
        steady: true,
        transient: true,
        rewinds: true,
        consumes: Vec::new(),
        provides: names(&[&field::PRESSURE, &field::TRACTION, &field::SLIP_VELOCITY]),
        keys,
        accuracy: Accuracy {
            refinement: Some(refinement(2.0, 0.024)),
            simplifications: effects::of_kind(Kind::Adhesion).map(springs_for_half_space).collect(),
        },
    }
}

fn springs_for_half_space(effect: &str) -> Simplification {
    let what = "a foundation of springs stands for the elastic half-space";
    Simplification::with(effect, what, 0.4, STUDY)
}

/// The keys that no other model has.
fn own_keys() -> Vec<KeySpec> {
    let mut keys = vec![
        KeySpec::choice(
            FLEXIBILITY,
            &["single", "three", "blended"],
            "one flexibility for all creepages (exact friction power), one for each (exact slopes), or three at small \
             creepage and one at large",
        )
        .default_value("single"),
        KeySpec::choice(
            TRACTION_BOUND,
            &["parabolic", "elliptic"],
            "bound of the traction: a parabola of the same sum, or the friction coefficient times Hertz's pressure",
        )
        .default_value("parabolic"),
        KeySpec::choice(
            STICK_ZONE,
            &["springs", "strips"],
            "traction where surfaces stick: of the springs (FASTSIM), or of Kalker's strip theory under the elliptic \
             bound (FASTRIP)",
        )
        .default_value("springs"),
    ];
    keys.extend(reduction::keys());
    keys
}

/// Checks a configuration whose effects and fields this model provides; cheap, allocates no field.
///
/// # Errors
/// Refuses a case that is incomplete or out of range, bodies whose contact is no ellipse, a
/// negative Poisson's ratio, a force beyond f N, and a grid that is too large.
fn configure(configuration: &Configuration, terms: Terms) -> Result<Box<dyn Setup>, Refusal> {
    let scene = Scene::read(&configuration.case)?;
    let given = GivenPatch::read(&configuration.case)?;
    let asked = Asked::read(&configuration.case, given, terms.adhesion)?;
    let varying = Varying::of(configuration, &terms, given)?;
    let extent = match &varying {
        Some(varying) => varying.extent(given)?,
        None => Ellipse::solve(&scene, given)?.extent(),
    };
    let grid = extent.grid(asked.resolution)?;
    let (problem, coefficients) = problem(&scene, &asked, &grid)?;
    let wanted = precomputed::wanted_fields(configuration);
    let mut layout = precomputed::layout(&wanted, grid, build_seconds(&problem, wanted.len()));
    if let Some(varying) = &varying {
        layout.remarks = vec![varying.remark(&extent)];
        (layout.solve_seconds, layout.build_seconds) = (layout.build_seconds, 0.0);
    }
    layout.remarks.extend(remarks(&scene, &problem, given, &coefficients));
    layout.closed_forms = problem.ellipse.closed_forms();
    Ok(Box::new(Prepared { problem, asked, terms, varying, grid, wanted, layout }))
}

/// What a case asks for besides its scene.
#[derive(Clone, Copy, Debug)]
struct Asked {
    /// The ellipse that the case gives.
    given: Option<GivenPatch>,
    kind: flexibility::Kind,
    bound: Bound,
    /// Strip theory gives the traction that sticks.
    strip_theory: bool,
    reduction: Reduction,
    /// Elements per semi-axis.
    resolution: usize,
    /// Surfaces may stick.
    partial: bool,
}

impl Asked {
    fn read(case: &Params, given: Option<GivenPatch>, partial: bool) -> Result<Self, Refusal> {
        let own = CheckedParams::new(case, own_keys());
        let kind = match own.text(FLEXIBILITY)? {
            "three" => flexibility::Kind::Three,
            "blended" => flexibility::Kind::Blended,
            _ => flexibility::Kind::Single,
        };
        let bound = match own.text(TRACTION_BOUND)? {
            "elliptic" => Bound::Elliptic,
            _ => Bound::Parabolic,
        };
        let strip_theory = own.text(STICK_ZONE)? == "strips";
        if strip_theory && bound != Bound::Elliptic {
            let reason = "is `strips`, whose tractions are those under Hertz's pressure";
            let fix = format!("write {TRACTION_BOUND} = \"elliptic\", or \"springs\" here");
            return Err(Refusal::new(STICK_ZONE, reason, fix));
        }
        let reduction = Reduction::read(&own)?;
        let resolution = resolution::read(case, RESOLUTION)?;
        Ok(Self { given, kind, bound, strip_theory, reduction, resolution, partial })
    }
}

/// The problem of a scene, whose fields are wanted on this grid.
fn problem(
    scene: &Scene,
    asked: &Asked,
    grid: &Structured,
) -> Result<(Problem, CreepCoefficients), Refusal> {
    let Asked { given, kind, bound, strip_theory, reduction, resolution, partial } = *asked;
    let ellipse = Ellipse::solve(scene, given)?;
    Ellipse::refuse_rest(scene)?;
    let coefficients = coefficients(scene, &ellipse)?;
    let axes = [ellipse.semi_axis_a, ellipse.semi_axis_b];
    let problem = Problem {
        ellipse,
        prescribed: ellipse.prescribed(scene)?,
        flexibilities: Flexibilities::new(&coefficients, axes, scene.combined_shear_modulus()),
        kind,
        reduction,
        strip_theory: strip_theory.then(|| scene.combined_poisson_ratio()),
        // Without adhesion the springs and their bound play no part.
        lattice: lattice(&ellipse, grid, resolution, if partial { bound } else { Bound::Parabolic }),
        friction_coefficient: scene.friction_coefficient,
        speeds: scene.speeds,
        partial,
    };
    Ok((problem, coefficients))
}

/// What is the same in all rows of a history.
struct History {
    asked: Asked,
    terms: Terms,
    grid: Structured,
}

impl Rows for History {
    type Contact = Contact;

    fn compute(&self, scene: &Scene, spent: Option<Contact>) -> Result<Contact, Refusal> {
        let (problem, _) = problem(scene, &self.asked, &self.grid)?;
        let contact = problem.solve(spent);
        contact.check_power()?;
        Ok(contact)
    }

    fn work(&self, contact: &Contact) -> u64 {
        cells(&contact.problem) as u64
    }

    fn summary(&self, contact: &Contact) -> Value {
        contact.summary()
    }

    fn write(&self, contact: &Contact, spec: &FieldSpec, values: &mut [f64]) {
        fields::write(spec, contact, self.grid, &self.terms, values);
    }
}

/// The figures of the contact on a coarse grid, by their keys; `None` for a contact that is no ellipse or has no answer.
pub(super) fn estimate(scene: &Scene, case: &Params, sticks: bool) -> Option<Known> {
    let given = GivenPatch::read(case).ok()?;
    let grid = Ellipse::solve(scene, given).ok()?.extent().grid(COARSE).ok()?;
    let asked = Asked {
        given,
        kind: flexibility::Kind::Single,
        bound: Bound::Parabolic,
        strip_theory: false,
        reduction: Reduction::NONE,
        resolution: COARSE,
        partial: sticks,
    };
    let (problem, _) = problem(scene, &asked, &grid).ok()?;
    let summary = problem.solve(None).summary();
    let figures = summary["contact"].as_object()?.iter();
    let known = |(key, value): (&String, &Value)| Some((format!("contact.{key}"), value.as_f64()?));
    Some(figures.filter_map(known).collect())
}

fn coefficients(scene: &Scene, ellipse: &Ellipse) -> Result<CreepCoefficients, Refusal> {
    for (name, body) in scene.names.0.iter().zip(scene.materials()) {
        if body.poisson_ratio < 0.0 {
            let reason = format!(
                "has a Poisson's ratio of {}, and Kalker's table begins at 0",
                body.poisson_ratio
            );
            let key = format!("bodies.{name}.material");
            return Err(Refusal::new(&key, reason, "name a material whose ratio is 0 or more"));
        }
    }
    let aspect = ellipse.semi_axis_a / ellipse.semi_axis_b;
    Ok(kalker::creep_coefficients(aspect, scene.combined_poisson_ratio()))
}

/// Cells as long as an element on the longest strip, and strips half as wide as an element or less.
fn lattice(ellipse: &Ellipse, grid: &Structured, resolution: usize, bound: Bound) -> Lattice {
    let half = (PI * ellipse.semi_axis_b / grid.dy()).ceil() as usize;
    Lattice {
        semi_axis_a: ellipse.semi_axis_a,
        semi_axis_b: ellipse.semi_axis_b,
        strips: (2 * half).max(FEWEST_STRIPS),
        cells: 2 * resolution,
        bound,
    }
}

fn cells(problem: &Problem) -> usize {
    problem.lattice.strips * problem.lattice.cells
}

fn build_seconds(problem: &Problem, fields: usize) -> f64 {
    let passes = match problem.prescribed {
        Prescribed::ForceRatio(_) => PASSES,
        Prescribed::Creepage { .. } => 1,
    };
    SECONDS_PER_CELL * (cells(problem) * (passes + fields)) as f64
}

fn remarks(
    scene: &Scene,
    problem: &Problem,
    given: Option<GivenPatch>,
    coefficients: &CreepCoefficients,
) -> Vec<String> {
    let ellipse = &problem.ellipse;
    let CreepCoefficients { c11, c22, c23, .. } = coefficients;
    let mut remarks =
        vec![format!("{ellipse}; Kalker's C11 = {c11:.3}, C22 = {c22:.3}, C23 = {c23:.3}")];
    remarks.extend(given.and_then(|_| ellipse.remark(scene)));
    let [upper, lower] = scene.materials();
    if upper != lower {
        remarks.push(
            "the bodies are of different materials: the simplified theory leaves out that \
             their pressure then makes slip"
                .to_owned(),
        );
    }
    if !problem.partial && matches!(problem.prescribed, Prescribed::ForceRatio(_)) {
        remarks.push(format!(
            "{}the whole contact slides: it carries {:.6e} N, f N, and not the prescribed force, \
             for which the simplified theory sets the creepage",
            effects::without(Kind::Adhesion),
            problem.friction_coefficient * ellipse.normal_force
        ));
    }
    remarks
}

/// A checked case.
struct Prepared {
    problem: Problem,
    asked: Asked,
    terms: Terms,
    /// The values that vary, if any do.
    varying: Option<Varying>,
    grid: Structured,
    wanted: Vec<&'static FieldSpec>,
    layout: Layout,
}

impl Setup for Prepared {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn build(self: Box<Self>, _progress: &Progress) -> Result<Box<dyn Model>, Refusal> {
        let Self { problem, asked, terms, varying, grid, wanted, .. } = *self;
        if let Some(varying) = varying {
            let history = History { asked, terms, grid };
            return Ok(Box::new(RowByRow::new(history, varying, wanted)));
        }
        let contact = problem.solve(None);
        contact.check_power()?;
        let values = |spec: &&'static FieldSpec| {
            let mut values = vec![0.0; precomputed::count(spec, &grid)];
            fields::write(spec, &contact, grid, &terms, &mut values);
            (*spec, values)
        };
        Ok(Box::new(Precomputed {
            summary: contact.summary(),
            work: cells(&problem) as u64,
            fields: wanted.iter().map(values).collect(),
        }))
    }
}
