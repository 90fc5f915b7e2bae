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
use crate::case::scene::{Drive, Scene};
use crate::registry::entry::Effect;
use crate::terms::{Kind, Terms};
use elastic::kalker;
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::figure::contact::{SEMI_AXIS_A, SEMI_AXIS_B};
use proto::readable::number;

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

/// Returns the flexibility of a layer [m/Pa] over that of the springs of the simplified theory,
/// L_x = 8 a/(3 G C11).
fn over_bodies(situation: &Situation<'_>, flexibility: f64) -> Option<f64> {
    let [a, b] = [situation.known(SEMI_AXIS_A)?, situation.known(SEMI_AXIS_B)?];
    let (ratio, modulus) =
        (situation.scene.combined_poisson_ratio(), situation.scene.combined_shear_modulus());
    let own = 8.0 * a / (3.0 * modulus * kalker::creep_coefficients(a / b, ratio).c11);
    Some(flexibility / own)
}

/// Estimates the friction power of springs that are softer by a factor [W]. They have the tractions
/// of a creepage that is smaller by this factor, and slip by more.
fn power_of_softer(situation: &Situation<'_>, softer: f64, sticks: bool) -> Option<f64> {
    let drive = match situation.scene.drive {
        Drive::Creepage { xi, eta, phi } => {
            Drive::Creepage { xi: xi / softer, eta: eta / softer, phi: phi / softer }
        }
        force => force,
    };
    let eased = Scene { drive, ..situation.scene.clone() };
    Some(softer * (situation.estimated)(&eased, sticks, None)?.get(POWER)?)
}

/// Estimates the friction power where surfaces may stick, with the layer of the case, if any [W].
pub(super) fn power_where_it_sticks(situation: &Situation<'_>) -> Option<f64> {
    let flexibility = situation.case.maybe_number(FLEXIBILITY).ok().flatten();
    let share = match flexibility.filter(|_| situation.has(EFFECT.name)) {
        Some(flexibility) => over_bodies(situation, flexibility)?,
        None => 0.0,
    };
    power_of_softer(situation, 1.0 + share, true)
}

/// Estimates the influence of the layer, in series with the springs of the simplified theory.
fn advise(situation: &Situation<'_>) -> Advice {
    let given = situation.case.maybe_number(FLEXIBILITY).ok().flatten();
    let flexibility = given.unwrap_or(TYPICAL);
    let advice = Advice::new(
        EFFECT.name,
        format!(
            "flexibility {flexibility} m/Pa over that of the bodies",
            flexibility = number(flexibility, 2)
        ),
    )
    .with(format!("{FLEXIBILITY}={flexibility:e}"));
    let Some(share) = over_bodies(situation, flexibility) else { return advice };
    let advice = advice.number("L/L_bodies", share);
    if !matches!(situation.scene.drive, Drive::Creepage { .. }) {
        return advice.moves(CREEPAGE, share);
    }
    let power = |softer: f64| power_of_softer(situation, softer, situation.sticks);
    match (power(1.0 + share), power(1.0).filter(|power| *power > 0.0)) {
        (Some(with), Some(without)) => advice.moves(POWER, with / without - 1.0),
        _ => advice,
    }
}
