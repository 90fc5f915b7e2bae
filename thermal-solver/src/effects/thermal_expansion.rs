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
/// Relative change of the largest pressure per that ratio for a body at rest, whose surface is
/// raised in the shape of the flux, as long as the heat has not spread beyond the contact. Found in
/// runs of `cases/pin-on-disc.toml` and `cases/locked-wheel.toml` over different times.
const PRESSED_AT_REST: f64 = 1.1;

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
    let pressed = |body: usize| match situation.speeds[body] {
        0.0 => PRESSED_AT_REST / situation.spread(body),
        _ => PRESSED,
    };
    let shares = [0, 1].map(|body| raised(body) / situation.approach);
    let known = (0..2).filter(|body| shares[*body].is_finite());
    let (share, change) = known.fold((0.0, 0.0), |(share, change), body| {
        (share + shares[body], change + pressed(body) * shares[body])
    });
    let why = "height by which heat raises the surfaces behind the contact, or within that of a body at rest, over the approach; the pressure changes by a third of this ratio, at rest by up to all of it";
    let advice = Advice::new(NAME, why)
        .number("thermal rise over approach", share)
        .moves(MAX_PRESSURE, change);
    let advice = lacking
        .iter()
        .fold(advice, |advice, material| advice.with(format!("{}={STEEL:e}", key(material))));
    advice.with(format!("effects.{NAME}={{}}"))
}
