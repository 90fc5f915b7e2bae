//! Effect `third_body_layer`: a thin layer between the surfaces with a tangential flexibility.
//!
//! The layer adds the displacement difference L p_t, with its tangential flexibility L [m/Pa], to
//! that of the bodies. It reduces the initial slope of the creep curve and leaves its limit f N
//! unchanged.
//!
//! Source: Vollebregt, *Numerical modeling of measured railway creep versus creep-force curves*,
//! Wear 314 (2014) 87–95; Kalker (1990) §4.

use crate::advice::situation::{CREEPAGE, POWER, Situation};
use crate::case::keys::CheckedParams;
use crate::case::scene::Drive;
use crate::registry::entry::Effect;
use crate::terms::{Kind, Terms};
use elastic::kalker;
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::figure::contact::{SEMI_AXIS_A, SEMI_AXIS_B, SLIP_AREA_RATIO};

/// Registry entry of the effect.
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
    advise: Some(advise),
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

/// Flexibility that gives half-spaces the creepages of the paper, used if the case has none [m/Pa].
const TYPICAL: f64 = 2e-14;

/// Estimates the influence of the layer, in series with the springs of the simplified theory,
/// L_x = 8 a/(3 G C11).
fn advise(situation: &Situation<'_>) -> Advice {
    let given = situation.case.maybe_number(FLEXIBILITY).ok().flatten();
    let flexibility = given.unwrap_or(TYPICAL);
    let advice = Advice::new(
        EFFECT.name,
        format!("flexibility {flexibility:.1e} m/Pa over that of the bodies"),
    )
    .with(format!("{FLEXIBILITY}={flexibility:e}"));
    let axes = [SEMI_AXIS_A, SEMI_AXIS_B].map(|key| situation.known(key));
    let [Some(a), Some(b)] = axes else { return advice };
    let (ratio, modulus) =
        (situation.scene.combined_poisson_ratio(), situation.scene.combined_shear_modulus());
    let own = 8.0 * a / (3.0 * modulus * kalker::creep_coefficients(a / b, ratio).c11);
    let share = flexibility / own;
    let advice = advice.number("L/L_bodies", share);
    // A prescribed creepage reduces the force of the part that sticks.
    match situation.scene.drive {
        Drive::Creepage { .. } => {
            let sticks = 1.0 - situation.known(SLIP_AREA_RATIO).unwrap_or(1.0);
            advice.moves(POWER, -sticks * share / (1.0 + share))
        }
        _ => advice.moves(CREEPAGE, share),
    }
}
