//! Effect `speed_friction`: friction falls with the slip velocity.
//!
//! The coefficient falls from f₀ at rest to A f₀ at high speed. f₀ is the friction coefficient of
//! the case, times the factors of other effects:
//!
//! - exponential (Polach) f(v) = f₀ ((1 − A) e^{−Bv} + A),
//! - linear f(v) = f₀ ((1 − A) max(0, 1 − Bv) + A),
//! - rational f(v) = f₀ ((1 − A)/(1 + Bv) + A),
//!
//! All three have the slope −(1 − A)B f₀ at rest, with v = V |(ξ − φy, η + φx)|. As in Polach, v is
//! the slip velocity of rigid bodies. In the slip zone it differs from the true slip velocity by
//! the elastic part. In the stick zone the modified bound is not reached.
//!
//! *Local slip* (`slip = "local"`, half-spaces). v is the slip velocity of every element including
//! its elastic part, and 0 where it adheres. Friction and slip are solved together. In a step of
//! transient rolling such a falling law has several solutions (Vollebregt & Schuttelaars, J. Sound
//! Vib. 331 (2012) 2141–2155). The key `start` sets the initial slip of the iteration, and so
//! selects the solution: the one with the least slip if it starts from rest, the one with the most
//! slip if it starts from above, or one near the slip of the previous step or row. An iteration
//! that does not converge is refused. The memory below applies only to steady rolling.
//!
//! *Memory.* Friction follows the slip velocity with a delay: d df/ds = f(v) − f along the path of
//! a particle, which enters the contact with f₀. After the sliding distance s = d, the deviation
//! has decayed to 1/e. Within an element of length Δx a particle slides vΔx/V, and the equation is
//! solved exactly for constant v; the element has the friction of its middle. For d = 0 friction is
//! f(v).
//!
//! For a prescribed force, the creepage and the friction at that creepage are solved together. The
//! creep curve then has a maximum. The creepage on its rising side is returned, and a force beyond
//! the maximum is refused.
//!
//! Sources: Polach, Wear 258 (2005) 992–1000; Vollebregt & Schuttelaars (2012) for the memory,
//! there in the slip of the surfaces.

use crate::advice::situation::{CREEPAGE, Situation};
use crate::case::keys::CheckedParams;
use crate::registry::entry::Effect;
use crate::terms::friction::{FrictionFactor, FrictionLaw, FrictionState};
use crate::terms::{Kind, Need, Terms};
use half_space::slip_velocity::SlipStart;
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::model::StepError;

/// Registry entry of the effect.
pub const EFFECT: Effect = Effect {
    name: "speed_friction",
    law: "f(v) = f0 ((1 - A) g(B v) + A) with the rigid slip velocity v and g(u) = exp(-u), 1 - u or 1/(1 + u), \
          after a distance of sliding",
    source: "Polach, Wear 258 (2005) 992-1000; Vollebregt & Schuttelaars, J. Sound Vib. 331 (2012) 2141-2155",
    kinds: &[Kind::FrictionFactor],
    consumes: &[],
    provides: &[],
    keys,
    figures: Vec::new,
    advise: Some(advise),
    terms,
};

const RATIO: &str = "effects.speed_friction.ratio";
const DECREASE: &str = "effects.speed_friction.decrease";
const LAW: &str = "effects.speed_friction.law";
const SLIP: &str = "effects.speed_friction.slip";
const START: &str = "effects.speed_friction.start";
const MEMORY: &str = "effects.speed_friction.memory_distance";

fn keys() -> Vec<KeySpec> {
    vec![
        KeySpec::number(RATIO, "friction at high slip velocity over that at rest, A")
            .default_value(0.4)
            .above(0.0)
            .at_most(1.0),
        KeySpec::quantity(DECREASE, "s/m", "rate at which friction falls with the slip velocity, B")
            .required()
            .at_least(0.0),
        KeySpec::choice(LAW, &["exponential", "linear", "rational"], "law of the fall")
            .default_value("exponential"),
        KeySpec::choice(
            SLIP,
            &["rigid", "local"],
            "slip velocity of rigid bodies, or of every element including its elastic part",
        )
        .default_value("rigid"),
        KeySpec::choice(
            START,
            &["before", "below", "above"],
            "start of the search for local slip: the slip of the previous step or row, rest, or the rolling speed; selects among several solutions",
        )
        .default_value("before"),
        KeySpec::quantity(
            MEMORY,
            "m",
            "sliding distance over which the deviation of friction decays to 1/e; 0: no memory",
        )
        .expected(0.0..=1e-2, "a contact is a centimetre long; check the unit")
        .default_value(0.0)
        .at_least(0.0),
    ]
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let case = CheckedParams::new(&configuration.case, keys());
    let law = Falling {
        ratio: case.number(RATIO)?,
        decrease: case.number(DECREASE)?,
        curve: curve_of(case.text(LAW)?),
        memory: case.number(MEMORY)?,
        local: start_of(&case)?,
    };
    let need = Need {
        kind: Kind::LocalSlip,
        key: SLIP,
        lacks: "iteration of friction with the slip of every element",
        instead: "rigid",
    };
    let needs = law.local.map(|_| need).into_iter().collect();
    Ok(Terms { friction: FrictionLaw::of_factor(law), needs, ..Terms::default() })
}

/// Initial slip of the iteration; `None` if the law follows the rigid slip.
fn start_of(case: &CheckedParams<'_>) -> Result<Option<SlipStart>, Refusal> {
    if case.text(SLIP)? == "rigid" {
        return Ok(None);
    }
    Ok(Some(match case.text(START)? {
        "below" => SlipStart::Below,
        "above" => SlipStart::Above,
        _ => SlipStart::Before,
    }))
}

/// Returns the curve g(Bv) of a law, the remaining share of the fall.
fn curve_of(law: &str) -> fn(f64) -> f64 {
    match law {
        "linear" => |u| (1.0 - u).max(0.0),
        "rational" => |u| (1.0 + u).recip(),
        _ => |u| (-u).exp(),
    }
}

/// Friction coefficient that falls with the slip velocity.
#[derive(Debug)]
struct Falling {
    ratio: f64,
    decrease: f64,
    /// Remaining share of the fall at Bv.
    curve: fn(f64) -> f64,
    /// Memory distance d [m].
    memory: f64,
    /// Initial slip of the iteration if friction follows the slip of every element.
    local: Option<SlipStart>,
}

impl Falling {
    /// Friction at a slip velocity [m/s], relative to friction at rest.
    fn share(&self, velocity: f64) -> f64 {
        (1.0 - self.ratio) * (self.curve)(self.decrease * velocity) + self.ratio
    }
}

impl FrictionFactor for Falling {
    fn write(
        &self,
        state: &FrictionState<'_>,
        _coefficient: f64,
        factors: &mut [f64],
    ) -> Result<(), StepError> {
        let FrictionState { speed, rigid_slip, rows, pressure, velocity, .. } = state;
        let columns = rows.grid().ni;
        let rolls = *speed > 0.0 && self.memory > 0.0;
        for (j, row) in factors.chunks_exact_mut(columns).enumerate() {
            // Particles enter at the leading edge, where x is largest.
            let (mut before, mut touches) = (1.0, false);
            for (i, factor) in row.iter_mut().enumerate().rev() {
                let index = j * columns + i;
                let velocity = velocity.map_or_else(|| rigid_slip(index), |own| own[index]);
                let settled = self.share(velocity);
                touches |= pressure[index] > 0.0;
                if !rolls {
                    *factor = settled;
                } else if touches {
                    let slid = 0.5 * velocity / speed * rows.grid().dx();
                    let kept = (-slid / self.memory).exp();
                    let towards = |before: f64| settled + (before - settled) * kept;
                    let middle = towards(before);
                    *factor = middle;
                    before = towards(middle);
                }
            }
        }
        Ok(())
    }

    fn follows_slip(&self) -> bool {
        self.local.is_none()
    }

    fn follows_elements(&self) -> Option<SlipStart> {
        self.local
    }

    fn memory_of_rows(&self) -> Option<&'static str> {
        (self.local.is_some() && self.memory > 0.0).then_some(MEMORY)
    }

    fn shortfall(&self) -> &'static str {
        "friction falls with the slip that the force needs"
    }
}

/// Polach's constant B for a dry rail [s/m], used if the case has none.
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
    let case = CheckedParams::new(situation.case, keys());
    let curve = curve_of(case.text(LAW).unwrap_or("exponential"));
    let left = (1.0 - ratio) * curve(decrease * slip) + ratio;
    let advice = advice.number("slip velocity times B", decrease * slip);
    situation.with_friction(advice, situation.scene.friction_coefficient * left)
}
