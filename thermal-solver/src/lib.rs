//! Heat conduction into the upper and the lower body under a moving frictional contact.
//!
//! | module | contents |
//! |---|---|
//! | [`models`] | the models and their registry list |
//! | [`heat`] | the numerics, a separate crate |
//! | [`capability`], `support` | optional capabilities of models, and those that effects need |
//! | [`situation`], [`advice`] | estimates for a scene before it is run; advice of the effects |
//! | [`effects`] | the effects that involve this participant, and their registry list |
//! | [`scene`] | materials and speeds read from the case |
//!
//! Conventions: x is the rolling direction, y to the left, z up. The origin is the centre of the
//! contact, and the frame moves with it. Material enters the contact at its leading edge (large x)
//! and moves towards −x at the surface speed. Temperatures are rises above the initial one [K]; a
//! heat flux into a body is positive. Pairs of values are ordered upper, lower.

#![forbid(unsafe_code)]

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

/// Program of the thermal participant: models and effects of the registry lists.
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
            build: None,
            models: models::REGISTRY.iter().map(|model| (model.spec)()).collect(),
            effects: effects::REGISTRY.iter().map(support::description).collect(),
            keys: scene::keys(),
            fields: effects::volume_temperature::VOLUMES.map(|field| field.kind()).to_vec(),
            figures: figures::figures(),
            diagrams: Vec::new(),
            renamed: effects::renamed(),
        }
    }

    fn configure(&self, configuration: &Configuration) -> Result<Setup, Refusal> {
        let model = models::find(&configuration.model)?;
        support::refuse_needs(configuration, model)?;
        (model.configure)(configuration)
    }

    fn advise(&self, scene: &Scene) -> Opinion {
        advice::opinion(scene)
    }
}
