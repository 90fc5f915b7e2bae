//! Contact mechanics of two bodies as a participant of the co-simulation.
//!
//! | module | what |
//! |---|---|
//! | `noise` | how far the points of measured profiles scatter |
//! | [`models`] | the models by name, one module a fidelity level |
//! | [`effects`] | the effects by name, one file an effect |
//! | [`half_space`], [`conformal`] | boundary elements: normal, tangential and subsurface problems of half-spaces, and of curved surfaces |
//! | [`explicit`] | explicit finite elements of rolling bodies |
//! | [`friction`] | the law of friction: factors on the coefficient, bounds of the traction |
//! | [`axle`] | what carries the load, and runs over irregularities |
//! | `carried` | the load under an axle, for models whose contact has no inertia |
//! | `removal` | what a contact takes off the bodies, and the profiles that it leaves |
//! | [`terms`] | what effects contribute to a contact, kind by kind |
//! | [`reference`] | closed forms, shared by models, tests and reports |
//! | [`scene`] | the case values every model reads, as plain structs |
//! | [`simplified`] | springs in the place of half-spaces: FASTSIM and FASTRIP, strip by strip |
//! | [`track`] | a wheel on the rail of a track: profiles, placement, patches, creepages, their contact |
//!
//! Axes, bodies and signs (Kalker's, as CONTACT has them): x along the rolling direction, y to the
//! left, z up; the origin is the centre of the undeformed contact and moves with it. Material
//! enters at x = +a and leaves at x = −a. Body 1 is the upper one, body 2 the lower one. Tractions and
//! forces act on the upper body, slip and creepage are of the upper body relative to the lower one: an upper
//! body that drives has a creepage ξ < 0 and a creep force F_x > 0, and the friction power −p·v is never
//! negative.
//!
//! Adding an effect takes its file under `effects/` and one line in [`effects::EFFECTS`]; adding a
//! model likewise under `models/` and in [`models::MODELS`].

mod advice;
mod bands;
mod carried;
mod curve;
mod difference;
pub mod effects;
mod ellipse;
pub mod entry;
mod figures;
pub mod friction;
mod keys;
mod measures;
pub mod models;
mod noise;
mod removal;
mod resolution;
pub mod scene;
mod situation;
mod softening;
mod state;
mod support;
mod surface;
pub mod terms;
mod thermal_stress;

use effects::EFFECTS;
use entry::Effect;
use proto::advice::{Opinion, Scene};
use proto::configuration::{Configuration, Refusal};
use proto::description::{Description, names};
use proto::model::{Setup, Solver};

/// The mechanics program: every model and every effect of this crate.
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
            models: models::MODELS.iter().map(|model| (model.spec)()).collect(),
            effects: EFFECTS.iter().map(|effect| effect.spec(support::models_of(effect))).collect(),
            keys: scene::body_keys(),
            fields: Vec::new(),
            figures: [figures::figures(), models::own_figures()].concat(),
            diagrams: models::diagrams(),
            renamed: scene::renamed(),
        }
    }

    /// # Errors
    /// Refuses an unknown model, an effect that the model does not support, a field that neither
    /// the model nor an active effect provides, and what the model itself refuses.
    fn configure(&self, configuration: &Configuration) -> Result<Box<dyn Setup>, Refusal> {
        numerics::team::limit(configuration.threads);
        let model = models::find(&configuration.model)?;
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
