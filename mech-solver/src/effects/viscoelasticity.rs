//! Effect `viscoelasticity`: the compliance of a material grows with time, which causes rolling
//! resistance.
//!
//! A material with a `delayed_compliance_ratio` f and a `retardation_time` τ is a standard linear
//! solid with a constant Poisson's ratio. Under a constant stress its compliance is
//! J(t) = J [1 + f (1 − e^{−t/τ})], with the compliance J of `youngs_modulus`. For a spring in
//! series with a Kelvin–Voigt element, f is the stiffness of the spring divided by that of the
//! element, and τ the viscosity of the element divided by its stiffness. Kelvin's solid is the
//! limit of a stiff first spring, f → ∞ with constant E/f. Maxwell's fluid is the limit f → ∞ with
//! constant τ/f, the relaxation time. In this limit the approach grows without bound, and all other
//! quantities have a limit.
//!
//! Half-spaces that are pressed and shifted in place creep from window to window
//! ([`half_space::retarded`]). In steady rolling they have the influence coefficients of
//! [`half_space::viscoelastic`]. The centre of pressure lies x̄ ahead of the middle, and N x̄/R
//! resists rolling. The power of this resistance, and a part of the power of the creepages, is
//! dissipated in the bodies.
//!
//! Source: Hunter, J. Appl. Mech. 28 (1961) 611; Wang and Knothe, J. Appl. Mech. 60 (1993) 310.
//! Neglected: several retardation times; a Poisson's ratio that changes with time; the difference
//! of the surface speeds in the distance that a particle rolls; the heat dissipated in the bodies;
//! and unsteady rolling.

use crate::advice::situation::Situation;
use crate::case::keys::CheckedParams;
use crate::registry::entry::Effect;
use crate::terms::{Kind, Terms};
use half_space::viscoelastic::Retardation;
use proto::advice::Advice;
use proto::bodies::Bodies;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::figure::FigureSpec;

/// Registry entry of the effect.
pub const EFFECT: Effect = Effect {
    name: "viscoelasticity",
    law: "J(t) = J [1 + f (1 - exp(-t/tau))] of each body, in place or in steady rolling; resistance N x/R, x the centre of pressure",
    source: "Hunter, J. Appl. Mech. 28 (1961) 611-617; Lee and Radok, J. Appl. Mech. 27 (1960) 438-444; Wang and Knothe, J. Appl. Mech. 60 (1993) 310-317",
    kinds: &[Kind::Retardation],
    consumes: &[],
    provides: &[],
    keys,
    figures,
    advise: Some(advise),
    terms,
};

const RATIO: &str = "delayed_compliance_ratio";
const TIME: &str = "retardation_time";

fn path(material: &str, name: &str) -> String {
    format!("materials.{material}.{name}")
}

fn keys() -> Vec<KeySpec> {
    let ratio = "delayed compliance over the instantaneous one (Young's modulus)";
    let time = "time constant of the delayed compliance";
    vec![
        KeySpec::number(&path("*", RATIO), ratio).above(0.0),
        KeySpec::quantity(&path("*", TIME), "s", time).above(0.0),
    ]
}

fn advise(_: &Situation<'_>) -> Advice {
    let why =
        "for rubber and polymers; needs their delayed compliance and retardation time in the case";
    Advice::new(EFFECT.name, why)
}

fn figures() -> Vec<FigureSpec> {
    let figure = |key: &str, unit, words, short| {
        FigureSpec::new(&format!("contact.{key}"), unit, words).on("resistance", short)
    };
    vec![
        figure("rolling_resistance_n", "N", "resistance to rolling N x/R", "force"),
        figure("pressure_centre_x_m", "m", "centre of pressure ahead of the middle", "x"),
        figure("hysteresis_power_w", "W", "power dissipated in the bodies", "power"),
    ]
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let case = &configuration.case;
    let names = Bodies::read(case)?;
    let own = CheckedParams::new(case, keys());
    let mut retardation = [None, None];
    for (which, retardation) in retardation.iter_mut().enumerate() {
        let material = case.text(&names.key(which, "material"))?;
        let [ratio, time] = [RATIO, TIME].map(|name| path(material, name));
        if own.has(&ratio) || own.has(&time) {
            *retardation =
                Some(Retardation { ratio: own.number(&ratio)?, time: own.number(&time)? });
        }
    }
    if retardation.iter().all(Option::is_none) {
        return Err(Refusal::new(
            "effects.viscoelasticity",
            "no body has a material whose compliance grows",
            format!(
                "write {} and {}, or remove the effect",
                path("NAME", RATIO),
                path("NAME", TIME)
            ),
        ));
    }
    Ok(Terms { retardation, ..Terms::default() })
}
