//! Effect `friction_bands`: friction varies across the contact.
//!
//! f(y) = f₀ m(y): a table of lateral coordinates and of factors on the friction coefficient of the case and of the effects
//! before, with straight lines between and the ends' beyond: a rail whose gauge face is greased, or a head with a friction modifier. y is that of
//! the profiles, from the origin of the case. Two lines that are close make a step.
//!
//! Source: Coulomb's law element by element; CONTACT has the same over the angle of the surface.

use crate::curve::Curve;
use crate::entry::Effect;
use crate::keys::CheckedParams;
use crate::situation::Situation;
use crate::terms::{FrictionTerm, Kind, Rubbing, State, Terms};
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::model::StepError;
use std::path::Path;

/// What the registry says of it.
pub const EFFECT: Effect = Effect {
    name: "friction_bands",
    law: "f(y) = f0 m(y), a table of factors over the lateral coordinate",
    source: "Coulomb's law element by element",
    kinds: &[Kind::Friction],
    consumes: &[],
    provides: &[],
    keys,
    figures: Vec::new,
    advise: Some(advise),
    terms,
};

const TABLE: &str = "effects.friction_bands.table";

fn keys() -> Vec<KeySpec> {
    let help = "lines of lateral coordinate [m] and factor on the friction coefficient, rising";
    vec![KeySpec::file(TABLE, help).required()]
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let case = CheckedParams::new(&configuration.case, keys());
    let path = case.text(TABLE)?;
    let positive = |[factor]: &[f64; 1]| match *factor > 0.0 {
        true => Ok(()),
        false => Err("has no factor above 0".to_owned()),
    };
    let table = Curve::read(Path::new(path), true, positive).map_err(|reason| {
        let fix = "give lines of two numbers, the lateral coordinate rising";
        Refusal::new(TABLE, format!("`{path}` {reason}"), fix)
    })?;
    Ok(Terms { friction: vec![Box::new(Bands(table))], ..Terms::default() })
}

/// Factors over the lateral coordinate.
#[derive(Debug)]
struct Bands(Curve<1>);

impl State for Bands {}

impl FrictionTerm for Bands {
    fn apply(&mut self, rubbing: &Rubbing<'_>, friction: &mut [f64]) -> Result<(), StepError> {
        let Rubbing { grid, origin_y, .. } = rubbing;
        for (j, row) in friction.chunks_exact_mut(grid.ni).enumerate() {
            let factor = self.0.at(origin_y + grid.y(j)).map_or(1.0, |[factor]| factor);
            row.iter_mut().for_each(|friction| *friction *= factor);
        }
        Ok(())
    }

    fn follows_inputs(&self) -> bool {
        false
    }

    fn shortfall(&self) -> &'static str {
        "friction is less than that of the case in a part of the contact"
    }
}

fn advise(_: &Situation<'_>) -> Advice {
    Advice::new(EFFECT.name, "by how much friction differs is what its table says")
}
