//! Effect `thermal_expansion`: heated material expands and raises the surface.
//!
//! This module provides the input that the mechanics needs ([`super::integrated`]).

use super::integrated;
use crate::situation::Situation;
use proto::advice::Advice;
use proto::description::EffectSpec;
use proto::figure::contact::MAX_PRESSURE;

/// Name of the effect in the case file.
pub const NAME: &str = integrated::EXPANSION;

/// Returns the thermal participant's part of the effect.
#[must_use]
pub fn spec() -> EffectSpec {
    integrated::spec(NAME)
}

/// Coefficient of thermal expansion of steel, used if the case has none [1/K].
const STEEL: f64 = 1.2e-5;

/// Relative change of the largest pressure per ratio of that height to the approach: 0.34 to 0.36
/// in runs of `half-space` with `columns` of `cases/wheel-spin.toml` at 10 and 40 m/s, 20 and 60
/// kN, creepages of 0.2 and 0.5.
const PRESSED: f64 = 0.35;

/// Estimates how much the effect matters in a scene.
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
    let raised = |body: usize| {
        let coefficient = materials.get(body).and_then(|material| given(material)).unwrap_or(STEEL);
        2.0 * (1.0 + 0.3) * coefficient * situation.rise_integral(body)
    };
    let height: f64 = (0..2).map(raised).filter(|height| height.is_finite()).sum();
    let share = height / situation.approach;
    let why = "height by which heat raises the surfaces behind the contact, over the approach; the pressure changes by about a third of this ratio";
    let advice = Advice::new(NAME, why)
        .number("thermal rise over approach", share)
        .moves(MAX_PRESSURE, PRESSED * share);
    let advice = lacking
        .iter()
        .fold(advice, |advice, material| advice.with(format!("{}={STEEL:e}", key(material))));
    advice.with(format!("effects.{NAME}={{}}"))
}
