//! Effect `thermal_expansion`: what is warm expands, and the surface rises.
//!
//! Here what the mechanics need for it is provided: the rise of each body integrated over its depth
//! ([`crate::moving_source::rise_integral`]).

use crate::models::fields::RISE_INTEGRALS;
use crate::models::names;
use crate::scene::Scene;
use crate::situation::Situation;
use proto::advice::Advice;
use proto::configuration::{Mode, Refusal};
use proto::description::{EffectSpec, names as field_names};

/// Name in the case file.
pub const NAME: &str = "thermal_expansion";

/// The thermal participant's part of the effect.
#[must_use]
pub fn spec() -> EffectSpec {
    EffectSpec {
        figures: Vec::new(),
        name: NAME.to_owned(),
        law: "W(k) = int T(k, z) exp(-k z) dz, of each body".to_owned(),
        source: "Barber, Elasticity (2010), thermoelastic displacement potentials".to_owned(),
        models: [names::COLUMNS, names::MOVING_SOURCE, names::FE, names::PERIODIC, names::ROD]
            .map(str::to_owned)
            .to_vec(),
        consumes: Vec::new(),
        provides: field_names(&[RISE_INTEGRALS[1], RISE_INTEGRALS[0]]),
        keys: Vec::new(),
    }
}

/// Refuses a steady case with a body at rest, whose surface rises without end.
///
/// # Errors
/// There is one.
pub fn refuse_rest(scene: &Scene, mode: Mode) -> Result<(), Refusal> {
    let Some(body) = (0..2).find(|body| scene.at_rest[*body] && mode == Mode::Steady) else {
        return Ok(());
    };
    Err(Refusal::new(
        &scene.names.key(body, "surface_speed"),
        format!(
            "`{}` is at rest: it is heated without end, and its surface has no steady height",
            scene.names.0[body]
        ),
        "write time.mode = \"transient\", a speed above 0 m/s, or remove effects.thermal_expansion",
    ))
}

/// Coefficient of thermal expansion of steel, where the case has none [1/K].
const STEEL: f64 = 1.2e-5;

/// What it says of itself in a scene.
#[must_use]
pub fn advise(situation: &Situation<'_>) -> Advice {
    let materials: Vec<&str> = (0..2)
        .filter_map(|body| situation.case.text(&situation.scene.names.key(body, "material")).ok())
        .collect();
    let key = |material: &str| format!("materials.{material}.thermal_expansion");
    let given = |material: &str| situation.case.maybe_number(&key(material)).ok().flatten();
    let mut lacking: Vec<&str> =
        materials.iter().copied().filter(|material| given(material).is_none()).collect();
    lacking.dedup();
    let [_, b] = situation.semi_axes;
    let raised = |body: usize| {
        let coefficient = materials.get(body).and_then(|material| given(material)).unwrap_or(STEEL);
        let material = &situation.scene.materials[body];
        let speed = situation.speeds[body];
        // Heat per area over its capacity is the rise integrated over the depth.
        let integral = situation.heat[body]
            / (speed * 0.5 * std::f64::consts::PI * b * material.density * material.specific_heat);
        2.0 * (1.0 + 0.3) * coefficient * integral
    };
    let height: f64 = (0..2).filter(|body| situation.speeds[*body] > 0.0).map(raised).sum();
    let share = height / situation.approach;
    let advice = Advice::new(NAME, "height by which heat raises the surfaces behind the contact, over the approach; half of it")
        .number("thermal rise over approach", share)
        .moves("contact.max_pressure_pa", 0.5 * share);
    let advice = lacking
        .iter()
        .fold(advice, |advice, material| advice.with(format!("{}={STEEL:e}", key(material))));
    advice.with(format!("effects.{NAME}={{}}"))
}
