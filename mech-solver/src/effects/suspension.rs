//! Effect `suspension`: the upper body is an unsprung mass on a primary suspension, and may run
//! over an irregularity.
//!
//! M z̈ = N(t) − N_0 − K z − C ż, with the height z of the axle above that of steady rolling, the
//! normal force N(t) of the contact, and the normal force N_0 of the case. The car body keeps its
//! height: it oscillates at about 1 Hz, and a run takes some milliseconds. An irregularity is a
//! hollow of a surface; the contact follows its shape, and may be lost and regained. With a rotary
//! inertia I, the torque of steady rolling drives the upper body, I ω̇ = (F_0 − F(t)) R; without
//! one its speed is constant.
//!
//! Source: the paper's fig. 2 and table 1 (M_w, K_p, C_p); Jenkins et al., *The effect of track and
//! vehicle parameters on wheel/rail vertical dynamic forces*, Railway Engng J. 3 (1974) 2–16, for
//! joints.
//!
//! Limits: the lower body rests on a rigid foundation. Dynamic forces are therefore higher than on
//! a flexible track.

use crate::advice::situation::Situation;
use crate::case::keys::CheckedParams;
use crate::registry::entry::Effect;
use crate::terms::{Kind, Terms};
use elastic::axle::{Axle, Form, Irregularity};
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::figure::FigureSpec;

/// Registry entry of the effect.
pub const EFFECT: Effect = Effect {
    name: "suspension",
    law: "M z'' = N(t) - N - K z - C z' over the irregularity of a surface",
    source: "Jenkins et al., Railway Engng J. 3 (1974) 2-16",
    kinds: &[Kind::Axle],
    consumes: &[],
    provides: &[],
    keys,
    figures,
    advise: Some(advise),
    terms,
};

const MASS: &str = "effects.suspension.mass";
const STIFFNESS: &str = "effects.suspension.stiffness";
const DAMPING: &str = "effects.suspension.damping";
const INERTIA: &str = "effects.suspension.rotary_inertia";
const FORM: &str = "effects.suspension.irregularity";
const DEPTH: &str = "effects.suspension.depth";
const LENGTH: &str = "effects.suspension.length";
const AT: &str = "effects.suspension.at";
/// Choice for no irregularity.
const NONE: &str = "none";

fn keys() -> Vec<KeySpec> {
    let forms: Vec<&str> = [NONE].into_iter().chain(Form::NAMES.map(|(name, _)| name)).collect();
    vec![
        KeySpec::quantity(MASS, "kg", "unsprung mass on the contact").required().above(0.0),
        KeySpec::quantity(STIFFNESS, "N/m", "stiffness of the primary suspension")
            .at_least(0.0)
            .default_value(0.0),
        KeySpec::quantity(DAMPING, "N s/m", "damping of the primary suspension")
            .at_least(0.0)
            .default_value(0.0),
        KeySpec::quantity(
            INERTIA,
            "kg m^2",
            "rotary inertia of the upper body, which the torque of steady rolling drives; absent: constant surface speed",
        )
        .above(0.0),
        KeySpec::choice(
            FORM,
            &forms,
            "irregularity: a hollow of the lower body (dip), ramps that meet in a kink (joint), waves \
             (corrugation), a hollow of the upper body (flat)",
        )
        .default_value(NONE),
        KeySpec::quantity(DEPTH, "m", "depth of the irregularity (waves: from crest to trough)").above(0.0),
        KeySpec::quantity(LENGTH, "m", "length of the irregularity (waves: from crest to crest)").above(0.0),
        KeySpec::quantity(AT, "m", "rolling distance to its middle (waves: to the first crest)")
            .above(0.0),
    ]
}

/// Quantities accumulated over the windows.
fn figures() -> Vec<FigureSpec> {
    let figure = |name: &str, unit, words, short| {
        FigureSpec::new(&format!("contact.{name}"), unit, words).on("so far", short)
    };
    vec![
        figure("largest_normal_force_n", "N", "largest normal force", "N up to"),
        figure("apart_s", "s", "time without contact", "apart"),
        figure("friction_work_j", "J", "work of friction", "heat"),
    ]
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let own = CheckedParams::new(&configuration.case, keys());
    let name = own.text(FORM)?;
    let form = Form::NAMES.into_iter().find(|(form, _)| *form == name).map(|(_, form)| form);
    let size = |key: &str| {
        own.maybe_number(key)?.ok_or_else(|| {
            let reason = format!("the irregularity `{name}` needs a value");
            Refusal::new(key, reason, format!("add `{key}`, or remove the irregularity"))
        })
    };
    let irregularity = form
        .map(|form| {
            let (depth, length, at) = (size(DEPTH)?, size(LENGTH)?, size(AT)?);
            Ok::<_, Refusal>(Irregularity { form, depth, length, at })
        })
        .transpose()?;
    if irregularity.is_none() && [DEPTH, LENGTH, AT].iter().any(|key| own.has(key)) {
        return Err(Refusal::new(
            FORM,
            "an irregularity has a size, but no form",
            format!("write one of {}", Form::NAMES.map(|(name, _)| name).join(", ")),
        ));
    }
    let axle = Axle {
        mass: own.number(MASS)?,
        stiffness: own.number(STIFFNESS)?,
        damping: own.number(DAMPING)?,
        rotary_inertia: own.maybe_number(INERTIA)?,
        irregularity,
    };
    Ok(Terms { axle: Some(axle), ..Terms::default() })
}

fn advise(_: &Situation<'_>) -> Advice {
    let why = "needs a joint, a flat or corrugation in the case; smooth bodies do not move";
    Advice::new(EFFECT.name, why)
}
