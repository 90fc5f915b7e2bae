//! Effect `thermal_softening`: stiffness and yield stress of the mechanics fall with the temperature.
//!
//! Here what the mechanics needs for it is provided ([`super::integrated`]).

use super::integrated;
use crate::situation::Situation;
use proto::advice::Advice;
use proto::description::EffectSpec;

/// Name in the case file.
pub const NAME: &str = integrated::SOFTENING;

/// The thermal participant's part of the effect.
#[must_use]
pub fn spec() -> EffectSpec {
    integrated::spec(NAME)
}

/// Temperature from which on the modulus of carbon steel falls [K], and by how much of it with every kelvin (EN 1993-1-2, table 3.1).
const FALLS: (f64, f64) = (373.15, 1e-3);
/// p₀ over a modulus that falls everywhere, to this power (Hertz).
const HERTZ: f64 = 2.0 / 3.0;

/// What it says of itself in a scene.
#[must_use]
pub fn advise(situation: &Situation<'_>) -> Advice {
    let body = situation.hotter();
    let hottest = situation.scene.initial_temperatures[body] + situation.rises[body];
    let (from, slope) = FALLS;
    let lost = (slope * (hottest - from)).clamp(0.0, 1.0);
    // What carries a contact is about as deep as it is wide; heat is in a part of that.
    let [_, b] = situation.semi_axes;
    let depth = match situation.rises[body] > 0.0 {
        true => situation.rise_integral(body) / situation.rises[body],
        false => 0.0,
    };
    let why = "share of the modulus lost at the surface (EN 1993-1-2), in a skin as deep as the heat; needs a softening_table and explicit-fe";
    Advice::new(NAME, why)
        .number("modulus lost at the surface", lost)
        .moves("contact.max_pressure_pa", -HERTZ * lost * (depth / b).min(1.0))
}
