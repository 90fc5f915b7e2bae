//! Effect `bulk_heating`: temperature rise that earlier passages have left in a body.
//!
//! Two parts are added to the flash temperature, row by row:
//!
//! - the rise ϑ of the whole body: its heat input P equals the loss G ϑ with G = hA over its whole
//!   surface, in equilibrium over many turns (`bodies.*.heat_loss`);
//! - earlier passages over the same point, those of preceding wheels over a rail or of preceding
//!   turns of a wheel. Each passage left the heat e(y) = ∫q dx/v on the surface [J/m²]. After
//!   conduction into a half-space and across the track the rise is ϑ(y, t) = ∫ e(y') G(y − y', t)
//!   dy'/(β √(πt)), with G a Gaussian of the variance 2κt, at the times t = jτ
//!   (`bodies.*.passages`, `bodies.*.passage_interval`).
//!
//! The sum over passages grows with the logarithm of their number, so that it remains finite for
//! those of a train. The rise of the whole body covers heating over an unlimited time.
//!
//! Source: Ertz & Knothe, Wear 253 (2002) 498–508, for bulk and flash temperature; Carslaw &
//! Jaeger, Conduction of Heat in Solids, 10.3, for the instantaneous source. The effect applies to
//! steady cases and to the rows of a sequence. Neglected: heat exchange between bodies of different
//! bulk temperature, for which reason `continuity` and `contact_conductance` are refused; heat loss
//! of the surface between two passages.

use crate::effects::contact_conductance;
use crate::effects::friction_heat::{self, Partition};
use crate::effects::integrated;
use crate::scene::Scene;
use crate::situation::{Situation, watts};
use crate::{LOWER, UPPER};
use proto::advice::Advice;
use proto::configuration::{Configuration, Mode, Refusal};
use proto::description::{EffectSpec, KeySpec};
use proto::figure::{FigureSpec, Style};
use std::f64::consts::PI;

/// Name of the effect in the case file.
pub const NAME: &str = "bulk_heating";

const LOSS: &str = "heat_loss";
const PASSAGES: &str = "passages";
const INTERVAL: &str = "passage_interval";

/// Largest number of earlier passages over the same point.
const MOST_PASSAGES: i64 = 10_000;

/// Thermal history of a body: bulk heating and earlier passages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassageHistory {
    /// Heat loss of the whole body [W/K]; `None` for a body that keeps its initial temperature.
    pub loss: Option<f64>,
    /// Number of earlier passages over the same point.
    pub passages: usize,
    /// Time between two passages [s].
    pub interval: f64,
}

fn keys() -> Vec<KeySpec> {
    let of = |name: &str| format!("bodies.*.{name}");
    vec![
        KeySpec::quantity(
            &of(LOSS),
            "W/K",
            "heat loss of the whole body, h A; absent: the body keeps its initial temperature",
        )
        .above(0.0),
        KeySpec::integer(
            &of(PASSAGES),
            "number of earlier passages over the same place of the body",
        )
        .default_value(0)
        .at_least(0.0)
        .at_most(MOST_PASSAGES as f64),
        KeySpec::quantity(&of(INTERVAL), "s", "time between two passages").above(0.0),
    ]
}

/// Returns the description of the effect.
#[must_use]
pub fn spec() -> EffectSpec {
    let figure = |name: &str, words, short| {
        FigureSpec::new(&format!("temperature.*.{name}"), "K", words)
            .on("*", short)
            .style(Style::Signed)
            .unless_zero()
    };
    EffectSpec {
        name: NAME.to_owned(),
        law: "surface temperature = flash + P/(h A) + sum over earlier passages of e/(beta sqrt(pi t))"
            .to_owned(),
        source: "Ertz & Knothe, Wear 253 (2002) 498-508; Carslaw & Jaeger, Conduction of Heat in \
                 Solids, 10.3"
            .to_owned(),
        models: Vec::new(),
        consumes: Vec::new(),
        provides: Vec::new(),
        keys: keys(),
        figures: vec![
            figure("bulk_rise_k", "rise of the whole body", "of which the whole body"),
            figure("residual_rise_k", "rise left by earlier passages", "left by earlier passages"),
        ],
    }
}

/// Reads the thermal history of the upper and the lower body.
///
/// # Errors
/// A value that is missing or out of range; a setting that the effect does not support.
pub fn read(given: &Configuration, scene: &Scene) -> Result<[PassageHistory; 2], Refusal> {
    if given.mode == Mode::Transient {
        return Err(Refusal::new(
            &format!("effects.{NAME}"),
            "earlier passages are supported only in steady contacts, not in windows of time",
            "write time.mode = \"steady\" or \"sequence\", or remove the effect",
        ));
    }
    if Partition::read(&given.case)? == Partition::Continuity {
        return Err(Refusal::new(
            friction_heat::PARTITION_KEY,
            "the heat that flows between bodies of different bulk temperature is not computed",
            "write \"equal\" or \"effusivity\", or remove [effects.bulk_heating]",
        ));
    }
    if given.has_effect(contact_conductance::NAME) {
        return Err(Refusal::new(
            &format!("effects.{}", contact_conductance::NAME),
            "the heat that flows between bodies of different bulk temperature is not computed",
            "remove it, or [effects.bulk_heating]",
        ));
    }
    if scene.at_rest == [true; 2] {
        return Err(Refusal::new(
            &format!("effects.{NAME}"),
            "both bodies are at rest: no place passes the contact",
            "write a motion.speed above 0, or remove the effect",
        ));
    }
    if let Some(effect) = integrated::active(given) {
        return Err(Refusal::new(
            &format!("effects.{effect}"),
            "the heat that earlier passages have left below the surface is not computed",
            "remove it, or [effects.bulk_heating]",
        ));
    }
    let own = [of_body(given, scene, UPPER)?, of_body(given, scene, LOWER)?];
    if own.iter().any(|memory| memory.loss.is_some() || memory.passages > 0) {
        return Ok(own);
    }
    let key = scene.names.key(UPPER, LOSS);
    Err(Refusal::new(
        &format!("effects.{NAME}"),
        "neither body has a heat_loss or passages",
        format!("add `{key} = \"20 W/K\"`, or {PASSAGES} and {INTERVAL}"),
    ))
}

fn of_body(given: &Configuration, scene: &Scene, body: usize) -> Result<PassageHistory, Refusal> {
    let key = |name: &str| scene.names.key(body, name);
    let positive = |name: &str| match given.case.maybe_number(&key(name))? {
        Some(value) if value <= 0.0 => Err(Refusal::new(
            &key(name),
            format!("{value} is not above 0"),
            "write a value above 0",
        )),
        value => Ok(value),
    };
    let passages = match given.case.has(&key(PASSAGES)) {
        true => given.case.integer(&key(PASSAGES))?,
        false => 0,
    };
    let Ok(passages) = usize::try_from(passages) else {
        return Err(Refusal::new(&key(PASSAGES), "is below 0", "write a number of passages"));
    };
    if passages > 0 && scene.at_rest[body] {
        let reason = "a body at rest has no earlier passages over the same place";
        return Err(Refusal::new(&key(PASSAGES), reason, "remove the key"));
    }
    let interval = positive(INTERVAL)?;
    match (passages, interval) {
        (1.., None) => {
            let fix = format!("add `{} = \"0.1 s\"`", key(INTERVAL));
            Err(Refusal::new(&key(INTERVAL), "missing; the passages need it", fix))
        }
        _ => Ok(PassageHistory {
            loss: positive(LOSS)?,
            passages,
            interval: interval.unwrap_or(f64::INFINITY),
        }),
    }
}

/// Heat transfer coefficient of a rolling body in air [W/(m²·K)]: 60 W/K of a railway wheel.
const IN_AIR: f64 = 22.5;

/// Radius of a railway wheel, used if the case has none [m].
const OF_A_WHEEL: f64 = 0.46;

/// Returns the radius of a body in the plane of rolling [m], if the case has one.
fn radius(situation: &Situation<'_>, body: usize) -> Option<f64> {
    let radius = situation.case.maybe_number(&situation.scene.names.key(body, "radius_x"));
    radius.ok().flatten().filter(|radius| *radius > 0.0)
}

/// Estimates the rise of a whole body with this heat loss [W/K] by the end of the case [K]: that of
/// a sphere of its radius, which begins at P t/(m c) and ends at P/(h A).
fn of_whole(situation: &Situation<'_>, body: usize, loss: f64) -> f64 {
    let material = &situation.scene.materials[body];
    let radius = radius(situation, body).unwrap_or(OF_A_WHEEL);
    let volume = 4.0 / 3.0 * PI * radius.powi(3);
    let times = situation.time * loss / (volume * material.density * material.specific_heat);
    -situation.heat[body] / loss * (-times).exp_m1()
}

/// Heat loss of a sphere in air, to two digits [W/K].
fn of_radius(radius: f64) -> f64 {
    let loss = IN_AIR * 4.0 * PI * radius * radius;
    format!("{loss:.1e}").parse().unwrap_or(loss)
}

/// Estimates the rise of the whole body and the rise left by earlier passages in the middle of its
/// track [K]; `None` for a body without their keys.
fn remembered(situation: &Situation<'_>, body: usize) -> Option<[f64; 2]> {
    let (case, names) = (situation.case, &situation.scene.names);
    let number = |name: &str| case.maybe_number(&names.key(body, name)).ok().flatten();
    let loss = number(LOSS).filter(|loss| *loss > 0.0);
    let passages = case.integer(&names.key(body, PASSAGES)).unwrap_or(0);
    let interval = number(INTERVAL).filter(|_| passages > 0 && situation.speeds[body] > 0.0);
    if loss.is_none() && interval.is_none() {
        return None;
    }
    let bulk = loss.map_or(0.0, |loss| of_whole(situation, body, loss));
    Some([bulk, interval.map_or(0.0, |interval| left(situation, body, passages, interval))])
}

/// Estimates the rise that earlier passages at some interval [s] have left in the middle of a
/// body's track [K]. The heat of each has spread into the depth, and laterally as a Gaussian of the
/// variance 2κt. The lateral decay depends on the width of the track.
fn left(situation: &Situation<'_>, body: usize, passages: i64, interval: f64) -> f64 {
    let material = &situation.scene.materials[body];
    let width = 4.0 / 3.0 * situation.semi_axes[1];
    let after = |passage: i64| {
        let time = passage as f64 * interval;
        let spread = 4.0 * PI * material.diffusivity() * time / (width * width);
        1.0 / (material.effusivity() * (PI * time * (1.0 + spread)).sqrt())
    };
    situation.left_behind(body) * (1..=passages.min(MOST_PASSAGES)).map(after).sum::<f64>()
}

/// Estimates how much the effect matters in a scene, for the body whose rise it changes most. If
/// neither body has a loss or passages, it assumes the loss of a sphere of the body's radius.
#[must_use]
pub fn advise(situation: &Situation<'_>) -> Advice {
    let scene = situation.scene;
    let over_flash = |body: usize, rise: f64| rise / situation.rises[body].max(f64::MIN_POSITIVE);
    let most = |bodies: [Option<[f64; 2]>; 2]| {
        let known = [UPPER, LOWER].into_iter().zip(bodies);
        known.filter_map(|(body, rises)| Some((body, rises?))).max_by(|(a, own), (b, other)| {
            over_flash(*a, own.iter().sum()).total_cmp(&over_flash(*b, other.iter().sum()))
        })
    };
    let bulk = |body: usize, loss: f64| [of_whole(situation, body, loss), 0.0];
    let known = most([UPPER, LOWER].map(|body| remembered(situation, body)));
    let losses = [UPPER, LOWER].map(|body| radius(situation, body).map(of_radius));
    let assumed = most([UPPER, LOWER].map(|body| Some(bulk(body, losses[body]?))));
    let (body, [bulk, residual]) =
        known.or(assumed).unwrap_or((UPPER, bulk(UPPER, of_radius(OF_A_WHEEL))));
    let heat = watts(situation.heat[body]);
    let name = &scene.names.0[body];
    let loss = known.is_none().then(|| losses[body].unwrap_or(of_radius(OF_A_WHEEL)));
    let with = loss.map_or(String::new(), |loss| format!(" with an assumed loss of {loss} W/K"));
    let when = match situation.time.is_finite() {
        true => format!("in {} s", situation.time),
        false => "over a long time".to_owned(),
    };
    let why = format!(
        "{heat} into {name} raise the whole body by {bulk:.1} K {when}{with}; earlier passages leave {residual:.1} K"
    );
    let relative = over_flash(body, bulk + residual);
    let advice = Advice::new(NAME, why).number("rise of the whole body over flash", relative);
    let advice = match loss {
        None => advice,
        Some(loss) => advice.with(format!("{}={loss}", scene.names.key(body, LOSS))),
    };
    situation.moved(advice.with(format!("effects.{NAME}={{}}")), body, relative)
}
