//! Effect `friction_bands`: friction varies across the contact, or along the track.
//!
//! f = f₀ m(q), with factors m on the friction coefficient from a table over a coordinate q. The
//! table is linear between its rows and constant beyond its ends. Examples are a greased gauge face
//! and a rail head with a friction modifier. Two rows at close coordinates make a step. The
//! coordinate is one of:
//!
//! - the lateral coordinate of the profiles, from the origin of the case; in the model
//!   `wheel-on-track` the arc length along the rail's profile;
//! - the inclination of the rail's surface, in the axes of its profile, positive on the gauge side
//!   (`wheel-on-track`);
//! - the position along the track, `wheelset.way` plus x (`wheel-on-track`).
//!
//! Every element has its own coordinate, or all elements of a patch have that of the patch's
//! reference.
//!
//! Source: Coulomb's law element by element. CONTACT's user guide, *Friction variation*, describes
//! tables over inclination and track for the reference of a patch; its inclinations have the
//! opposite sign.

use crate::advice::situation::Situation;
use crate::case::keys::CheckedParams;
use crate::case::piecewise_linear::PiecewiseLinear;
use crate::registry::entry::Effect;
use crate::terms::bands::{At, Bands, Over};
use crate::terms::friction::{FrictionFactor, FrictionLaw, FrictionState};
use crate::terms::{Kind, Need, Terms};
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::model::StepError;
use proto::table::{Column, headings};
use std::f64::consts::PI;
use std::path::Path;

/// Registry entry of the effect.
pub const EFFECT: Effect = Effect {
    name: "friction_bands",
    law: "f = f0 m, a table of factors over the lateral coordinate, the inclination of the rail or the track",
    source: "Coulomb's law element by element; Vollebregt, User guide for CONTACT (2022), friction variation",
    kinds: &[Kind::FrictionFactor],
    consumes: &[],
    provides: &[],
    keys,
    figures: Vec::new,
    advise: Some(advise),
    terms,
};

const TABLE: &str = "effects.friction_bands.table";
const OVER: &str = "effects.friction_bands.over";
const AT: &str = "effects.friction_bands.at";

fn keys() -> Vec<KeySpec> {
    vec![
        KeySpec::file(
            TABLE,
            "table of a coordinate in ascending order, `y [m]`, `inclination [rad]` or `way [m]`, and a `factor` on the friction coefficient",
        )
        .required(),
        KeySpec::choice(
            OVER,
            &["lateral", "inclination", "track"],
            "the coordinate: the lateral one [m], the inclination of the rail's surface in its profile, positive on the gauge side [rad], or the \
             position along the track [m]; the last two for a rail on a track",
        )
        .default_value("lateral"),
        KeySpec::choice(
            AT,
            &["elements", "patches"],
            "points at which friction is evaluated: every element, or the reference of each patch (rail on a track)",
        )
        .default_value("elements"),
    ]
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let case = CheckedParams::new(&configuration.case, keys());
    let path = case.text(TABLE)?;
    let over = match case.text(OVER)? {
        "inclination" => Over::Inclination,
        "track" => Over::Track,
        _ => Over::Lateral,
    };
    let at = if case.text(AT)? == "patches" { At::Patches } else { At::Elements };
    let needs = [
        (over != Over::Lateral).then_some(rail_place(
            OVER,
            "rail on a track, which this coordinate needs",
            "lateral",
        )),
        (at == At::Patches).then_some(rail_place(AT, "patches with references", "elements")),
    ];
    let refused = |reason: String| {
        let fix = format!("give a table of {}", headings(&columns(over)));
        Refusal::new(TABLE, format!("`{path}` {reason}"), fix)
    };
    let positive = |[factor]: &[f64; 1]| match *factor > 0.0 {
        true => Ok(()),
        false => Err("has no factor above 0".to_owned()),
    };
    let table =
        PiecewiseLinear::read(Path::new(path), &columns(over), true, positive).map_err(refused)?;
    let most = largest(over);
    if let Some(outside) = table.coordinates().find(|at| at.abs() > most) {
        let unit = &columns(over)[0].unit;
        return Err(refused(format!(
            "reaches {outside} {unit}, beyond the limit of {most} {unit}; check the unit"
        )));
    }
    let bands = Bands { table, over, at };
    Ok(Terms {
        friction: FrictionLaw::of_factor(bands),
        needs: needs.into_iter().flatten().collect(),
        ..Terms::default()
    })
}

/// Columns of a table over a coordinate.
fn columns(over: Over) -> [Column; 2] {
    let coordinate = match over {
        Over::Lateral => Column::new(&["y", "lateral"], "m"),
        Over::Inclination => Column::new(&["inclination"], "rad"),
        Over::Track => Column::new(&["way", "s"], "m"),
    };
    [coordinate, Column::new(&["factor"], "1")]
}

/// Largest plausible magnitude of a coordinate: no contact reaches half a metre from the origin,
/// and no rail surface is inclined by more than π.
fn largest(over: Over) -> f64 {
    match over {
        Over::Lateral => 0.5,
        Over::Inclination => PI,
        Over::Track => f64::INFINITY,
    }
}

/// Need for coordinates that only a rail on a track has.
fn rail_place(key: &'static str, lacks: &'static str, instead: &'static str) -> Need {
    Need { kind: Kind::RailPlace, key, lacks, instead }
}

impl FrictionFactor for Bands {
    fn write(
        &self,
        state: &FrictionState<'_>,
        _coefficient: f64,
        factors: &mut [f64],
    ) -> Result<(), StepError> {
        for (index, factor) in factors.iter_mut().enumerate() {
            if let Some(coordinate) = (state.coordinate)(self.over, self.at, index) {
                *factor = self.factor(coordinate);
            }
        }
        Ok(())
    }

    fn shortfall(&self) -> &'static str {
        "friction is less than that of the case in a part of the contact"
    }
}

fn advise(_: &Situation<'_>) -> Advice {
    Advice::new(EFFECT.name, "its table gives the change of friction")
}
