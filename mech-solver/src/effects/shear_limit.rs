//! Effect `shear_limit`: the layer between the surfaces yields at a shear stress that does not
//! depend on the pressure.
//!
//! The traction bound is |p_t| ≤ min(f p, τ_y). Where friction would exceed the yield stress τ_y of
//! the third body, the layer flows and is ideally plastic. The dissipated power is the stress times
//! the velocity across the layer, as for friction. The yield stress is a separate bound: factors on
//! the friction coefficient do not change it. Together with `third_body_layer` it is an
//! elastic–plastic layer.
//!
//! Source: Vollebregt, Wear 314 (2014) 87–95; Vollebregt, Voltr et al., Veh. Syst. Dyn. (2022), for
//! elastic–plastic third bodies. Neglected: the residual strain of the layer behind the contact.
//! Hardening is in `plastic_layer`.

use crate::advice::situation::Situation;
use crate::case::keys::CheckedParams;
use crate::registry::entry::Effect;
use crate::terms::friction::{FrictionLaw, FrictionState, TractionBound};
use crate::terms::{Kind, Terms};
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;

/// Registry entry of the effect.
pub const EFFECT: Effect = Effect {
    name: "shear_limit",
    law: "|p_t| <= min(f p, tau_y), with the yield stress tau_y of the layer between the surfaces",
    source: "Vollebregt, Wear 314 (2014) 87-95",
    kinds: &[Kind::TractionBound],
    consumes: &[],
    provides: &[],
    keys,
    figures: Vec::new,
    advise: Some(advise),
    terms,
};

const YIELD_STRESS: &str = "effects.shear_limit.yield_stress";

fn keys() -> Vec<KeySpec> {
    vec![
        KeySpec::quantity(
            YIELD_STRESS,
            "Pa",
            "yield stress in shear of the layer between the surfaces",
        )
        .required()
        .above(0.0),
    ]
}

#[derive(Debug)]
struct ShearLimit {
    yield_stress: f64,
}

impl TractionBound for ShearLimit {
    fn at(&self, _state: &FrictionState<'_>, _index: usize) -> f64 {
        self.yield_stress
    }

    fn shortfall(&self) -> &'static str {
        "the layer between the surfaces yields"
    }
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let case = CheckedParams::new(&configuration.case, keys());
    let limit = ShearLimit { yield_stress: case.number(YIELD_STRESS)? };
    Ok(Terms { friction: FrictionLaw::of_bound(limit), ..Terms::default() })
}

/// Yield stress of wear debris and iron oxides between wheel and rail [Pa], used if the case has
/// none.
const TYPICAL: f64 = 300e6;

fn advise(situation: &Situation<'_>) -> Advice {
    let given = situation.case.maybe_number(YIELD_STRESS).ok().flatten();
    situation.cut_off(EFFECT.name, YIELD_STRESS, given.unwrap_or(TYPICAL))
}
