//! Effect `third_body_layer`: a thin layer between the surfaces that yields to traction.
//!
//! The layer adds the displacement difference L p_t, with its tangential flexibility L [m/Pa], to
//! that of the bodies. It lowers the initial slope of the creep curve and leaves its limit f N.
//!
//! Source: Vollebregt, *Numerical modeling of measured railway creep versus creep-force curves*,
//! Wear 314 (2014) 87–95; Kalker (1990) §4.

use crate::entry::Effect;
use crate::keys::CheckedParams;
use crate::terms::{Kind, Terms};
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;

/// What the registry says of it.
pub const EFFECT: Effect = Effect {
    name: "third_body_layer",
    law: "displacement difference u_t + L p_t, with the layer's flexibility L",
    source: "Vollebregt, Wear 314 (2014) 87-95; Kalker, Three-Dimensional Elastic Bodies in \
             Rolling Contact (1990)",
    kinds: &[Kind::Layer],
    consumes: &[],
    provides: &[],
    keys,
    figures: Vec::new,
    terms,
};

const FLEXIBILITY: &str = "effects.third_body_layer.flexibility";

fn keys() -> Vec<KeySpec> {
    vec![
        KeySpec::quantity(FLEXIBILITY, "m/Pa", "tangential flexibility L of the layer")
            .required()
            .above(0.0),
    ]
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let case = CheckedParams::new(&configuration.case, keys());
    Ok(Terms { layers: vec![case.number(FLEXIBILITY)?], ..Terms::default() })
}
