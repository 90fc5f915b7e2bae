//! Effect `wear`: the contact removes material from both bodies, and the next contact has the worn
//! profiles.
//!
//! The worn volume is k per joule of friction work (energy), or K/H times load and sliding distance
//! (Archard). The accumulation of passages and the evolution of a profile are described in
//! [`crate::terms::removal`]. A steady case returns the wear of one passage. In a sequence every
//! row stands for a number of passages, and the worn profiles of both bodies are used in the next
//! row. Friction heat is unchanged; the share that goes into wear particles is set by
//! `effects.friction_heat.heat_share`.
//!
//! Source: Archard, J. Appl. Phys. 24 (1953) 981–988; Pearce & Sherratt, Wear 144 (1991) 343–351;
//! Lewis & Olofsson, Wear 257 (2004) 721–729, for the regimes of rail and wheel steel. Neglected:
//! wear particles that stay in the contact, and wear that varies around the circumference.

use crate::advice::situation::{POWER, PRESSURE, Situation};
use crate::case::keys::CheckedParams;
use crate::case::scene::Scene;
use crate::registry::entry::Effect;
use crate::terms::removal::{Law, Removal};
use crate::terms::{Kind, Terms};
use proto::figure::contact::SEMI_AXIS_B;
use proto::readable::number;

use proto::advice::Advice;
use proto::configuration::{Configuration, Mode, Refusal};
use proto::description::KeySpec;
use proto::field::{self, FieldSpec};
use proto::figure::FigureSpec;
use std::f64::consts::PI;

/// Registry entry of the effect.
pub const EFFECT: Effect = Effect {
    name: NAME,
    law: "depth of a passage h(y) = int k q_f dx/v, or int (K/H) p |s| dx/v (Archard), added to the \
          undeformed distance",
    source: "Archard, J. Appl. Phys. 24 (1953) 981-988; Pearce & Sherratt, Wear 144 (1991) 343-351",
    kinds: &[Kind::Removal],
    consumes: &[],
    provides: &DEPTHS,
    keys,
    figures,
    advise: Some(advise),
    terms,
};

const NAME: &str = "wear";
const DEPTHS: [&FieldSpec; 2] = [&field::UPPER_WEAR_DEPTH, &field::LOWER_WEAR_DEPTH];
const LAW: &str = "effects.wear.law";
const PASSES: &str = "effects.wear.passes";
const ENERGY: &str = "wear_per_joule";
const ARCHARD: &str = "wear_coefficient";
const HARDNESS: &str = "hardness";

fn path(material: &str, name: &str) -> String {
    format!("materials.{material}.{name}")
}

fn keys() -> Vec<KeySpec> {
    vec![
        KeySpec::choice(
            LAW,
            &["energy", "archard"],
            "energy: a volume per joule of friction work; archard: K/H times load and distance",
        )
        .default_value("energy"),
        KeySpec::number(PASSES, "passages of every point of both bodies that a window represents")
            .default_value(1.0)
            .above(0.0)
            .varies(),
        KeySpec::quantity(
            &path("*", ENERGY),
            "m3/J",
            "wear volume per joule of friction work; for the law energy",
        )
        .at_least(0.0),
        KeySpec::number(&path("*", ARCHARD), "Archard's coefficient K; for the law archard")
            .at_least(0.0),
        KeySpec::quantity(&path("*", HARDNESS), "Pa", "hardness H; for the law archard").above(0.0),
    ]
}

fn figures() -> Vec<FigureSpec> {
    let figure = |name: &str, unit, words, short| {
        FigureSpec::new(&format!("wear.*.{name}"), unit, words).on("wear of *", short).digits(4)
    };
    vec![
        figure("depth_per_passage_m", "m", "depth worn in a passage", "per passage").rank(10),
        figure("max_depth_m", "m", "largest depth worn", "depth").headline(),
        FigureSpec::new("wear.*.area_per_passage_m2", "m2", "cross-section worn in a passage"),
        FigureSpec::new("wear.*.worn_area_m2", "m2", "cross-section worn"),
    ]
}

/// Reads the number of passages from a configuration in which nothing varies.
///
/// # Errors
/// A value that is out of range.
fn passes(configuration: &Configuration) -> Result<f64, Refusal> {
    CheckedParams::new(&configuration.case, keys()).number(PASSES)
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let scene = Scene::read(&configuration.case)?;
    let case = CheckedParams::new(&configuration.case, keys());
    let archard = case.text(LAW)? == "archard";
    let of = |body: usize| -> Result<f64, Refusal> {
        let material = configuration.case.text(&scene.names.key(body, "material"))?;
        let number = |name: &str| case.number(&path(material, name));
        Ok(if archard { number(ARCHARD)? / number(HARDNESS)? } else { number(ENERGY)? })
    };
    let factors = [of(0)?, of(1)?];
    refuse(configuration, &scene, factors)?;
    let law = if archard { Law::Archard(factors) } else { Law::Energy(factors) };
    let removal = Removal::new(law, (configuration, passes), &scene, (DEPTHS, NAME))?;
    Ok(Terms { removal: Some(removal), ..Terms::default() })
}

fn refuse(configuration: &Configuration, scene: &Scene, factors: [f64; 2]) -> Result<(), Refusal> {
    if configuration.mode == Mode::Transient {
        return Err(Refusal::new(
            &format!("effects.{NAME}"),
            "a time window is not a number of passages",
            "write time.mode = \"steady\" or \"sequence\"",
        ));
    }
    let speeds = scene.speeds.of_surfaces(0.0);
    match (0..2).find(|body| speeds[*body] == 0.0 && factors[*body] > 0.0) {
        None => Ok(()),
        Some(body) => Err(Refusal::new(
            &scene.names.key(body, "surface_speed"),
            "a surface that stays in the contact wears without end in one place, not by passages",
            "write a speed above 0 m/s, or a material that does not wear",
        )),
    }
}

/// Mild wear of rail steel [m³/J], used if the case has none.
const TYPICAL: f64 = 6.75e-13;

/// Estimates the mean depth over the width of the contact.
fn advise(situation: &Situation<'_>) -> Advice {
    let own = |material: &str| situation.case.maybe_number(&path(material, ENERGY)).ok().flatten();
    let materials = situation.materials();
    let factor = materials.first().and_then(|material| own(material)).unwrap_or(TYPICAL);
    let lacking = materials.iter().filter(|material| own(material).is_none());
    let advice = lacking.fold(
        Advice::new(
            EFFECT.name,
            format!(
                "depth of one passage at {factor} m3/J over the approach",
                factor = number(factor, 3)
            ),
        ),
        |advice, material| advice.with(format!("{}={TYPICAL:e}", path(material, ENERGY))),
    );
    let advice = advice.with(format!("effects.{NAME}={{}}"));
    let figures = (situation.known(POWER), situation.known(SEMI_AXIS_B), situation.pressed());
    let (Some(power), Some(width), Some([_, approach])) = figures else { return advice };
    let speed = situation.scene.speeds.rolling;
    let depth = factor * power / (speed * 0.5 * PI * width);
    // The contact of the first passage is that of the unworn surfaces.
    let passes = situation.case.maybe_number(PASSES).ok().flatten().unwrap_or(1.0).max(1.0);
    advice
        .number("depth of a passage over approach", depth / approach)
        .number("passages to a tenth of the approach", 0.1 * approach / depth)
        .moves(PRESSURE, 2.0 * (1.0 - passes) * depth / approach)
}
