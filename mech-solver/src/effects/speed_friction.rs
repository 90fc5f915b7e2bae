//! Effect `speed_friction`: friction falls with the slip velocity.
//!
//! f(v) = f₀ ((1 − A) e^{−Bv} + A), v = V |(ξ − φy, η + φx)|: from f₀, the friction coefficient of the case and of the effects
//! before, at rest to A f₀ at high speed. v is the slip of rigid bodies, as Polach has it: in the slip zone it is the slip
//! but for the elastic part, and where surfaces stick the bound that it changes is not reached. With the elastic part a law
//! that falls has several solutions (Vollebregt & Schuttelaars, J. Sound Vib. 331 (2012) 2141–2155).
//!
//! Where a force is prescribed, its creepage and the friction that it leaves are found together. Creep curves then have a
//! maximum; the creepage on its rising side is the one that is found, and a force beyond the maximum is refused.
//!
//! Source: Polach, Wear 258 (2005) 992–1000.

use crate::entry::Effect;
use crate::keys::CheckedParams;
use crate::situation::{CREEPAGE, Situation};
use crate::terms::{FrictionTerm, Kind, Rubbing, State, Terms};
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::model::StepError;

/// What the registry says of it.
pub const EFFECT: Effect = Effect {
    name: "speed_friction",
    law: "f(v) = f0 ((1 - A) exp(-B v) + A) with the rigid slip velocity v",
    source: "Polach, Wear 258 (2005) 992-1000",
    kinds: &[Kind::Friction],
    consumes: &[],
    provides: &[],
    keys,
    figures: Vec::new,
    advise: Some(advise),
    terms,
};

const RATIO: &str = "effects.speed_friction.ratio";
const DECREASE: &str = "effects.speed_friction.decrease";

fn keys() -> Vec<KeySpec> {
    vec![
        KeySpec::number(RATIO, "friction at high slip velocity over that at rest, A")
            .default_value(0.4)
            .above(0.0)
            .at_most(1.0),
        KeySpec::quantity(DECREASE, "s/m", "how fast friction falls with the slip velocity, B")
            .required()
            .at_least(0.0),
    ]
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let case = CheckedParams::new(&configuration.case, keys());
    let law = Falling { ratio: case.number(RATIO)?, decrease: case.number(DECREASE)? };
    Ok(Terms { friction: vec![Box::new(law)], ..Terms::default() })
}

/// Polach's law.
#[derive(Debug)]
struct Falling {
    ratio: f64,
    decrease: f64,
}

impl State for Falling {}

impl FrictionTerm for Falling {
    fn apply(&mut self, rubbing: &Rubbing<'_>, friction: &mut [f64]) -> Result<(), StepError> {
        let Rubbing { slip, grid, .. } = rubbing;
        for (index, friction) in friction.iter_mut().enumerate() {
            let velocity = slip.at(grid.x(index % grid.ni), grid.y(index / grid.ni));
            *friction *= (1.0 - self.ratio) * (-self.decrease * velocity).exp() + self.ratio;
        }
        Ok(())
    }

    fn follows_slip(&self) -> bool {
        true
    }

    fn shortfall(&self) -> &'static str {
        "friction falls with the slip that the force needs"
    }
}

/// Polach's constant for a dry rail, where the case has none [s/m].
const TYPICAL: f64 = 0.6;

fn advise(situation: &Situation<'_>) -> Advice {
    let number = |key: &str| situation.case.maybe_number(key).ok().flatten();
    let decrease = number(DECREASE).unwrap_or(TYPICAL);
    let ratio = number(RATIO).unwrap_or(0.4);
    let advice = Advice::new(
        EFFECT.name,
        format!("friction at the creepage, falling by B = {decrease} s/m"),
    )
    .with(format!("{DECREASE}={decrease}"));
    let Some(creepage) = situation.known(CREEPAGE) else { return advice };
    let slip = situation.scene.speeds.rolling * creepage.abs();
    let left = (1.0 - ratio) * (-decrease * slip).exp() + ratio;
    let advice = advice.number("slip velocity times B", decrease * slip);
    situation.with_friction(advice, situation.scene.friction_coefficient * left)
}
