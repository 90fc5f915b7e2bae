//! Effect `partial_slip`: a part of the contact sticks.
//!
//! Coulomb's law with a stick zone: |p_t| ≤ f p_n, equal to it where the surfaces slip, against the
//! slip. Without the effect the whole contact slides. How a model finds the stick zone is its own
//! matter: Carter's strips, a march over springs, or the elastic half-space.

use crate::advice::{POWER, Situation};
use crate::entry::Effect;
use crate::terms::{Kind, Terms};
use proto::advice::Advice;

/// What the registry says of it.
pub const EFFECT: Effect = Effect {
    name: "partial_slip",
    law: "Coulomb friction with a stick zone: |p_t| <= f p_n, equal to it and against the slip where \
          the surfaces slip; absent: the whole contact slides with p_t = f p_n",
    source: "Carter, Proc. R. Soc. Lond. A 112 (1926) 151-157; Kalker, Three-Dimensional Elastic \
             Bodies in Rolling Contact (1990)",
    kinds: &[Kind::Adhesion],
    consumes: &[],
    provides: &[],
    keys: Vec::new,
    figures: Vec::new,
    advise: Some(advise),
    terms: |_| Ok(Terms { adhesion: true, ..Terms::default() }),
};

fn advise(situation: &Situation<'_>) -> Advice {
    let friction = situation.scene.friction_coefficient;
    let of = |key: &str, sticks: bool| situation.otherwise(key, friction, sticks);
    let set = format!("effects.{}={{}}", EFFECT.name);
    let (Some(with), Some(without)) = (of(POWER, true), of(POWER, false)) else {
        return Advice::new(EFFECT.name, "the contact is no ellipse that rolls: not estimated")
            .with(set);
    };
    let advice =
        Advice::new(EFFECT.name, "simplified theory with and without a stick zone").with(set);
    let slips = of("contact.slip_area_ratio", true).unwrap_or(f64::NAN);
    advice.number("slip area over contact area", slips).moves(POWER, with / without - 1.0)
}
