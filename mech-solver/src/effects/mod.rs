//! The effects by name. An effect is a file of this folder, with its law and its code, and one line
//! in [`EFFECTS`]. An effect that a case does not name leaves no trace at run time.

pub mod friction_heat;
pub mod partial_slip;
pub mod roughness;
pub mod subsurface_stress;
pub mod temperature_friction;
pub mod third_body_layer;

use proto::configuration::{Configuration, Refusal};
use proto::description::EffectSpec;

/// Every effect of this crate.
pub const EFFECTS: &[fn() -> EffectSpec] = &[
    friction_heat::spec,
    partial_slip::spec,
    roughness::spec,
    subsurface_stress::spec,
    temperature_friction::spec,
    third_body_layer::spec,
];

/// The active effects of a configuration.
///
/// # Errors
/// Refuses an effect that is not in [`EFFECTS`] or that the chosen model does not support.
pub fn active(configuration: &Configuration) -> Result<Vec<EffectSpec>, Refusal> {
    let table = configuration.case.get("effects").and_then(serde_json::Value::as_object);
    table.into_iter().flatten().map(|(name, _)| supported(name, &configuration.model)).collect()
}

fn supported(name: &str, model: &str) -> Result<EffectSpec, Refusal> {
    let key = format!("effects.{name}");
    let mut specs = EFFECTS.iter().map(|spec| spec());
    let Some(effect) = specs.find(|effect| effect.name == name) else {
        let known: Vec<_> = EFFECTS.iter().map(|spec| spec().name).collect();
        let reason = "there is no such effect in the mechanics";
        return Err(Refusal::new(&key, reason, format!("known are {}", known.join(", "))));
    };
    if effect.models.iter().any(|supporting| supporting == model) {
        return Ok(effect);
    }
    let fix = format!("choose one of {} or remove the effect", effect.models.join(", "));
    Err(Refusal::new(&key, format!("the model `{model}` does not support it"), fix))
}
