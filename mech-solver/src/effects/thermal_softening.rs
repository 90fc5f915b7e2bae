//! Effect `thermal_softening`: Young's modulus and the yield stress fall with the temperature.
//!
//! A material with a `softening_table` has E(T) = s_E(T) E and σ_y(T) = s_y(T) σ_y. The table has
//! rows of temperature [K], s_E and s_y, is linear between them, and falls with temperature.
//! Temperatures are absolute: the uniform `initial_temperature` of the body plus the rise in the
//! first layer of elements. Poisson's ratio is constant; the hardening moduli fall with E.
//!
//! An element of the first layer has the mean rise over its depth h, W/h, with the integral W of
//! the rise over the depth that the thermal side provides. All heat is assumed to be in that layer,
//! as in [`super::thermal_expansion`]. Elements that are deeper than the heat therefore soften less
//! than the surface. Elements that are shallower than the heat soften too much; such a case is
//! outside the range of this effect.
//!
//! The stress follows from the strain at the current shares (hypoelastic changes with temperature
//! are neglected). The power of plastic flow depends on the temperature during flow, and is not
//! reported.
//!
//! The effect closes a coupling loop: heat changes the contact, and the contact changes the heat.
//!
//! Source: EN 1993-1-2:2005, table 3.1 (reduction factors of carbon steel).

use crate::case::keys::CheckedParams;
use crate::case::piecewise_linear::{PiecewiseLinear, absolute_temperature};
use crate::registry::entry::Effect;
use crate::terms::softening::{LEAST_SHARE, Softening};
use crate::terms::{Kind, Terms};
use proto::bodies::{Bodies, initial_temperature_key};
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::field;
use proto::figure::{FigureSpec, Style};
use proto::table::{Column, headings};
use std::path::Path;

/// Registry entry of the effect.
pub const EFFECT: Effect = Effect {
    name: "thermal_softening",
    law: "E(T) = s_E(T) E and yield stress s_y(T) sigma_y in the first layer of finite elements, T the mean over its depth",
    source: "EN 1993-1-2:2005, table 3.1",
    kinds: &[Kind::Softening],
    consumes: &[&field::UPPER_RISE_INTEGRAL, &field::LOWER_RISE_INTEGRAL],
    provides: &[],
    keys,
    figures,
    advise: None,
    terms,
};

const TABLE: &str = "softening_table";
const BEYOND: &str = "effects.thermal_softening.beyond";

fn path(material: &str) -> String {
    format!("materials.{material}.{TABLE}")
}

/// Columns of the table.
fn columns() -> [Column; 3] {
    [
        absolute_temperature(),
        Column::new(&["youngs_modulus_share"], "1"),
        Column::new(&["yield_stress_share"], "1"),
    ]
}

fn keys() -> Vec<KeySpec> {
    vec![
        KeySpec::table(&path("*"), &columns(), "shares that fall as the temperature rises"),
        KeySpec::choice(BEYOND, &["refuse", "hold"], "behaviour beyond a table")
            .default_value("refuse"),
        initial_temperature_key(),
    ]
}

fn figures() -> Vec<FigureSpec> {
    let words = "least share of Young's modulus in an element of the surface";
    vec![
        FigureSpec::new(&format!("contact.{LEAST_SHARE}"), "1", words)
            .on("softening", "stiffness left")
            .style(Style::Percent),
    ]
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let case = &configuration.case;
    let names = Bodies::read(case)?;
    let own = CheckedParams::new(case, keys());
    let clamps = own.text(BEYOND)? == "hold";
    let mut softening = [None, None];
    for (which, softening) in softening.iter_mut().enumerate() {
        let key = path(case.text(&names.key(which, "material"))?);
        if !own.has(&key) {
            continue;
        }
        let file = own.text(&key)?;
        let refused = |reason: String| {
            let fix =
                format!("give a table of {}, shares above 0 and at most 1", headings(&columns()));
            Refusal::new(&key, format!("`{file}` {reason}"), fix)
        };
        let initial = own.number(&names.key(which, "initial_temperature"))?;
        let curve =
            PiecewiseLinear::read(Path::new(file), &columns(), clamps, |shares| {
                match shares.iter().all(|share| *share > 0.0 && *share <= 1.0) {
                    true => Ok(()),
                    false => Err("has a share that is not above 0 and at most 1".to_owned()),
                }
            });
        let curve = curve.map_err(refused)?;
        if !curve.falls() {
            return Err(refused("has a share that rises with the temperature".to_owned()));
        }
        let reason = format!("does not contain {initial} K, the initial temperature of the body");
        *softening = Some(Softening::new(curve, initial).ok_or_else(|| refused(reason))?);
    }
    if softening.iter().all(Option::is_none) {
        return Err(Refusal::new(
            "effects.thermal_softening",
            "no body has a material that softens",
            format!("write {}, or remove the effect", path("NAME")),
        ));
    }
    Ok(Terms { softening, ..Terms::default() })
}
