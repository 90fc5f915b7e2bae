//! Effect `pressure_limit`: the pressure does not exceed the hardness of the softer body.
//!
//! The pressure has the bounds 0 ≤ p ≤ H. Where the elastic half-space would carry more, the
//! surface yields until the neighbouring elements carry the rest. No history is kept, neither the
//! imprint nor residual stress. The effect therefore applies to the first passage, and is not
//! called plasticity.
//!
//! Source: Almqvist, Sahlin, Larsson & Glavatskih, Tribology International 40 (2007) 574–579, with
//! H about three times the yield stress: Tabor, *The Hardness of Metals* (1951).

use crate::advice::situation::{PRESSURE, Situation};
use crate::case::keys::CheckedParams;
use crate::registry::entry::Effect;
use crate::terms::{Kind, Terms};
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::figure::{FigureSpec, Style};
use proto::readable::quantity;

/// Registry entry of the effect.
pub const EFFECT: Effect = Effect {
    name: "pressure_limit",
    law: "0 <= p <= H: pressure beyond the hardness H goes to the elements around",
    source: "Almqvist et al., Tribology International 40 (2007) 574-579; Tabor, The Hardness of \
             Metals (1951)",
    kinds: &[Kind::PressureBound],
    consumes: &[],
    provides: &[],
    keys,
    figures,
    advise: Some(advise),
    terms,
};

const HARDNESS: &str = "effects.pressure_limit.hardness";

fn keys() -> Vec<KeySpec> {
    let help = "largest pressure H that the softer body carries";
    vec![KeySpec::quantity(HARDNESS, "Pa", help).required().above(0.0)]
}

fn figures() -> Vec<FigureSpec> {
    let figure = FigureSpec::new("contact.limited_area_ratio", "1", "area at the largest pressure");
    vec![figure.on("contact", "at limit").style(Style::Percent).digits(3).absolute()]
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let case = CheckedParams::new(&configuration.case, keys());
    Ok(Terms { pressure_bounds: vec![case.number(HARDNESS)?], ..Terms::default() })
}

/// Yield stress of rail steel [Pa], used if the case has none.
const YIELD: f64 = 600e6;

fn advise(situation: &Situation<'_>) -> Advice {
    let given = situation.case.maybe_number(HARDNESS).ok().flatten();
    let hardness = given.unwrap_or(3.0 * YIELD);
    let advice = Advice::new(
        EFFECT.name,
        format!(
            "largest pressure of smooth bodies over a hardness of {hardness}",
            hardness = quantity(hardness, "Pa", 4)
        ),
    )
    .with(format!("{HARDNESS}={hardness:e}"));
    let Some(pressure) = situation.known(PRESSURE) else { return advice };
    advice.number("p0/H", pressure / hardness).moves(PRESSURE, (hardness / pressure).min(1.0) - 1.0)
}
