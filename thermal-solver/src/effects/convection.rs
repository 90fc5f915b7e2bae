//! Effect `convection`: the free surface gives h (T − T∞) to the air.
//!
//! The surface is free where no heat enters it in the row of elements: before the contact, beside and behind it.
//! Source: Carslaw & Jaeger, Conduction of Heat in Solids, 1.9.

use crate::models::names;
use proto::bodies::INITIAL_TEMPERATURE;
use proto::configuration::Refusal;
use proto::description::{EffectSpec, KeySpec, names as field_names};
use proto::field;
use proto::params::Params;

/// Name in the case file.
pub const NAME: &str = "convection";

const COEFFICIENT: &str = "effects.convection.coefficient";
const TEMPERATURE: &str = "effects.convection.temperature";

/// The thermal participant's part of the effect.
#[must_use]
pub fn spec() -> EffectSpec {
    EffectSpec {
        figures: Vec::new(),
        name: NAME.to_owned(),
        law: "q = h (T - T_air) leaves the surface where it is free".to_owned(),
        source: "Carslaw & Jaeger, Conduction of Heat in Solids, 1.9".to_owned(),
        models: vec![names::FE.to_owned()],
        consumes: field_names(&[&field::FRICTION_POWER]),
        provides: Vec::new(),
        keys: vec![
            KeySpec::quantity(COEFFICIENT, "W/(m2 K)", "coefficient h of convection")
                .required()
                .above(0.0),
            KeySpec::quantity(TEMPERATURE, "K", "temperature of the air")
                .default_value(INITIAL_TEMPERATURE)
                .at_least(0.0),
        ],
    }
}

/// Coefficient [W/(m²·K)] and temperature of the air [K].
pub fn read(case: &Params) -> Result<[f64; 2], Refusal> {
    let temperature = case.maybe_number(TEMPERATURE)?.unwrap_or(INITIAL_TEMPERATURE);
    Ok([case.number(COEFFICIENT)?, temperature])
}
