//! Effect `joule_heat`: an electric current through a stationary contact heats its constriction.
//!
//! Surfaces in contact have the same potential; outside the contact no current crosses them. The
//! current density is computed like the heat exchanged between stationary bodies, with the same
//! kernel 1/(4πλr) and the conductivity 1/ρ instead of λ. A circle of radius a between equal bodies
//! has Holm's resistance ρ/2a.
//!
//! The heat ρj² is generated in the volume of both bodies, whose surfaces are insulated outside the
//! contact. The temperature is then a function of r, the potential difference from the far end of a
//! body,
//!
//! T = c r − r²/(2λρ).
//!
//! The constants c of both bodies follow from equal temperatures in the contact and from
//! conservation of heat there. Between equal bodies the rise of the contact under the voltage U is
//! V²/(8λρ) with V = U.
//!
//! Source: Holm, *Electric Contacts* (1967) §1 and §14; Kohlrausch, Ann. Phys. 306 (1900) 132–158.
//! Only steady cases of stationary bodies are supported. Neglected: films on the surfaces,
//! conductivities that depend on the temperature, and the Thomson and Peltier effects.

use super::contact_conductance;
use crate::scene::Scene;
use crate::situation::Situation;
use proto::advice::Advice;
use proto::configuration::{Configuration, Mode, Refusal};
use proto::description::{EffectSpec, KeySpec, names as field_names};
use proto::field;
use proto::figure::{FigureSpec, Style};

/// Name of the effect in the case file.
pub const NAME: &str = "joule_heat";

const CURRENT: &str = "effects.joule_heat.current";
const RESISTIVITY: &str = "resistivity";

/// Electric current through the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Current {
    /// Current I [A].
    pub current: f64,
    /// Resistivities ρ of the upper and the lower body [Ω·m].
    pub resistivities: [f64; 2],
}

impl Current {
    /// Returns the constants c of both bodies [K/V]. Their potentials fall by `falls` [V] from the
    /// far ends to the contact, and `products` are their λρ [W·Ω/K = V²/K].
    #[must_use]
    pub fn constants(falls: [f64; 2], products: [f64; 2]) -> [f64; 2] {
        let ([u, l], [of_u, of_l]) = (falls, products);
        let parabola = |fall: f64, product: f64| 0.5 * fall * fall / product;
        let difference = parabola(u, of_u) - parabola(l, of_l);
        let upper = (u + l + of_l * difference / l) / (of_u + of_l * u / l);
        [upper, (upper * u - difference) / l]
    }
}

/// Returns the description of the effect.
#[must_use]
pub fn spec() -> EffectSpec {
    let figure = |name: &str, unit, words, short| {
        FigureSpec::new(&format!("current.{name}"), unit, words).on("current", short)
    };
    EffectSpec {
        name: NAME.to_owned(),
        law: "div(grad phi/rho) = 0, one potential where surfaces touch; heat rho j^2".to_owned(),
        source: "Holm, Electric Contacts (1967), par. 1 and 14; Kohlrausch, Ann. Phys. 306 (1900) 132-158"
            .to_owned(),
        models: Vec::new(),
        consumes: field_names(&[&field::PRESSURE]),
        provides: Vec::new(),
        keys: vec![
            KeySpec::quantity(CURRENT, "A", "current through the contact").required().above(0.0),
            KeySpec::quantity(&format!("materials.*.{RESISTIVITY}"), "V m/A", "electric resistivity")
                .required()
                .above(0.0),
        ],
        figures: vec![
            figure("resistance_ohm", "Ohm", "constriction resistance", "resistance"),
            figure("voltage_v", "V", "voltage over the constriction", "voltage"),
            figure("power_w", "W", "power of the current in the constriction", "power"),
            figure("rise_k", "K", "rise of the contact by the current", "rise").style(Style::Signed),
        ],
    }
}

/// Reads the current of a case, if it has one.
///
/// # Errors
/// A value that is missing or not positive; a transient case or a moving body; the effect
/// `contact_conductance`.
pub fn read(given: &Configuration, scene: &Scene) -> Result<Option<Current>, Refusal> {
    if !given.has_effect(NAME) {
        return Ok(None);
    }
    if given.mode == Mode::Transient || scene.at_rest != [true; 2] {
        return Err(Refusal::new(
            &format!("effects.{NAME}"),
            "the heat of a current is supported only for bodies at rest in a steady state",
            "write motion.speed = 0 and time.mode = \"steady\", or remove the effect",
        ));
    }
    if given.has_effect(contact_conductance::NAME) {
        return Err(Refusal::new(
            &format!("effects.{}", contact_conductance::NAME),
            "the heat of a current assumes equal temperatures of the surfaces in contact",
            "remove it, or [effects.joule_heat]",
        ));
    }
    let positive = |key: &str| match given.case.number(key)? {
        value if value > 0.0 => Ok(value),
        value => Err(Refusal::new(key, format!("{value} is not above 0"), "write a value above 0")),
    };
    let of = |body: usize| -> Result<f64, Refusal> {
        let material = given.case.text(&scene.names.key(body, "material"))?;
        positive(&format!("materials.{material}.{RESISTIVITY}"))
    };
    Ok(Some(Current { current: positive(CURRENT)?, resistivities: [of(0)?, of(1)?] }))
}

/// Estimates how much the effect matters in a scene.
#[must_use]
pub fn advise(_: &Situation<'_>) -> Advice {
    Advice::new(NAME, "for a current through a contact at rest; the case must give the current")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equal bodies: V²/(8λρ) in the contact. Different bodies: equal temperatures in the contact,
    /// and the heat that leaves one body enters the other.
    #[test]
    fn constants_of_equal_and_of_different_bodies() {
        let rise = |c: f64, fall: f64, product: f64| c * fall - 0.5 * fall * fall / product;
        let [upper, lower] = Current::constants([0.1; 2], [2e-5; 2]);
        assert!((upper / lower - 1.0).abs() < 1e-12);
        assert!((rise(upper, 0.1, 2e-5) / (0.2 * 0.2 / (8.0 * 2e-5)) - 1.0).abs() < 1e-12);
        let (falls, products) = ([0.03, 0.2], [1e-5, 4e-5]);
        let [upper, lower] = Current::constants(falls, products);
        let at_contact = rise(upper, falls[0], products[0]) / rise(lower, falls[1], products[1]);
        assert!((at_contact - 1.0).abs() < 1e-12);
        let into = |c: f64, k: usize| products[k] * (c - falls[k] / products[k]);
        assert!((into(upper, 0) + into(lower, 1)).abs() < 1e-12 * into(upper, 0).abs());
    }
}
