//! Effect `thermal_expansion`: warm material expands, and the surface rises.
//!
//! The traction-free surface of a half-space rises by u = 2(1 + ν)α W, with the coefficient of
//! thermal expansion α. The thermal side provides the depth integral W of the temperature rise, in
//! which a wave number k is weighted by e^{−kz}. For half-spaces the undeformed distance is reduced
//! by the rise of both surfaces.
//!
//! Finite elements have an isotropic strain αϑ in their first layer, whose integral over the layer
//! is αW. The heat is far thinner than the elements. The surface therefore rises and stretches as
//! if the heat were half an element deep, which is less the coarser the elements are.
//!
//! A rod with free sides becomes longer by αW.
//!
//! The effect closes a coupling loop: heat changes the contact, and the contact changes the heat.
//!
//! Source: Barber, *Elasticity* (2010), thermoelastic displacement potentials. Neglected for
//! half-spaces: the stretching along the surface, which causes a slip of the order of the
//! difference of αϑ between the surfaces. Thermal stress is included in the sections of half-spaces
//! ([`super::subsurface_stress`]), and in the stress of finite elements as far as their first layer
//! resolves it.

use crate::case::keys::CheckedParams;
use crate::registry::entry::Effect;
use crate::terms::{Kind, Terms};
use proto::bodies::Bodies;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::field;

/// Registry entry of the effect.
pub const EFFECT: Effect = Effect {
    name: "thermal_expansion",
    law: "u(k) = 2 (1 + nu) alpha int T(k, z) exp(-k z) dz; in finite elements a strain alpha T; \
          thermal stress in sections of half-spaces",
    source: "Barber, Elasticity (2010), thermoelastic displacement potentials",
    kinds: &[Kind::Expansion],
    consumes: &[&field::UPPER_RISE_INTEGRAL, &field::LOWER_RISE_INTEGRAL],
    provides: &[],
    keys,
    figures: Vec::new,
    advise: None,
    terms,
};

const COEFFICIENT: &str = "thermal_expansion";

fn path(material: &str) -> String {
    format!("materials.{material}.{COEFFICIENT}")
}

fn keys() -> Vec<KeySpec> {
    let help = "coefficient of linear thermal expansion";
    vec![KeySpec::quantity(&path("*"), "1/K", help).required().at_least(0.0)]
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let names = Bodies::read(&configuration.case)?;
    let own = CheckedParams::new(&configuration.case, keys());
    let of = |which: usize| {
        let material = configuration.case.text(&names.key(which, "material"))?;
        own.number(&path(material))
    };
    Ok(Terms { expansion: Some([of(0)?, of(1)?]), ..Terms::default() })
}
