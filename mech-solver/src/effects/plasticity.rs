//! Effect `plasticity`: bodies flow plastically where the yield stress of their material is
//! reached.
//!
//! Yield surface of von Mises, linear isotropic and kinematic hardening, small plastic strains:
//! |dev S − a| = √(2/3) (σ_y + H_i κ), a = (2/3) H_k e with the plastic strain e. Material enters
//! the contact without plastic strain, so that the result applies to the first passage. The power
//! of plastic flow is reported in the summary (`contact.plastic_power_w`); the heat that it
//! generates below the surface is neglected.
//!
//! Source: Simo & Hughes, *Computational Inelasticity* (1998), chapter 3.

use crate::advice::situation::{PRESSURE, Situation};
use crate::case::keys::CheckedParams;
use crate::case::scene::Scene;
use crate::registry::entry::Effect;
use crate::terms::{Kind, Terms};
use explicit_fe::kernel::Flow;
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::figure::{FigureSpec, Style};

/// Registry entry of the effect.
pub const EFFECT: Effect = Effect {
    name: "plasticity",
    law: "|dev S - 2/3 H_k e| <= sqrt(2/3) (yield stress + H_i kappa), linear hardening",
    source: "Simo & Hughes, Computational Inelasticity (1998), chapter 3",
    kinds: &[Kind::Flow],
    consumes: &[],
    provides: &[],
    keys,
    figures,
    advise: Some(advise),
    terms,
};

const YIELD_STRESS: &str = "yield_stress";
const ISOTROPIC: &str = "isotropic_hardening";
const KINEMATIC: &str = "kinematic_hardening";

fn path(material: &str, key: &str) -> String {
    format!("materials.{material}.{key}")
}

fn keys() -> Vec<KeySpec> {
    let modulus = |key: &str, help: &str| {
        KeySpec::quantity(&path("*", key), "Pa", help).at_least(0.0).default_value(0.0)
    };
    vec![
        modulus(ISOTROPIC, "rise of the yield stress over plastic strain"),
        modulus(KINEMATIC, "modulus H_k with which the yield surface follows the plastic strain"),
    ]
}

fn figures() -> Vec<FigureSpec> {
    let figure = |name: &str, unit, words, short| {
        FigureSpec::new(&format!("contact.{name}"), unit, words).on("flow", short)
    };
    vec![
        figure("plastic_power_w", "W", "power of plastic flow", "power"),
        figure("max_plastic_strain", "1", "largest plastic strain behind the contact", "strain")
            .style(Style::Percent),
    ]
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let scene = Scene::read(&configuration.case)?;
    let own = CheckedParams::new(&configuration.case, keys());
    let mut flow = [None; 2];
    for (which, flow) in flow.iter_mut().enumerate() {
        let material = configuration.case.text(&scene.names.key(which, "material"))?;
        if let Some(yield_stress) = scene.bodies[which].yield_stress {
            let hardening = |key: &str| own.number(&path(material, key));
            let hardening = [hardening(ISOTROPIC)?, hardening(KINEMATIC)?];
            *flow = Some(Flow { yield_stress, hardening });
        }
    }
    if flow == [None; 2] {
        return Err(Refusal::new(
            "effects.plasticity",
            "no body has a material with a yield stress",
            "write materials.NAME.yield_stress, or remove the effect",
        ));
    }
    Ok(Terms { flow, ..Terms::default() })
}

/// Yield stress of rail steel [Pa], used if the case has none.
const TYPICAL: f64 = 600e6;
/// Ratio of the largest pressure to the shear yield stress at which rolling contact first yields
/// (Johnson, Contact Mechanics, 6.2).
const FIRST_YIELD: f64 = 2.8;

fn advise(situation: &Situation<'_>) -> Advice {
    let own =
        |material: &str| situation.case.maybe_number(&path(material, YIELD_STRESS)).ok().flatten();
    let materials = situation.materials();
    let softest = materials.iter().filter_map(|material| own(material)).reduce(f64::min);
    let shear = softest.unwrap_or(TYPICAL) / 3f64.sqrt();
    let ratio = situation.known(PRESSURE).map_or(f64::NAN, |pressure| pressure / shear);
    let advice = match ratio {
        _ if ratio.is_nan() => Advice::new(EFFECT.name, "p0/k is not known before a run"),
        _ if ratio > FIRST_YIELD => {
            let why = "p0/k above 2.8 yields in the first passage, above about 4 in every passage; the amount is not estimated";
            Advice::new(EFFECT.name, why).number("p0/k", ratio)
        }
        _ => {
            let advice = Advice::new(EFFECT.name, "p0/k below 2.8 stays elastic");
            advice.number("p0/k", ratio).moves(PRESSURE, 0.0)
        }
    };
    let set = materials.iter().filter(|material| own(material).is_none());
    set.fold(advice, |advice, material| {
        advice.with(format!("{}={TYPICAL:e}", path(material, YIELD_STRESS)))
    })
    .with(format!("effects.{}={{}}", EFFECT.name))
}
