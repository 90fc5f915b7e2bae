//! Contact mechanics of two bodies as a participant of the co-simulation.
//!
//! | module | contents |
//! |---|---|
//! | [`models`] | the models by name, one module for each fidelity |
//! | [`effects`] | the effects by name, one file for each effect |
//! | [`terms`] | contributions of effects to a contact, by kind |
//! | `case` | case values: bodies, motion, load, resolution, tables; the contact ellipse |
//! | `registry` | entries of the lists of models and effects; support of effects by models |
//! | `figures` | quantities of the summary, and indicators of the validity of a model |
//! | `advice` | estimates, before a run, of the influence of each effect |
//!
//! The numerics are separate crates: [`elastic`], [`half_space`], [`explicit_fe`], [`wheel_rail`].
//!
//! Axes, bodies and signs follow Kalker and CONTACT: x along the rolling direction, y to the left,
//! z up. The origin is the centre of the undeformed contact and moves with it. Material enters at
//! x = +a and leaves at x = −a. Body 1 is the upper one, body 2 the lower one. Tractions and forces
//! act on the upper body; slip and creepage are those of the upper body relative to the lower one.
//! A driving upper body has a creepage ξ < 0 and a creep force F_x > 0, and the friction power −p·v
//! is never negative.
//!
//! A new effect is a file under `effects/` and one line in [`effects::EFFECTS`]. A new model is a
//! module under `models/` and one line in [`models::MODELS`].

#![forbid(unsafe_code)]

mod advice;
pub mod case;
pub mod effects;
mod figures;
pub mod models;
pub mod registry;
pub mod terms;

use effects::EFFECTS;
use proto::advice::{Opinion, Scene};
use proto::configuration::{Configuration, Refusal};
use proto::description::{Description, names};
use proto::model::{Setup, Solver};
use registry::entry::Effect;
use registry::support;

/// Mechanics solver with every model and every effect of this crate.
#[derive(Clone, Copy, Debug, Default)]
pub struct MechSolver;

impl Solver for MechSolver {
    fn description(&self) -> Description {
        Description {
            protocol: proto::PROTOCOL_VERSION,
            name: "mech-solver".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            role: "mech".to_owned(),
            standalone: true,
            estimates: true,
            advises: true,
            reusable: true,
            build: None,
            models: models::MODELS.iter().map(|model| (model.spec)()).collect(),
            effects: EFFECTS.iter().map(|effect| effect.spec(support::models_of(effect))).collect(),
            keys: case::scene::body_keys(),
            fields: Vec::new(),
            figures: [figures::figures(), models::own_figures()].concat(),
            diagrams: models::diagrams(),
            renamed: case::scene::renamed(),
        }
    }

    /// # Errors
    /// An unknown model; an effect that the model does not support; a field that neither the model
    /// nor an active effect provides; a value that the model refuses.
    fn configure(&self, configuration: &Configuration) -> Result<Setup, Refusal> {
        numerics::team::limit(configuration.threads);
        let model = models::find(&configuration.model)?;
        models::varying::refuse_standstill(configuration)?;
        let active = support::active(configuration)?;
        let mut provided = (model.spec)().provides;
        provided.extend(active.iter().flat_map(|effect| names(effect.provides)));
        for field in configuration.outputs.iter().chain(&configuration.observed) {
            if !provided.contains(field) {
                return Err(not_provided(field, &configuration.model));
            }
        }
        let terms = effects::terms(&active, configuration)?;
        support::refuse_needs(model, &terms)?;
        (model.configure)(configuration, terms)
    }

    fn advise(&self, scene: &Scene) -> Opinion {
        advice::opinion(scene)
    }
}

fn not_provided(field: &str, model: &str) -> Refusal {
    let provides = |effect: &&Effect| effect.provides.iter().any(|spec| spec.name == field);
    match EFFECTS.iter().find(provides) {
        Some(effect) => Refusal::new(
            &format!("effects.{}", effect.name),
            format!("the field `{field}` is requested, but the effect that provides it is off"),
            format!("add the table [effects.{}]", effect.name),
        ),
        None => Refusal::new(
            "mech.model",
            format!("`{model}` does not provide the field `{field}`"),
            "do not request this field",
        ),
    }
}
