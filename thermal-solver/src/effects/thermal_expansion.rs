//! Effect `thermal_expansion`: what is warm expands, and the surface rises.
//!
//! Here what the mechanics need for it is provided: the rise of each body integrated over its depth
//! ([`crate::moving_source::rise_integral`]).

use crate::models::fields::RISE_INTEGRALS;
use crate::models::names;
use crate::scene::Scene;
use proto::configuration::{Mode, Refusal};
use proto::description::{EffectSpec, names as field_names};

/// Name in the case file.
pub const NAME: &str = "thermal_expansion";

/// The thermal participant's part of the effect.
#[must_use]
pub fn spec() -> EffectSpec {
    EffectSpec {
        figures: Vec::new(),
        name: NAME.to_owned(),
        law: "W(k) = int T(k, z) exp(-k z) dz, of each body".to_owned(),
        source: "Barber, Elasticity (2010), thermoelastic displacement potentials".to_owned(),
        models: vec![names::COLUMNS.to_owned(), names::MOVING_SOURCE.to_owned()],
        consumes: Vec::new(),
        provides: field_names(&[RISE_INTEGRALS[1], RISE_INTEGRALS[0]]),
        keys: Vec::new(),
    }
}

/// Refuses a steady case with a body at rest, whose surface rises without end.
///
/// # Errors
/// There is one.
pub fn refuse_rest(scene: &Scene, mode: Mode) -> Result<(), Refusal> {
    let Some(body) = (0..2).find(|body| scene.at_rest[*body] && mode == Mode::Steady) else {
        return Ok(());
    };
    Err(Refusal::new(
        &scene.names.key(body, "surface_speed"),
        format!(
            "`{}` is at rest: it is heated without end, and its surface has no steady height",
            scene.names.0[body]
        ),
        "write time.mode = \"transient\", a speed above 0 m/s, or remove effects.thermal_expansion",
    ))
}
