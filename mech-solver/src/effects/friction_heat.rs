//! Effect `friction_heat`, mechanical side: the friction power that becomes heat.
//!
//! Friction power density q_f = −p_t · v = |p_t| |v| [W/m²], with the traction p_t [Pa] on the
//! upper body and its velocity v [m/s] relative to the lower one. The output is the element mean of
//! this product. The sum over the elements is therefore V s F at every resolution, the power of the
//! creep force F at the creepage s. The product of element means would be too small.
//!
//! The share w becomes heat, q = w q_f; the default is w = 1. The rest goes into new surfaces, wear
//! particles and the work stored in the metal. The friction power in the summary is the full power.
//!
//! Source: Naeimi et al., eq. 1; Kennedy, Wear 100 (1984) 453–476, for the share.

use crate::case::keys::CheckedParams;
use crate::registry::entry::Effect;
use crate::terms::{Kind, Terms};
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::field::{FRICTION_POWER, SURFACE_SPEED};

/// Registry entry of the effect.
pub const EFFECT: Effect = Effect {
    name: "friction_heat",
    law: "friction power density q_f = |p_t| |v|, traction times slip velocity, of which the share w \
          becomes heat",
    source: "Naeimi et al., flash temperature at the wheel-rail contact, eq. 1; Ertz & Knothe, Wear \
             253 (2002) 498-508",
    kinds: &[Kind::HeatShare],
    consumes: &[],
    provides: &[&FRICTION_POWER, &SURFACE_SPEED],
    keys,
    figures: Vec::new,
    advise: None,
    terms,
};

const SHARE: &str = "effects.friction_heat.heat_share";

fn keys() -> Vec<KeySpec> {
    let help = "share w of the friction power that becomes heat";
    vec![KeySpec::number(SHARE, help).default_value(1.0).above(0.0).at_most(1.0)]
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let share = CheckedParams::new(&configuration.case, keys()).number(SHARE)?;
    let heat_shares = if share < 1.0 { vec![share] } else { Vec::new() };
    Ok(Terms { heat_shares, ..Terms::default() })
}
