//! The effects that the thermal participant takes part in: one file an effect, one line here.

pub mod friction_heat;

use proto::description::EffectSpec;

/// An effect of the list.
#[derive(Clone, Copy, Debug)]
pub struct Effect {
    /// Name in the case file.
    pub name: &'static str,
    /// Its description.
    pub spec: fn() -> EffectSpec,
}

/// All effects.
pub const REGISTRY: &[Effect] = &[Effect { name: friction_heat::NAME, spec: friction_heat::spec }];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models;

    #[test]
    fn descriptions_agree_with_the_lists() {
        for (i, effect) in REGISTRY.iter().enumerate() {
            let spec = (effect.spec)();
            assert_eq!(spec.name, effect.name);
            assert!(!spec.source.is_empty() && !spec.law.is_empty());
            assert!(REGISTRY[..i].iter().all(|other| other.name != effect.name));
            for model in &spec.models {
                assert!(models::REGISTRY.iter().any(|known| known.name == model), "{model}");
            }
            for field in spec.consumes.iter().chain(&spec.provides) {
                assert!(proto::field::find(field).is_some(), "{field}");
            }
        }
    }
}
