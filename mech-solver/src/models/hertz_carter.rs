//! Model `hertz-carter`: Hertz's ellipse and Carter's strips, in closed form.
//!
//! Normal contact: [`elastic::hertz`], or the ellipse that the case gives under `[contact]`.
//!
//! Tangential contact, longitudinal creepage or force only. With terms of adhesion, Carter's strips
//! ([`elastic::carter`]) with one of the creep laws `carter-radius` and `carter-pressure`. Without
//! adhesion the whole contact slides, with the traction f p_n and the same slip V s everywhere.
//! Here s is the prescribed creepage, or the creepage that the creep law gives at the prescribed
//! force, as used by Naeimi et al. and Ertz & Knothe.
//!
//! Fields are element means, see `strips`. The model is quasi-static and has no history: its answer
//! is the same in every window of a transient case. It is computed once, when the model is built,
//! and a solve copies it to the requested outputs. If friction depends on inputs, on slip, or on a
//! traction bound, one equivalent coefficient is computed in every iteration (`windows`).
//!
//! Deviations from the sources: the strips of an elliptic patch share one prefactor A and take ξ
//! from their own half length, so that the friction power is V s F in every strip.

mod case;
mod contact;
mod fields;
mod windows;

use crate::case::ellipse::Ellipse;
use crate::case::keys::CheckedParams;
use crate::case::resolution;
use crate::case::scene::{Drive, GivenPatch, Scene, contact_keys, given_patch_keys, width_key};
use crate::effects;
use crate::models::contact_model::ContactModel;
use crate::models::expected::{STUDY, refinement};
use crate::models::precomputed::{self, Precomputed};
use crate::models::varying::{Scenes, Varying};
use crate::registry::entry::ModelEntry;
use crate::terms::{Kind, Terms};
use case::Case;
use contact::{CarterContact, CreepLaw};
use proto::accuracy::{Accuracy, Simplification};
use proto::configuration::{Configuration, Refusal};
use proto::description::{KeySpec, ModelSpec, names};
use proto::field;
use proto::model::Setup;
use proto::readable::quantity;
use windows::Windows;

const CREEP_LAW: &str = "motion.creep_law";
/// Time per value, measured [s].
const SECONDS_PER_VALUE: f64 = 7e-8;

/// Registry entry of this model.
pub(super) const MODEL: ModelEntry = ModelEntry {
    name: "hertz-carter",
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
/// Default number of elements per semi-axis.
const RESOLUTION: usize = 40;

/// Description of this model: keys, fields and accuracy.
fn spec() -> ModelSpec {
    let mut keys = [contact_keys(), given_patch_keys()].concat();
    keys.push(width_key());
    keys.push(creep_law_key());
    keys.push(resolution::key(RESOLUTION));
    ModelSpec {
        name: MODEL.name.to_owned(),
        summary: "Hertz ellipse and Carter strips in closed form, longitudinal creepage only"
            .to_owned(),
        source:
            "Johnson, Contact Mechanics (1985) ch. 4; Carter, Proc. R. Soc. Lond. A 112 (1926) \
                 151-157; Naeimi et al., eqs. 18-19"
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
            refinement: Some(refinement(2.0, 0.00125)),
            simplifications: effects::of_kind(Kind::Adhesion).map(strips_for_half_space).collect(),
        },
    }
}

fn strips_for_half_space(effect: &str) -> Simplification {
    let what = "Carter's line contact in strips replaces the elastic half-space";
    Simplification::with(effect, what, 0.55, STUDY)
}

fn creep_law_key() -> KeySpec {
    KeySpec::choice(
        CREEP_LAW,
        &["carter-radius", "carter-pressure"],
        "prefactor of the creep: f a/R or 2 f p_0 E*",
    )
    .default_value("carter-pressure")
}

/// Checks a configuration whose effects and fields this model provides, without allocating fields.
///
/// # Errors
/// A case that is incomplete or out of range; lateral creepage or spin; bodies whose contact is not
/// an ellipse; a force beyond f N; a grid that is too large.
fn configure(configuration: &Configuration, terms: Terms) -> Result<Setup, Refusal> {
    let scene = Scene::read(&configuration.case)?;
    let given = GivenPatch::read(&configuration.case)?;
    let case = CheckedParams::new(&configuration.case, vec![creep_law_key()]);
    let law = match case.text(CREEP_LAW)? {
        "carter-radius" => CreepLaw::Radius,
        _ => CreepLaw::Pressure,
    };
    let partial = terms.adhesion;
    let resolution = resolution::read(&configuration.case, RESOLUTION)?;
    Ellipse::refuse_rest(&scene)?;
    let contact = CarterContact::solve(&scene, Ellipse::solve(&scene, given)?, law, partial)?;
    let varying = Varying::of(configuration, &terms, given)?;
    let extent = varying.as_ref().map(|varying| varying.extent(given)).transpose()?;
    let grid = extent.unwrap_or(contact.ellipse.extent()).grid(resolution)?;
    let wanted = precomputed::wanted_fields(configuration);
    let values: usize = wanted.iter().map(|spec| precomputed::count(spec, &grid)).sum();
    let mut layout = precomputed::layout(configuration, grid, SECONDS_PER_VALUE * values as f64);
    if terms.friction_effect().is_some() {
        layout.remarks = vec!["the fields are computed in every iteration".to_owned()];
    }
    if let (Some(varying), Some(extent)) = (&varying, &extent) {
        layout.remarks = vec![varying.remark(extent)];
        (layout.solve_seconds, layout.build_seconds) = (layout.build_seconds, 0.0);
    }
    layout.remarks.extend(remarks(&scene, &contact, given, partial));
    if let Some(effect) = terms.effect_of(Kind::TractionBound) {
        layout.remarks.push(format!(
            "effects.{effect} enters as one friction coefficient with which the whole sliding contact carries the same force: tractions \
             in the middle of the contact exceed its bound (half-space and fastsim apply it element by element)"
        ));
    }
    layout.closed_forms = contact.ellipse.closed_forms();
    let case = Case { given, law, terms, grid };
    Ok(Setup::new(layout, move |_| {
        if varying.is_some() || !case.terms.friction.is_constant() {
            let windows = Windows::new(case, Scenes::new(scene, varying));
            return Ok(Box::new(ContactModel::new(windows)));
        }
        let Case { terms, grid, .. } = case;
        let fields = precomputed::fields(&wanted, &grid, |spec, values| {
            fields::write(spec, &contact, grid, &terms, values);
        });
        let (summary, work) = (contact.summary(grid.dx()), grid.points() as u64);
        Ok(Precomputed { summary, work, fields, terms }.model())
    }))
}

fn remarks(
    scene: &Scene,
    contact: &CarterContact,
    given: Option<GivenPatch>,
    partial: bool,
) -> Vec<String> {
    let mut remarks = vec![contact.to_string()];
    remarks.extend(given.and_then(|_| contact.ellipse.remark(scene)));
    if !partial && !matches!(scene.drive, Drive::Creepage { .. }) {
        remarks.push(format!(
            "{}the whole contact slides: it carries f N = {} instead of the prescribed force, \
             from which the creep law takes the creepage",
            effects::without(Kind::Adhesion),
            quantity(contact.creep_force(), "N", 7)
        ));
    }
    remarks
}
