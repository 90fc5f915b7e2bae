//! Effect `plastic_layer`: the layer between the surfaces flows plastically, and hardens or softens
//! with the plastic shift.
//!
//! The traction bound is |p_t| ≤ min(f p, τ(κ)) with τ(κ) = max(τ₀ + k κ, r τ₀). The yield stress
//! τ₀ of fresh material changes by k κ with the plastic shift κ = ∫|du_p|, which a particle of the
//! layer accumulates on its way through the contact. It does not fall below r τ₀. The plastic shift
//! opposes the traction, in series with the slip of the surfaces ([`half_space::yielding`]), and
//! its dissipation is part of the friction power. Fresh material enters a rolling contact; in a
//! shift without rolling the layer stays in place. With k = 0 the law is `shear_limit`; with
//! `third_body_layer` the layer is elastic and plastic.
//!
//! Source: Hou, Kalousek and Magel, Wear 211 (1997) 134–140; Vollebregt, CONTACT, with r = 0.1.
//! Neglected: a yield stress that falls with temperature or grows with pressure, kinematic
//! hardening, and the residual state of the layer for the next wheel.

use crate::advice::situation::Situation;
use crate::case::keys::CheckedParams;
use crate::registry::entry::Effect;
use crate::terms::{Kind, Terms};
use half_space::yielding::Yield;
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;

/// Registry entry of the effect.
pub const EFFECT: Effect = Effect {
    name: "plastic_layer",
    law: "|p_t| <= min(f p, tau), tau = max(tau_0 + k kappa, r tau_0), kappa the accumulated plastic shift",
    source: "Hou, Kalousek & Magel, Wear 211 (1997) 134-140",
    kinds: &[Kind::Yield],
    consumes: &[],
    provides: &[],
    keys,
    figures: Vec::new,
    advise: Some(advise),
    terms,
};

const YIELD_STRESS: &str = "effects.plastic_layer.yield_stress";
const HARDENING: &str = "effects.plastic_layer.hardening";
const RESIDUAL_SHARE: &str = "effects.plastic_layer.residual_share";

fn keys() -> Vec<KeySpec> {
    vec![
        KeySpec::quantity(YIELD_STRESS, "Pa", "yield stress in shear of fresh material, tau_0")
            .required()
            .above(0.0),
        KeySpec::quantity(
            HARDENING,
            "Pa/m",
            "change of the yield stress with the plastic shift, k; negative where it softens",
        )
        .default_value(0.0),
        KeySpec::number(RESIDUAL_SHARE, "lowest yield stress over that of fresh material, r")
            .default_value(0.1)
            .above(0.0)
            .at_most(1.0),
    ]
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let case = CheckedParams::new(&configuration.case, keys());
    let stress = case.number(YIELD_STRESS)?;
    let hardening = case.number(HARDENING)?;
    let law = Yield { stress, hardening, residual: case.number(RESIDUAL_SHARE)? * stress };
    Ok(Terms { yields: Some(law), ..Terms::default() })
}

/// Yield stress of clay between wheel and rail [Pa], used if the case has none.
const TYPICAL: f64 = 200e6;

/// Estimates the influence of the fresh layer, before it hardens or softens.
fn advise(situation: &Situation<'_>) -> Advice {
    let given = situation.case.maybe_number(YIELD_STRESS).ok().flatten();
    situation.cut_off(EFFECT.name, YIELD_STRESS, given.unwrap_or(TYPICAL))
}
