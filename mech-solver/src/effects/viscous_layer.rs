//! Effect `viscous_layer`: a film between the surfaces that shears like a viscous fluid, up to
//! friction.
//!
//! The film has the traction τ = η v/h, with its viscosity η, its thickness h and the slip velocity
//! of rigid bodies v = V |(ξ − φy, η_y + φx)|. Friction is an upper bound: |p_t| ≤ min(f p, η v/h).
//! The force first rises with the creepage as for a fluid, and then approaches f N.
//!
//! Source: Stachowiak & Batchelor, Engineering Tribology (2013), ch. 4, for the film; Hou, Kalousek
//! & Magel, Wear 211 (1997) 134–140, for third bodies between wheel and rail. Neglected: the
//! elastic part of the slip, and viscosity that depends on pressure and temperature. A prescribed
//! force is refused, because the film carries none at rest.

use crate::advice::situation::Situation;
use crate::case::keys::CheckedParams;
use crate::case::scene;
use crate::registry::entry::Effect;
use crate::terms::friction::{FrictionLaw, FrictionState, TractionBound};
use crate::terms::{Kind, Terms};
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;

/// Registry entry of the effect.
pub const EFFECT: Effect = Effect {
    name: "viscous_layer",
    law: "traction bound min(f p, eta v/h) with the rigid slip velocity v",
    source: "Stachowiak & Batchelor, Engineering Tribology (2013), ch. 4; Hou, Kalousek & Magel, Wear \
             211 (1997) 134-140",
    kinds: &[Kind::TractionBound],
    consumes: &[],
    provides: &[],
    keys,
    figures: Vec::new,
    advise: Some(advise),
    terms,
};

const VISCOSITY: &str = "effects.viscous_layer.viscosity";
const THICKNESS: &str = "effects.viscous_layer.thickness";

fn keys() -> Vec<KeySpec> {
    vec![
        KeySpec::quantity(VISCOSITY, "Pa s", "dynamic viscosity of the film").required().above(0.0),
        KeySpec::quantity(THICKNESS, "m", "thickness of the film").required().above(0.0),
    ]
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let case = CheckedParams::new(&configuration.case, keys());
    if scene::prescribes_force(&configuration.case) {
        return Err(Refusal::new(
            "effects.viscous_layer",
            "at rest the film carries no force, so that none can be prescribed",
            "write motion.creepage, or remove the effect",
        ));
    }
    let film = Film { shear_rate_factor: case.number(VISCOSITY)? / case.number(THICKNESS)? };
    Ok(Terms { friction: FrictionLaw::of_bound(film), ..Terms::default() })
}

#[derive(Debug)]
struct Film {
    /// η/h [Pa·s/m].
    shear_rate_factor: f64,
}

impl TractionBound for Film {
    fn at(&self, state: &FrictionState<'_>, index: usize) -> f64 {
        self.shear_rate_factor * (state.rigid_slip)(index)
    }

    fn follows_slip(&self) -> bool {
        true
    }

    fn shortfall(&self) -> &'static str {
        "the film does not carry the force"
    }
}

fn advise(_: &Situation<'_>) -> Advice {
    Advice::new(EFFECT.name, "needs the viscosity and thickness of a film in the case")
}
