//! Effects that involve the thermal participant, one file and one registry entry each.

pub mod bulk_heating;
pub mod contact_conductance;
pub mod convection;
pub mod friction_heat;
pub mod integrated;
pub mod joule_heat;
pub mod phase_transformation;
pub mod radiation;
pub mod temperature_material;
pub mod thermal_expansion;
pub mod thermal_softening;
pub mod volume_temperature;

use crate::capability::{Capability, Need};
use crate::scene::Scene;
use crate::situation::Situation;
use heat::fe::body_properties::BodyProperties;
use heat::fe::conductor::Surroundings;
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::{EffectSpec, Renamed};
use proto::params::Params;

/// Function that returns the capabilities required by the values of an effect's keys.
pub type NeedsOfValues = fn(&Params) -> Result<Vec<Need>, Refusal>;

/// Entry of the registry list.
#[derive(Clone, Copy, Debug)]
pub struct Effect {
    /// Name of the effect in the case file.
    pub name: &'static str,
    /// Returns the description of the effect, without the models that support it.
    pub spec: fn() -> EffectSpec,
    /// Capabilities that a model needs to support the effect.
    pub needs: &'static [Capability],
    /// Further capabilities that depend on the values of its keys.
    pub needs_of_values: Option<NeedsOfValues>,
    /// Estimates how much the effect matters in a scene.
    pub advise: Option<fn(&Situation<'_>) -> Advice>,
}

/// All effects.
pub const REGISTRY: &[Effect] = &[
    Effect {
        name: friction_heat::NAME,
        spec: friction_heat::spec,
        needs: &[],
        needs_of_values: Some(friction_heat::needs_of_values),
        advise: Some(friction_heat::advise),
    },
    Effect {
        name: temperature_material::NAME,
        spec: temperature_material::spec,
        needs: &[Capability::VaryingProperties],
        needs_of_values: None,
        advise: Some(temperature_material::advise),
    },
    Effect {
        name: thermal_expansion::NAME,
        spec: thermal_expansion::spec,
        needs: &[Capability::RiseIntegrals],
        needs_of_values: None,
        advise: Some(thermal_expansion::advise),
    },
    Effect {
        name: thermal_softening::NAME,
        spec: thermal_softening::spec,
        needs: &[Capability::RiseIntegrals],
        needs_of_values: None,
        advise: Some(thermal_softening::advise),
    },
    Effect {
        name: contact_conductance::NAME,
        spec: contact_conductance::spec,
        needs: &[Capability::Exchange],
        needs_of_values: Some(contact_conductance::needs_of_values),
        advise: Some(contact_conductance::advise),
    },
    Effect {
        name: convection::NAME,
        spec: convection::spec,
        needs: &[Capability::FreeSurfaces],
        needs_of_values: None,
        advise: Some(convection::advise),
    },
    Effect {
        name: radiation::NAME,
        spec: radiation::spec,
        needs: &[Capability::FreeSurfaces],
        needs_of_values: None,
        advise: Some(radiation::advise),
    },
    Effect {
        name: bulk_heating::NAME,
        spec: bulk_heating::spec,
        needs: &[Capability::EarlierPassages],
        needs_of_values: None,
        advise: Some(bulk_heating::advise),
    },
    Effect {
        name: phase_transformation::NAME,
        spec: phase_transformation::spec,
        needs: &[],
        needs_of_values: None,
        advise: Some(phase_transformation::advise),
    },
    Effect {
        name: joule_heat::NAME,
        spec: joule_heat::spec,
        needs: &[Capability::Potentials],
        needs_of_values: None,
        advise: Some(joule_heat::advise),
    },
    Effect {
        name: volume_temperature::NAME,
        spec: volume_temperature::spec,
        needs: &[Capability::Volumes],
        needs_of_values: None,
        advise: Some(volume_temperature::advise),
    },
];

/// Returns the keys of version 0.1 that have been replaced.
#[must_use]
pub fn renamed() -> Vec<Renamed> {
    let to = "[effects.contact_conductance] with its conductance";
    vec![Renamed::new("effects.friction_heat.conductance", to)]
}

/// Reads the properties and the surroundings of the upper and the lower body, with the effects of
/// the case.
///
/// # Errors
/// A value that is missing or out of range; a table that cannot be read.
pub fn body_properties(
    given: &Configuration,
    scene: &Scene,
) -> Result<[BodyProperties; 2], Refusal> {
    let case = &given.case;
    let mut surroundings = Surroundings::default();
    if given.has_effect(convection::NAME) {
        surroundings.convection = convection::read(case)?;
    }
    if given.has_effect(radiation::NAME) {
        surroundings.radiation = radiation::read(case)?;
    }
    let (mut points, mut clamps) = ([Vec::new(), Vec::new()], false);
    if given.has_effect(temperature_material::NAME) {
        (points, clamps) = temperature_material::read(case, scene)?;
    }
    let (materials, initial) = (&scene.materials, &scene.initial_temperatures);
    let bodies = points.into_iter().zip(materials.iter().zip(initial));
    let body_properties: Vec<BodyProperties> = bodies
        .map(|(points, (material, initial))| BodyProperties {
            material: *material,
            points,
            initial: *initial,
            clamps,
            surroundings,
        })
        .collect();
    Ok(body_properties.try_into().expect("two bodies"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn descriptions_agree_with_the_lists() {
        for (i, effect) in REGISTRY.iter().enumerate() {
            let spec = (effect.spec)();
            assert_eq!(spec.name, effect.name);
            assert!(!spec.source.is_empty() && !spec.law.is_empty());
            assert!(REGISTRY[..i].iter().all(|other| other.name != effect.name));
            for field in spec.consumes.iter().chain(&spec.provides) {
                let own = volume_temperature::VOLUMES.iter().any(|spec| spec.name == field);
                assert!(own || proto::field::find(field).is_some(), "{field}");
            }
        }
    }
}
