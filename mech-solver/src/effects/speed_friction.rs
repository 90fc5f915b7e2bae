//! Effect `speed_friction`: friction falls with the slip velocity.
//!
//! From f₀ at rest to A f₀ at high speed; f₀ is the friction coefficient of the case, times the factors of other effects:
//!
//! - exponential (Polach) f(v) = f₀ ((1 − A) e^{−Bv} + A),
//! - linear f(v) = f₀ ((1 − A) max(0, 1 − Bv) + A),
//! - rational f(v) = f₀ ((1 − A)/(1 + Bv) + A),
//!
//! all of the same slope −(1 − A)B f₀ at rest, with v = V |(ξ − φy, η + φx)|. v is the slip of rigid bodies, as Polach has it: in the slip
//! zone it is the slip but for the elastic part, and where surfaces stick the bound that it changes is not reached.
//!
//! *Local slip* (`slip = "local"`, half-spaces). v is the slip velocity of every element, elastic part and all, and 0 where it adheres. Friction and
//! slip are found in turn. Such a law that falls has several solutions in a step of transient rolling (Vollebregt & Schuttelaars, J. Sound Vib. 331 (2012)
//! 2141–2155); `start` says from where they are looked for, and so which one is found: from rest that of least slip, from above that of
//! most, or from the slip of the step or row before. What does not settle is refused. The memory below is that of steady rolling.
//!
//! *Memory.* Surfaces do not forget at once: over a distance d that they have slid on each other friction comes to 1/e of its change,
//! d df/ds = f(v) − f along the way of a particle, which enters the contact with f₀. Of the step by Δx of an element, in which it slides
//! vΔx/V, exactly for v constant in it; the element's friction is that of its middle. d = 0, as without it, is f(v) itself.
//!
//! Where a force is prescribed, its creepage and the friction that it leaves are found together. Creep curves then have a
//! maximum; the creepage on its rising side is the one that is found, and a force beyond the maximum is refused.
//!
//! Sources: Polach, Wear 258 (2005) 992–1000; Vollebregt & Schuttelaars (2012) for the memory, there in the slip of the surfaces.

use crate::advice::situation::{CREEPAGE, Situation};
use crate::case::keys::CheckedParams;
use crate::registry::entry::Effect;
use crate::terms::friction::{FrictionFactor, FrictionLaw, FrictionState};
use crate::terms::{Kind, Need, Terms};
use half_space::slip_iteration::SlipStart;
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::model::StepError;

/// What the registry says of it.
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
        KeySpec::quantity(DECREASE, "s/m", "how fast friction falls with the slip velocity, B")
            .required()
            .at_least(0.0),
        KeySpec::choice(LAW, &["exponential", "linear", "rational"], "how friction falls")
            .default_value("exponential"),
        KeySpec::choice(
            SLIP,
            &["rigid", "local"],
            "the slip velocity of rigid bodies, or that of every element with its elastic part",
        )
        .default_value("rigid"),
        KeySpec::choice(
            START,
            &["before", "below", "above"],
            "of local slip: looked for from that of the step or row before, from rest, or from the rolling speed; it decides between several solutions",
        )
        .default_value("before"),
        KeySpec::quantity(
            MEMORY,
            "m",
            "sliding over which friction comes to 1/e of its change; 0: at once",
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
        lacks: "slip of elements that is solved for with friction that follows it",
        instead: "rigid",
    };
    let needs = law.local.map(|_| need).into_iter().collect();
    Ok(Terms { friction: FrictionLaw::of_factor(law), needs, ..Terms::default() })
}

/// Start of the search for the slip of the elements, if the law follows that.
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

/// What a law leaves of the fall at Bv.
fn curve_of(law: &str) -> fn(f64) -> f64 {
    match law {
        "linear" => |u| (1.0 - u).max(0.0),
        "rational" => |u| (1.0 + u).recip(),
        _ => |u| (-u).exp(),
    }
}

/// How friction falls.
#[derive(Debug)]
struct Falling {
    ratio: f64,
    decrease: f64,
    /// What is left of the fall at Bv.
    curve: fn(f64) -> f64,
    /// Distance of sliding [m].
    memory: f64,
    /// It follows the slip of every element, looked for from here.
    local: Option<SlipStart>,
}

impl Falling {
    /// Friction at a slip velocity [m/s] over that at rest.
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
        let FrictionState { speed, rigid_slip, grid, pressure, velocity, .. } = state;
        let rolls = *speed > 0.0 && self.memory > 0.0;
        for (j, row) in factors.chunks_exact_mut(grid.ni).enumerate() {
            // A particle enters at the front, where x is largest.
            let (mut before, mut touches) = (1.0, false);
            for (i, factor) in row.iter_mut().enumerate().rev() {
                let index = j * grid.ni + i;
                let velocity = velocity.map_or_else(|| rigid_slip(index), |own| own[index]);
                let settled = self.share(velocity);
                touches |= pressure[index] > 0.0;
                if !rolls {
                    *factor = settled;
                } else if touches {
                    let slid = 0.5 * velocity / speed * grid.dx();
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
    let case = CheckedParams::new(situation.case, keys());
    let curve = curve_of(case.text(LAW).unwrap_or("exponential"));
    let left = (1.0 - ratio) * curve(decrease * slip) + ratio;
    let advice = advice.number("slip velocity times B", decrease * slip);
    situation.with_friction(advice, situation.scene.friction_coefficient * left)
}
