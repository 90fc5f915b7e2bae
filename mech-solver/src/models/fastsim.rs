//! Model `fastsim`: Kalker's simplified theory on Hertz's ellipse.
//!
//! Normal contact: [`elastic::hertz`], or the ellipse that the case gives under `[contact]`.
//!
//! Tangential contact, for longitudinal, lateral and spin creepage: the surfaces are beds of
//! springs whose flexibility follows from Kalker's linear theory ([`elastic::kalker`]). Coulomb's
//! law holds with the bound f · 2N/(π a b) · (1 − x²/a² − y²/b²), or with f times Hertz's pressure.
//! The parabolic bound is used for the traction only: under it the springs can stick up to the
//! leading edge. It reaches 4/3 of f times Hertz's pressure in the middle, while the field
//! `pressure` is always Hertz's. In the stick zone strip theory may replace the springs (FASTRIP).
//! Without terms of adhesion the whole contact slides, with f times Hertz's pressure.
//!
//! A prescribed longitudinal force is met by ξ alone, with η = φ = 0. The force increases
//! monotonically with |ξ|, from 0 to f N at a finite creepage.
//!
//! | module | contents |
//! |---|---|
//! | [`elastic::fastsim`] | the springs, the bound, the march along a strip, strip theory |
//! | `sliding` | the contact without a stick zone |
//! | `contact` | prescribed force, sums over the contact |
//! | `fields` | element means on the contact's grid |
//! | `case` | options of a case |
//! | `limits` | friction bounds of the elements |
//! | `windows` | values that vary; friction that depends on slip, inputs or a traction bound |
//!
//! The model is quasi-static; only its friction may have a history. It is computed once, when the
//! model is built, or in every iteration if friction is not constant.
//!
//! Source: J. J. Kalker, A fast algorithm for the simplified theory of rolling contact, Vehicle
//! System Dynamics 11 (1982) 1–13. Deviations: the strips are narrower towards the sides. A cell's
//! traction is the mean of its two ends, which keeps the energy balance. The default is one
//! flexibility for all creepages, averaged differently than in that paper, see `flexibility`.
//! Friction may vary from element to element, see `limits`. Bodies of different materials are
//! treated as two bodies with the combined G and ν, without coupling to the normal problem.

mod case;
mod contact;
mod fields;
mod limits;
mod sliding;
mod windows;

use crate::case::ellipse::{Ellipse, Prescribed};
use crate::case::resolution;
use crate::case::scene::{GivenPatch, Scene, contact_keys, given_patch_keys};
use crate::effects;
use crate::models::contact_model::ContactModel;
use crate::models::expected::{STUDY, refinement};
use crate::models::precomputed::{self, Precomputed};
use crate::models::varying::{Scenes, Varying};
use crate::registry::entry::ModelEntry;
use crate::terms::{Kind, Terms};
use case::{Case, Options, RESOLUTION, cells, own_keys, problem};
use contact::Problem;
use elastic::fastsim::bound::Bound;
use elastic::fastsim::flexibility::Kind as Flexibility;
use elastic::fastsim::reduction::Reduction;
use elastic::kalker::CreepCoefficients;
use proto::accuracy::{Accuracy, Simplification};
use proto::advice::Known;
use proto::configuration::{Configuration, Refusal};
use proto::description::{ModelSpec, names};
use proto::field;
use proto::model::Setup;
use proto::params::Params;
use proto::readable::quantity;
use serde_json::Value;
use windows::Windows;

/// Time per cell and pass, measured [s].
const SECONDS_PER_CELL: f64 = 4e-8;
/// Approximate number of passes to find the creepage of a prescribed force.
const PASSES: usize = 25;

/// Registry entry of this model.
pub(super) const MODEL: ModelEntry = ModelEntry {
    name: "fastsim",
    spec,
    takes: &[
        Kind::FrictionFactor,
        Kind::TractionBound,
        Kind::Adhesion,
        Kind::Axle,
        Kind::HeatShare,
    ],
    configure,
};
/// Elements per semi-axis for an estimate.
const COARSE: usize = 15;

/// Description of this model: keys, fields and accuracy.
fn spec() -> ModelSpec {
    let mut keys = [contact_keys(), given_patch_keys()].concat();
    keys.extend(own_keys());
    keys.push(resolution::key(RESOLUTION));
    ModelSpec {
        name: MODEL.name.to_owned(),
        summary: "Hertz ellipse and Kalker's simplified theory (FASTSIM, FASTRIP), all three creepages"
            .to_owned(),
        source:
            "Kalker, Vehicle System Dynamics 11 (1982) 1-13; Kalker, Three-Dimensional Elastic \
                 Bodies in Rolling Contact (1990), table E.3; Sichani, Enblom, Berg, Vehicle System Dynamics 54 \
                 (2016) 748-764"
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
        accuracy: Accuracy {
            refinement: Some(refinement(1.9, 0.01)),
            simplifications: effects::of_kind(Kind::Adhesion).map(springs_for_half_space).collect(),
        },
    }
}

fn springs_for_half_space(effect: &str) -> Simplification {
    let what = "a foundation of springs replaces the elastic half-space";
    Simplification::with(effect, what, 0.4, STUDY)
}

/// Checks a configuration whose effects and fields this model provides, without allocating fields.
///
/// # Errors
/// A case that is incomplete or out of range; bodies whose contact is not an ellipse; a negative
/// Poisson's ratio; a force beyond f N; a grid that is too large.
fn configure(configuration: &Configuration, terms: Terms) -> Result<Setup, Refusal> {
    let scene = Scene::read(&configuration.case)?;
    let given = GivenPatch::read(&configuration.case)?;
    let asked = Options::read(&configuration.case, given, terms.adhesion)?;
    let varying = Varying::of(configuration, &terms, given)?;
    let extent = match &varying {
        Some(varying) => varying.extent(given)?,
        None => Ellipse::solve(&scene, given)?.extent(),
    };
    let grid = extent.grid(asked.resolution)?;
    let (problem, coefficients) = problem(&scene, &asked, &grid)?;
    let wanted = precomputed::wanted_fields(configuration);
    let mut layout =
        precomputed::layout(configuration, grid, build_seconds(&problem, wanted.len()));
    if let Some(varying) = &varying {
        layout.remarks = vec![varying.remark(&extent)];
        (layout.solve_seconds, layout.build_seconds) = (layout.build_seconds, 0.0);
    }
    if terms.friction_effect().is_some() {
        layout.remarks.push("the contact is computed in every iteration".to_owned());
        layout.solve_seconds = layout.solve_seconds.max(layout.build_seconds);
    }
    layout.remarks.extend(remarks(&scene, &problem, given, &coefficients));
    layout.closed_forms = problem.ellipse.closed_forms();
    let case = Case { asked, terms, grid };
    Ok(Setup::new(layout, move |_| {
        if varying.is_some() || !case.terms.friction.is_constant() {
            let windows = Windows::new(case, Scenes::new(scene, varying));
            return Ok(Box::new(ContactModel::new(windows)));
        }
        let Case { terms, grid, .. } = case;
        let contact = problem.solve(None);
        contact.check_power()?;
        let fields = precomputed::fields(&wanted, &grid, |spec, values| {
            fields::write(spec, &contact, grid, &terms, values);
        });
        let (summary, work) = (contact.summary(grid.dx()), cells(&problem) as u64);
        Ok(Precomputed { summary, work, fields, terms }.model())
    }))
}

/// Figures of the contact on a coarse grid, by their keys, with tractions of at most `largest`
/// [Pa]; `None` for a contact that is not elliptic or has no solution.
pub(super) fn estimate(
    scene: &Scene,
    case: &Params,
    sticks: bool,
    largest: Option<f64>,
) -> Option<Known> {
    let given = GivenPatch::read(case).ok()?;
    let grid = Ellipse::solve(scene, given).ok()?.extent().grid(COARSE).ok()?;
    let asked = Options {
        given,
        kind: Flexibility::Single,
        // A cut-off refers to the traction bound of Hertz's pressure.
        bound: if largest.is_some() { Bound::Elliptic } else { Bound::Parabolic },
        strip_theory: false,
        reduction: Reduction::NONE,
        resolution: COARSE,
        partial: sticks,
    };
    let (problem, _) = problem(scene, &asked, &grid).ok()?;
    let contact = match largest {
        Some(largest) => problem.solve_cut_off(largest)?,
        None => problem.solve(None),
    };
    let summary = contact.summary(grid.dx());
    let figures = summary["contact"].as_object()?.iter();
    let known = |(key, value): (&String, &Value)| Some((format!("contact.{key}"), value.as_f64()?));
    Some(figures.filter_map(known).collect())
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
            "the bodies have different materials: the simplified theory neglects the \
             slip caused by their pressure"
                .to_owned(),
        );
    }
    if !problem.partial && matches!(problem.prescribed, Prescribed::ForceRatio(_)) {
        remarks.push(format!(
            "{}the whole contact slides: it carries f N = {} instead of the prescribed force, \
             from which the simplified theory takes the creepage",
            effects::without(Kind::Adhesion),
            quantity(problem.friction_coefficient * ellipse.normal_force, "N", 7)
        ));
    }
    remarks
}
