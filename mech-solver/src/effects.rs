//! Effects by name. An effect is a file of this folder, with its law and its terms, and one line in
//! [`EFFECTS`]. An effect that the case does not name has no influence at run time.

pub mod friction_bands;
pub mod friction_heat;
pub mod partial_slip;
pub mod plastic_layer;
pub mod plasticity;
pub mod pressure_limit;
pub mod roughness;
pub mod shear_limit;
pub mod speed_friction;
pub mod stress_at_points;
pub mod subsurface_stress;
pub mod suspension;
pub mod temperature_friction;
pub mod thermal_expansion;
pub mod thermal_softening;
pub mod third_body_layer;
pub mod viscoelasticity;
pub mod viscous_layer;
pub mod wear;

use crate::registry::entry::Effect;
use crate::terms::{Kind, Terms};
use proto::configuration::{Configuration, Refusal};

/// Every effect of this crate.
pub const EFFECTS: &[Effect] = &[
    friction_bands::EFFECT,
    friction_heat::EFFECT,
    partial_slip::EFFECT,
    plastic_layer::EFFECT,
    plasticity::EFFECT,
    pressure_limit::EFFECT,
    roughness::EFFECT,
    shear_limit::EFFECT,
    speed_friction::EFFECT,
    stress_at_points::EFFECT,
    subsurface_stress::EFFECT,
    suspension::EFFECT,
    temperature_friction::EFFECT,
    thermal_expansion::EFFECT,
    thermal_softening::EFFECT,
    third_body_layer::EFFECT,
    viscoelasticity::EFFECT,
    viscous_layer::EFFECT,
    wear::EFFECT,
];

/// Collects the terms of effects of a configuration.
///
/// # Errors
/// A value that an effect refuses; two effects that exclude each other.
pub(crate) fn terms(
    effects: &[&'static Effect],
    configuration: &Configuration,
) -> Result<Terms, Refusal> {
    let mut terms = Terms::default();
    for effect in effects {
        terms.join(effect.name, effect.kinds, (effect.terms)(configuration)?)?;
    }
    Ok(terms)
}

/// Names of the effects that create terms of a kind.
pub(crate) fn of_kind(kind: Kind) -> impl Iterator<Item = &'static str> {
    EFFECTS.iter().filter(move |effect| effect.kinds.contains(&kind)).map(|effect| effect.name)
}

/// Returns the refusal of a case that needs an effect of this kind, and has none.
pub(crate) fn lacking(kind: Kind, reason: &str) -> Refusal {
    let names: Vec<_> = of_kind(kind).collect();
    let fix: Vec<_> = names.iter().map(|name| format!("[effects.{name}]")).collect();
    let key = format!("effects.{}", names.first().copied().unwrap_or_default());
    Refusal::new(&key, reason, format!("add {}", fix.join(" or ")))
}

/// Returns the beginning of a sentence on the behaviour without the effects of a kind.
pub(crate) fn without(kind: Kind) -> String {
    let names: Vec<_> = of_kind(kind).map(|name| format!("effects.{name}")).collect();
    if names.is_empty() { String::new() } else { format!("without {}: ", names.join(" and ")) }
}
