//! Heat conduction into the upper and the lower body under a moving frictional contact.
//!
//! | module | what |
//! |---|---|
//! | [`models`] | the models, cheapest first, and their registry list |
//! | [`heat`] | the numerics, a crate of their own |
//! | [`capability`], `support` | what effects may need of a model; which model supports which effect |
//! | [`situation`], [`advice`] | what is known of a scene before it is run, and what effects say of themselves with it |
//! | [`effects`] | the effects this participant takes part in, one file an effect, and their list |
//! | [`scene`] | what is read from the case: materials and speed |
//!
//! Conventions: x is the rolling direction, y to the left, z up, origin at the centre of the
//! contact, and the frame moves with it. Material enters the contact at its leading edge (large x)
//! and moves towards −x at the surface speed. Temperatures are rises over the initial one [K]; a
//! heat flux into a body is positive. Pairs of values are ordered upper, lower.

pub mod advice;
pub mod capability;
pub mod effects;
mod figures;
pub mod models;
pub mod scene;
pub mod situation;
mod support;

pub use proto::bodies::{LOWER, UPPER};

use proto::PROTOCOL_VERSION;
use proto::advice::{Opinion, Scene};
use proto::configuration::{Configuration, Refusal};
use proto::description::Description;
use proto::model::{Setup, Solver};

/// The thermal participant's program: models and effects of the registry lists.
#[derive(Clone, Copy, Debug, Default)]
pub struct ThermalSolver;

impl Solver for ThermalSolver {
    fn description(&self) -> Description {
        Description {
            protocol: PROTOCOL_VERSION,
            name: "thermal-solver".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            role: "thermal".to_owned(),
            standalone: false,
            estimates: true,
            advises: true,
            reusable: true,
            models: models::REGISTRY.iter().map(|model| (model.spec)()).collect(),
            effects: effects::REGISTRY.iter().map(support::description).collect(),
            keys: scene::keys(),
            fields: effects::volume_temperature::VOLUMES.map(|field| field.kind()).to_vec(),
            figures: figures::figures(),
            diagrams: Vec::new(),
            renamed: effects::renamed(),
        }
    }

    fn configure(&self, configuration: &Configuration) -> Result<Box<dyn Setup>, Refusal> {
        let model = models::find(&configuration.model)?;
        support::refuse_needs(configuration, model)?;
        (model.configure)(configuration)
    }

    fn advise(&self, scene: &Scene) -> Opinion {
        advice::opinion(scene)
    }
}
