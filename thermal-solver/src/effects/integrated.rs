//! Rise of each body integrated over its depth, which effects of the mechanics need
//! ([`heat::moving_source::rise_integral`]).

use crate::models::fields::RISE_INTEGRALS;
use crate::scene::Scene;
use proto::configuration::{Configuration, Mode, Refusal};
use proto::description::{EffectSpec, names as field_names};

/// Name of the effect of thermal expansion.
pub const EXPANSION: &str = "thermal_expansion";
/// Name of the effect of thermal softening.
pub const SOFTENING: &str = "thermal_softening";

/// Returns the thermal participant's part of an effect that needs the integrated rise.
#[must_use]
pub fn spec(name: &str) -> EffectSpec {
    EffectSpec {
        figures: Vec::new(),
        name: name.to_owned(),
        law: "W(k) = int T(k, z) exp(-k z) dz, of each body".to_owned(),
        source: "Barber, Elasticity (2010), thermoelastic displacement potentials".to_owned(),
        models: Vec::new(),
        consumes: Vec::new(),
        provides: field_names(&[RISE_INTEGRALS[1], RISE_INTEGRALS[0]]),
        keys: Vec::new(),
    }
}

/// Returns the first such effect of a configuration.
#[must_use]
pub fn active(given: &Configuration) -> Option<&'static str> {
    [EXPANSION, SOFTENING].into_iter().find(|effect| given.has_effect(effect))
}

/// Refuses a steady case with a stationary body, whose heated depth grows without limit.
///
/// # Errors
/// A stationary body in a steady case.
pub fn refuse_rest(scene: &Scene, mode: Mode, effect: &str) -> Result<(), Refusal> {
    let Some(body) = (0..2).find(|body| scene.at_rest[*body] && mode == Mode::Steady) else {
        return Ok(());
    };
    Err(Refusal::new(
        &scene.names.key(body, "surface_speed"),
        format!(
            "`{}` is at rest: it is heated without end, and its surface has no steady height",
            scene.names.0[body]
        ),
        format!("write time.mode = \"transient\", a speed above 0 m/s, or remove effects.{effect}"),
    ))
}
