//! Effect `thermal_softening`: stiffness and yield stress of the mechanics fall with the
//! temperature.
//!
//! This module provides the input that the mechanics needs ([`super::integrated`]).

use super::integrated;
use crate::situation::Situation;
use crate::{LOWER, UPPER};
use proto::advice::Advice;
use proto::description::EffectSpec;
use proto::figure::contact::MAX_PRESSURE;

/// Name of the effect in the case file.
pub const NAME: &str = integrated::SOFTENING;

/// Returns the thermal participant's part of the effect.
#[must_use]
pub fn spec() -> EffectSpec {
    integrated::spec(NAME)
}

/// Share of Young's modulus that carbon steel retains at a temperature [K] (EN 1993-1-2, table
/// 3.1).
const STEEL: [(f64, f64); 9] = [
    (373.15, 1.0),
    (473.15, 0.9),
    (573.15, 0.8),
    (673.15, 0.7),
    (773.15, 0.6),
    (873.15, 0.31),
    (973.15, 0.13),
    (1073.15, 0.09),
    (1273.15, 0.045),
];
/// Exponent of a uniform modulus in the Hertz pressure p₀.
const HERTZ: f64 = 2.0 / 3.0;

/// Share of Young's modulus that carbon steel retains at a temperature [K], interpolated linearly
/// in the table.
fn kept(temperature: f64) -> f64 {
    let next = STEEL.partition_point(|(at, _)| *at <= temperature);
    let (low, high) = (STEEL[next.saturating_sub(1)], STEEL[next.min(STEEL.len() - 1)]);
    let length = high.0 - low.0;
    let part = if length > 0.0 { (temperature - low.0) / length } else { 0.0 };
    low.1 + part * (high.1 - low.1)
}

/// Estimates how much the effect matters in a scene.
#[must_use]
pub fn advise(situation: &Situation<'_>) -> Advice {
    // Mean modulus over the depth that carries the contact, which is about its width: hot within
    // the heated depth, at the initial temperature below it.
    let [_, b] = situation.semi_axes;
    let shares = [UPPER, LOWER].map(|body| {
        let (rise, initial) = (situation.rises[body], situation.scene.initial_temperatures[body]);
        let depth = if rise > 0.0 { situation.rise_integral(body) / rise } else { 0.0 };
        let [cold, hot] = [kept(initial), kept(initial + rise)];
        [cold - (cold - hot) * (depth / b).min(1.0), hot]
    });
    // Both bodies contribute equally to the compliance.
    let compliance = 0.5 * shares.iter().map(|[share, _]| share.recip()).sum::<f64>();
    let least = shares.iter().map(|[_, hot]| *hot).fold(1.0, f64::min);
    let why = "Young's modulus at the initial temperature, and within the heated depth at the surface temperature (EN 1993-1-2); needs a softening_table and explicit-fe";
    Advice::new(NAME, why)
        .number("modulus lost at the surface", 1.0 - least)
        .moves(MAX_PRESSURE, compliance.powf(-HERTZ) - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values at lines of the table, between them, and beyond its ends, where the ends hold.
    /// Tolerance: rounding.
    #[test]
    fn the_modulus_of_steel() {
        for (temperature, share) in [
            (293.15, 1.0),
            (373.15, 1.0),
            (523.15, 0.85),
            (823.15, 0.455),
            (1273.15, 0.045),
            (2e3, 0.045),
        ] {
            assert!(
                (kept(temperature) - share).abs() < 1e-12,
                "{temperature} {}",
                kept(temperature)
            );
        }
    }
}
