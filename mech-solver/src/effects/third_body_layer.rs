//! Effect `third_body_layer`: a thin layer between the surfaces that yields to traction.
//!
//! The layer adds the displacement difference L p_t, with its tangential flexibility L [m/Pa], to
//! that of the bodies. It lowers the initial slope of the creep curve and leaves its limit f N.
//!
//! Source: Vollebregt, *Numerical modeling of measured railway creep versus creep-force curves*,
//! Wear 314 (2014) 87–95; Kalker (1990) §4.

use crate::keys::CheckedParams;
use crate::models::names::HALF_SPACE;
use proto::configuration::{Configuration, Refusal};
use proto::description::{EffectSpec, KeySpec};

/// Name in the case file.
pub const NAME: &str = "third_body_layer";

const FLEXIBILITY: &str = "effects.third_body_layer.flexibility";

fn flexibility_key() -> KeySpec {
    KeySpec::quantity(FLEXIBILITY, "m/Pa", "tangential flexibility L of the layer")
        .required()
        .above(0.0)
}

/// What the description says of this effect.
#[must_use]
pub fn spec() -> EffectSpec {
    EffectSpec {
        name: NAME.to_owned(),
        law: "displacement difference u_t + L p_t, with the layer's flexibility L".to_owned(),
        source: "Vollebregt, Wear 314 (2014) 87-95; Kalker, Three-Dimensional Elastic Bodies in \
                 Rolling Contact (1990)"
            .to_owned(),
        models: vec![HALF_SPACE.to_owned()],
        consumes: Vec::new(),
        provides: Vec::new(),
        keys: vec![flexibility_key()],
    }
}

/// The layer's flexibility [m/Pa]; 0 when the effect is off.
///
/// # Errors
/// The effect is on and the value is missing or out of range.
pub(crate) fn flexibility(configuration: &Configuration) -> Result<f64, Refusal> {
    if !configuration.has_effect(NAME) {
        return Ok(0.0);
    }
    CheckedParams::new(&configuration.case, vec![flexibility_key()]).number(FLEXIBILITY)
}
