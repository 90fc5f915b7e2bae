//! Effect `contact_conductance`: surfaces in contact have different temperatures, and heat flows
//! between them.
//!
//! The flux g = h (T_u − T_l) from the upper into the lower body is added to their shares of the
//! friction heat. The conductance h of the contact is constant, or that of rough surfaces with
//! plastic asperities, h = h₀ (p/H)^0.95, with the contact pressure p and the hardness H of the
//! softer body. Heat is exchanged wherever the surfaces are in contact, with or without friction.
//!
//! Separated surfaces exchange heat through the gas between them, if the model supports gaps. Then
//! h = k/(g + j) with the conductivity k of the gas, the gap g and the temperature jump distance j.
//! In the contact the gas conducts with g = 0, in addition to the contact itself.
//!
//! The limit h → ∞ is the partition `continuity`; for h → 0 no heat is exchanged.
//!
//! Source: Cooper, Mikic & Yovanovich, Int. J. Heat Mass Transfer 12 (1969) 279–300; exponent and
//! gas: Yovanovich, AIAA 81-1164 (1981).

use super::friction_heat::Partition;
use crate::capability::{Capability, Need};
use crate::situation::Situation;
use proto::advice::Advice;
use proto::configuration::Refusal;
use proto::description::{EffectSpec, KeySpec, names as field_names};
use proto::field;
use proto::figure::{FigureSpec, Style};
use proto::params::Params;
use proto::readable::number;

/// Name of the effect in the case file.
pub const NAME: &str = "contact_conductance";

const CONDUCTANCE: &str = "effects.contact_conductance.conductance";
pub(crate) const HARDNESS: &str = "effects.contact_conductance.hardness";
const GAS: &str = "effects.contact_conductance.gas_conductivity";
const JUMP: &str = "effects.contact_conductance.gas_jump";
/// Exponent of the pressure over the hardness.
const EXPONENT: f64 = 0.95;
/// Share of the largest pressure below which the conductance is held constant. Lower pressures
/// occur at the edge of an ellipse, and between two patches of a row, which is solved as a whole.
const LEAST: f64 = 1e-2;

/// Law of the contact conductance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductance {
    /// Conductance h, or h₀ [W/(m²·K)].
    pub conductance: f64,
    /// Hardness H [Pa]; `None` if the conductance does not depend on the pressure.
    pub hardness: Option<f64>,
    /// Conductivity k [W/(m·K)] and jump distance j [m] of a gas in the gap.
    pub gas: Option<[f64; 2]>,
}

impl Conductance {
    /// Reads the law, if the case has one.
    ///
    /// # Errors
    /// A value that is missing or not positive; the partition `continuity`, which leaves no
    /// temperature difference.
    pub fn read(case: &Params, partition: Partition) -> Result<Option<Self>, Refusal> {
        if !case.has("effects.contact_conductance") {
            return Ok(None);
        }
        if partition == Partition::Continuity {
            return Err(Refusal::new(
                "effects.contact_conductance",
                "surfaces of equal temperature have no conductance between them",
                "write effects.friction_heat.partition = \"equal\", or remove the effect",
            ));
        }
        let above_zero = |key: &str, value: f64| match value > 0.0 {
            true => Ok(value),
            false => {
                let reason = format!("{value} is not greater than 0");
                Err(Refusal::new(key, reason, "write a positive number"))
            }
        };
        let conductance = above_zero(CONDUCTANCE, case.number(CONDUCTANCE)?)?;
        let hardness = case.maybe_number(HARDNESS)?;
        let hardness = hardness.map(|value| above_zero(HARDNESS, value)).transpose()?;
        let gas = case.maybe_number(GAS)?;
        let gas = match gas.map(|value| above_zero(GAS, value)).transpose()? {
            Some(conductivity) => Some([conductivity, above_zero(JUMP, case.number(JUMP)?)?]),
            None => None,
        };
        Ok(Some(Self { conductance, hardness, gas }))
    }

    /// Resistance 1/h [m²·K/W] at a pressure, for the given largest pressure of the contact [Pa].
    #[must_use]
    pub fn resistance(&self, pressure: f64, largest: f64) -> f64 {
        let Some(hardness) = self.hardness else { return 1.0 / self.conductance };
        let pressure = pressure.max(LEAST * largest);
        1.0 / (self.conductance * (pressure / hardness).powf(EXPONENT))
    }

    /// Conductance [W/(m²·K)] of surfaces in contact under a pressure [Pa], or separated by a gap
    /// [m].
    #[must_use]
    pub fn across(&self, pressure: f64, gap: f64) -> f64 {
        let gas = self.gas.map_or(0.0, |[conductivity, jump]| conductivity / (gap + jump));
        let touching = if pressure > 0.0 { 1.0 / self.resistance(pressure, 0.0) } else { 0.0 };
        gas + touching
    }
}

/// Returns the capabilities required by the values of the keys: gaps, if a gas conducts through
/// them.
pub fn needs_of_values(case: &Params) -> Result<Vec<Need>, Refusal> {
    let gas = Need { key: GAS, capability: Capability::Gaps, instead: Some("remove the key") };
    Ok(if case.has(GAS) { vec![gas] } else { Vec::new() })
}

/// Returns the thermal participant's part of the effect.
#[must_use]
pub fn spec() -> EffectSpec {
    EffectSpec {
        figures: vec![
            FigureSpec::new("exchange.heat_w", "W", "heat from the upper into the lower body")
                .on("exchange", "heat downwards")
                .style(Style::Signed),
        ],
        name: NAME.to_owned(),
        law: "g = h (T_u - T_l) from the upper into the lower body where they touch; h constant, or h_0 (p/H)^0.95"
            .to_owned(),
        source: "Cooper, Mikic & Yovanovich, Int. J. Heat Mass Transfer 12 (1969) 279-300; Yovanovich, AIAA 81-1164 (1981)"
            .to_owned(),
        models: Vec::new(),
        consumes: field_names(&[&field::PRESSURE]),
        provides: Vec::new(),
        keys: vec![
            KeySpec::quantity(CONDUCTANCE, "W/(m2 K)", "conductance h; with a hardness h_0, the conductance at p = H")
                .required()
                .above(0.0),
            KeySpec::quantity(HARDNESS, "Pa", "hardness H of the softer body; absent: h does not depend on the pressure")
                .above(0.0),
            KeySpec::quantity(GAS, "W/(m K)", "conductivity of the gas in the gap; absent: no heat flows through a gap")
                .above(0.0)
                .together("gas"),
            KeySpec::quantity(JUMP, "m", "temperature jump distance of the gas, on both surfaces together")
                .above(0.0)
                .together("gas"),
        ],
    }
}

/// Conductance of steel on steel under a wheel, used if the case has none [W/(m²·K)].
const TYPICAL: f64 = 1e5;

/// Estimates how much the effect matters in a scene.
#[must_use]
pub fn advise(situation: &Situation<'_>) -> Advice {
    let [upper, lower] = situation.rises;
    let hotter = situation.hotter();
    let difference = (upper - lower).abs() / situation.rises[hotter].max(f64::MIN_POSITIVE);
    let given = situation.case.maybe_number(CONDUCTANCE).ok().flatten();
    let conductance = given.unwrap_or(TYPICAL);
    let area = std::f64::consts::PI * situation.semi_axes[0] * situation.semi_axes[1];
    let resistance: f64 = (0..2)
        .map(|body| situation.rises[body] * area / situation.heat[body].max(f64::MIN_POSITIVE))
        .sum();
    let biot = conductance * resistance;
    // The exchanged heat reduces the difference as far as the contact conducts.
    let why = format!(
        "difference of the flash temperatures, {:.1} %, evened out by {conductance} W/(m2 K)",
        100.0 * difference,
        conductance = number(conductance, 1)
    );
    let advice = Advice::new(NAME, why)
        .number("conductance times the bodies' resistance", biot)
        .with(format!("{CONDUCTANCE}={conductance:e}"));
    situation.moved(advice, hotter, -0.5 * difference * biot / (1.0 + biot))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_law() {
        let case = |table: serde_json::Value| Params(json!({"effects": {NAME: table}}));
        let read = |table| Conductance::read(&case(table), Partition::Equal);
        let constant = read(json!({"conductance": 1e5})).unwrap().unwrap();
        assert_eq!(constant.resistance(7.0, 9.0), 1e-5);
        let rough = read(json!({"conductance": 1e5, "hardness": 2e9})).unwrap().unwrap();
        assert!((rough.resistance(2e9, 2e9) / 1e-5 - 1.0).abs() < 1e-15);
        let ratio = rough.resistance(1e8, 2e9) / rough.resistance(2e8, 2e9);
        assert!((ratio - 2f64.powf(0.95)).abs() < 1e-12);
        assert_eq!(rough.resistance(0.0, 2e9), rough.resistance(2e7, 2e9));
        assert!((rough.across(2e9, 0.0) / 1e5 - 1.0).abs() < 1e-15);
        let gas = read(json!({"conductance": 1e5, "gas_conductivity": 0.03, "gas_jump": 1e-6}));
        let gas = gas.unwrap().unwrap();
        assert!((gas.across(0.0, 2e-6) / 1e4 - 1.0).abs() < 1e-15);
        assert!((gas.across(1.0, 0.0) / 1.3e5 - 1.0).abs() < 1e-15);
        assert_eq!(Conductance::read(&Params(json!({})), Partition::Equal), Ok(None));
        assert_eq!(read(json!({"conductance": 0.0})).unwrap_err().key, CONDUCTANCE);
        let one = Conductance::read(&case(json!({"conductance": 1.0})), Partition::Continuity);
        assert!(one.unwrap_err().reason.contains("equal temperature"));
    }
}
