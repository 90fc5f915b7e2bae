//! Effect `volume_temperature`: output of the temperature rise of every element of both bodies, for
//! ParaView.
//!
//! The elements cover the rows of the heat flux, from behind the contact to its front, down to the
//! last layer. The effect does not change the solution; its only cost is the output.

use crate::situation::Situation;
use proto::advice::Advice;
use proto::description::{EffectSpec, names as field_names};
use proto::field::{self, Body, FieldSpec, Mapping};

/// Name of the effect in the case file.
pub const NAME: &str = "volume_temperature";

/// Temperature rises of the upper and the lower body.
pub const VOLUMES: [FieldSpec; 2] = [
    volume(
        "upper_volume_temperature",
        Body::Upper,
        "temperature rise of the upper body's elements",
    ),
    volume(
        "lower_volume_temperature",
        Body::Lower,
        "temperature rise of the lower body's elements",
    ),
];

const fn volume(name: &'static str, body: Body, meaning: &'static str) -> FieldSpec {
    FieldSpec { name, unit: "K", components: 1, mapping: Mapping::Consistent, body, meaning }
}

/// Returns the thermal participant's part of the effect.
#[must_use]
pub fn spec() -> EffectSpec {
    EffectSpec {
        figures: Vec::new(),
        name: NAME.to_owned(),
        law: "the temperature rise of every element of both bodies".to_owned(),
        source: "docs/theory/fe.md".to_owned(),
        models: Vec::new(),
        consumes: field_names(&[&field::FRICTION_POWER]),
        provides: field_names(&[&VOLUMES[1], &VOLUMES[0]]),
        keys: Vec::new(),
    }
}

/// Estimates how much the effect matters in a scene.
#[must_use]
pub fn advise(situation: &Situation<'_>) -> Advice {
    let body = situation.hotter();
    Advice::new(NAME, "output of the temperatures of the elements; the solution does not change")
        .moves(situation.rise_of(body), 0.0)
        .with(format!("effects.{NAME}={{}}"))
}
