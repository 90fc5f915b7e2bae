//! Effect `radiation`: the free surface radiates the flux εσ (T⁴ − T∞⁴) to its surroundings.
//!
//! The surface is free wherever no heat enters it in the row of elements: ahead of the contact,
//! beside it and behind it. Temperatures are absolute. Source: Carslaw & Jaeger, Conduction of Heat
//! in Solids, 1.9.

use crate::situation::Situation;
use proto::advice::Advice;
use proto::bodies::{ABSOLUTE, INITIAL_TEMPERATURE};
use proto::configuration::Refusal;
use proto::description::{EffectSpec, KeySpec, names as field_names};
use proto::field;
use proto::params::Params;

/// Name of the effect in the case file.
pub const NAME: &str = "radiation";

const EMISSIVITY: &str = "effects.radiation.emissivity";
const TEMPERATURE: &str = "effects.radiation.temperature";

/// Returns the thermal participant's part of the effect.
#[must_use]
pub fn spec() -> EffectSpec {
    EffectSpec {
        figures: Vec::new(),
        name: NAME.to_owned(),
        law: "q = eps sigma (T^4 - T_round^4) leaves the surface where it is free".to_owned(),
        source: "Carslaw & Jaeger, Conduction of Heat in Solids, 1.9".to_owned(),
        models: Vec::new(),
        consumes: field_names(&[&field::FRICTION_POWER]),
        provides: Vec::new(),
        keys: vec![
            KeySpec::number(EMISSIVITY, "emissivity of the surface")
                .required()
                .above(0.0)
                .at_most(1.0),
            KeySpec::quantity(TEMPERATURE, "K", "temperature of the surroundings")
                .expected(100.0..=3000.0, ABSOLUTE)
                .default_value(INITIAL_TEMPERATURE)
                .at_least(0.0),
        ],
    }
}

/// Reads the emissivity [-] and the temperature of the surroundings [K].
///
/// # Errors
/// A missing emissivity; a value that cannot be read.
pub fn read(case: &Params) -> Result<[f64; 2], Refusal> {
    let temperature = case.maybe_number(TEMPERATURE)?.unwrap_or(INITIAL_TEMPERATURE);
    Ok([case.number(EMISSIVITY)?, temperature])
}

/// Emissivity of oxidised steel, used if the case has none.
const TYPICAL: f64 = 0.8;
/// Stefan–Boltzmann constant σ [W/(m²·K⁴)].
const STEFAN_BOLTZMANN: f64 = 5.670_374_419e-8;

/// Estimates how much the effect matters in a scene.
#[must_use]
pub fn advise(situation: &Situation<'_>) -> Advice {
    let emissivity = situation.case.maybe_number(EMISSIVITY).ok().flatten().unwrap_or(TYPICAL);
    let body = situation.hotter();
    let (rise, initial) = (situation.rises[body], situation.scene.initial_temperatures[body]);
    // Effective coefficient between the hot surface and surroundings at the initial temperature.
    let hot = initial + rise;
    let coefficient =
        emissivity * STEFAN_BOLTZMANN * (hot * hot + initial * initial) * (hot + initial);
    let conduction = situation.scene.materials[body].conductivity / situation.semi_axes[0];
    let advice = Advice::new(NAME, format!("emissivity {emissivity} at the highest temperature"))
        .number("radiative ratio eps sigma T^3 a/lambda", coefficient / conduction)
        .with(format!("{EMISSIVITY}={emissivity}"));
    situation.moved(advice, body, situation.lost_to(coefficient))
}
