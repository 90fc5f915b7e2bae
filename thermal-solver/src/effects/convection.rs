//! Effect `convection`: the free surface loses the flux h (T − T∞) to the air.
//!
//! The surface is free wherever no heat enters it in the row of elements: ahead of the contact,
//! beside it and behind it. Source: Carslaw & Jaeger, Conduction of Heat in Solids, 1.9.

use crate::situation::Situation;
use proto::advice::Advice;
use proto::bodies::{ABSOLUTE, INITIAL_TEMPERATURE};
use proto::configuration::Refusal;
use proto::description::{EffectSpec, KeySpec, names as field_names};
use proto::field;
use proto::params::Params;

/// Name of the effect in the case file.
pub const NAME: &str = "convection";

const COEFFICIENT: &str = "effects.convection.coefficient";
const TEMPERATURE: &str = "effects.convection.temperature";

/// Returns the thermal participant's part of the effect.
#[must_use]
pub fn spec() -> EffectSpec {
    EffectSpec {
        figures: Vec::new(),
        name: NAME.to_owned(),
        law: "q = h (T - T_air) leaves the surface where it is free".to_owned(),
        source: "Carslaw & Jaeger, Conduction of Heat in Solids, 1.9".to_owned(),
        models: Vec::new(),
        consumes: field_names(&[&field::FRICTION_POWER]),
        provides: Vec::new(),
        keys: vec![
            KeySpec::quantity(COEFFICIENT, "W/(m2 K)", "coefficient h of convection")
                .required()
                .above(0.0),
            KeySpec::quantity(TEMPERATURE, "K", "temperature of the air")
                .expected(100.0..=3000.0, ABSOLUTE)
                .default_value(INITIAL_TEMPERATURE)
                .at_least(0.0),
        ],
    }
}

/// Reads the heat transfer coefficient [W/(m²·K)] and the temperature of the air [K].
///
/// # Errors
/// A missing coefficient; a value that cannot be read.
pub fn read(case: &Params) -> Result<[f64; 2], Refusal> {
    let temperature = case.maybe_number(TEMPERATURE)?.unwrap_or(INITIAL_TEMPERATURE);
    Ok([case.number(COEFFICIENT)?, temperature])
}

/// Coefficient for fast air flow, used if the case has none [W/(m²·K)].
const TYPICAL: f64 = 50.0;

/// Estimates how much the effect matters in a scene.
#[must_use]
pub fn advise(situation: &Situation<'_>) -> Advice {
    let coefficient = situation.case.maybe_number(COEFFICIENT).ok().flatten().unwrap_or(TYPICAL);
    let lost = situation.lost_to(coefficient);
    let body = situation.hotter();
    let advice =
        Advice::new(NAME, format!("{coefficient} W/(m2 K) while a place passes the contact"))
            .number(
                "Biot number h a/lambda",
                coefficient * situation.semi_axes[0] / situation.scene.materials[body].conductivity,
            )
            .with(format!("{COEFFICIENT}={coefficient}"));
    situation.moved(advice, body, lost)
}
