//! Effect `partial_slip`: a part of the contact sticks.
//!
//! Coulomb's law with a stick zone: |p_t| ≤ f p_n; where the surfaces slip, equality holds and the
//! traction opposes the slip. Without the effect the whole contact slides. Each model finds the
//! stick zone in its own way: Carter's strips, a march over springs, or the elastic half-space.

use crate::advice::situation::{POWER, PRESSURE, Situation};
use crate::case::scene::Drive;
use crate::effects::third_body_layer;
use crate::registry::entry::Effect;
use crate::terms::{Kind, Terms};
use elastic::carter;
use proto::advice::Advice;
use proto::figure::contact::SLIP_AREA_RATIO;

/// Registry entry of the effect.
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
    let set = format!("effects.{}={{}}", EFFECT.name);
    let scene = situation.scene;
    let friction = scene.friction_coefficient;
    let with = |key: &str| situation.otherwise(key, friction, true);
    let power = third_body_layer::power_where_it_sticks(situation);
    let figures = (power, with(PRESSURE), with("contact.normal_force_n"));
    let (Some(power), Some(pressure), Some(load)) = figures else {
        let why = "not estimated: the contact is not a rolling ellipse, or friction does not carry the force";
        return Advice::new(EFFECT.name, why).with(set);
    };
    // A contact in full sliding has the prescribed creepage, or that of Carter's law.
    let prefactor = carter::prefactor_by_pressure(friction, pressure, scene.contact_compliance());
    let creep = match scene.drive {
        Drive::TractionCoefficient(value) => {
            carter::creep(prefactor, (value / friction).abs().min(1.0))
        }
        Drive::TangentialForce(force) => {
            carter::creep(prefactor, (force / (friction * load)).abs().min(1.0))
        }
        Drive::Creepage { xi, eta, .. } => xi.hypot(eta),
        Drive::Shift(_) => f64::NAN,
    };
    let sliding = scene.speeds.rolling * creep * friction * load;
    Advice::new(EFFECT.name, "simplified theory, against a contact that slides everywhere")
        .number("slip area over contact area", with(SLIP_AREA_RATIO).unwrap_or(f64::NAN))
        .moves(POWER, power / sliding - 1.0)
        .with(set)
}
