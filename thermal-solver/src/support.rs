//! Models that support an effect: those with all capabilities that it needs.

use crate::capability::Capability;
use crate::effects::{self, Effect};
use crate::models::{self, Entry};
use proto::configuration::{Configuration, Refusal};
use proto::description::EffectSpec;

/// Returns the models that have all of these capabilities.
fn models_that_can(needs: &[Capability]) -> impl Iterator<Item = &'static Entry> {
    let can_all = |model: &&Entry| needs.iter().all(|need| model.capabilities.contains(need));
    models::REGISTRY.iter().filter(can_all)
}

/// Describes an effect, with the models that support it.
pub(crate) fn description(effect: &Effect) -> EffectSpec {
    let models = models_that_can(effect.needs).map(|model| model.name.to_owned()).collect();
    EffectSpec { models, ..(effect.spec)() }
}

/// Refuses effects, and values of their keys, that need a capability which the model lacks.
///
/// # Errors
/// A capability that the model lacks; a value that cannot be read.
pub(crate) fn refuse_needs(given: &Configuration, model: &Entry) -> Result<(), Refusal> {
    let refused = |key: &str, capability: Capability, instead: Option<&str>| {
        let first = models_that_can(&[capability]).next().expect("a model has each capability");
        let reason = format!("model `{}` {}", model.name, capability.lack());
        let instead = instead.map_or(String::new(), |instead| format!(", or {instead}"));
        let fix = format!("write [thermal] model = \"{}\"{instead}", first.name);
        Err(Refusal::new(key, reason, fix))
    };
    let lacks = |capability: &Capability| !model.capabilities.contains(capability);
    for effect in effects::REGISTRY.iter().filter(|effect| given.has_effect(effect.name)) {
        if let Some(need) = effect.needs.iter().copied().find(lacks) {
            return refused(&format!("effects.{}", effect.name), need, Some("remove the effect"));
        }
        let needs = effect.needs_of_values.map_or(Ok(Vec::new()), |needs| needs(&given.case))?;
        if let Some(need) = needs.into_iter().find(|need| lacks(&need.capability)) {
            return refused(need.key, need.capability, need.instead);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_has_a_model() {
        for effect in effects::REGISTRY {
            assert!(!description(effect).models.is_empty(), "{}", effect.name);
        }
    }
}
