//! What is written: fields as they are now, under the names that the case gives the bodies.

use contract::bodies::{Bodies, LOWER, POSITIONS, UPPER};
use contract::field::{Body, FieldKind};
use contract::grid::Grid;
use serde::{Deserialize, Serialize};

/// Fields and their values.
pub(super) type Fields<'a> = [(&'a ShownKind, &'a [f64])];

/// A kind of field as a person reads it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShownKind {
    /// Name, with that of the body where it belongs to one.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Number of components.
    pub components: u32,
    /// Name of the body that it belongs to, or `interface`.
    pub body: String,
    /// One line for people.
    pub meaning: String,
}

impl ShownKind {
    /// A field of a case with these bodies.
    #[must_use]
    pub fn of(kind: &FieldKind, bodies: Option<&Bodies>) -> Self {
        let names = bodies.map_or(POSITIONS, |Bodies(names)| names.each_ref().map(String::as_str));
        let body = match kind.body {
            Body::Upper => names[UPPER],
            Body::Lower => names[LOWER],
            Body::Interface => "interface",
        };
        Self {
            name: shown(&kind.name, bodies),
            unit: kind.unit.clone(),
            components: kind.components,
            body: body.to_owned(),
            meaning: kind.meaning.clone(),
        }
    }
}

/// What a person reads for the name of a field or grid.
fn shown(name: &str, bodies: Option<&Bodies>) -> String {
    bodies.map_or_else(|| name.to_owned(), |bodies| bodies.shown(name))
}

/// One field as it is now.
#[derive(Clone, Debug)]
pub struct Shown<'a> {
    /// Name of the series that its files belong to: fields of the same producer and grid share them.
    pub series: String,
    /// Where it lives.
    pub grid: &'a Grid,
    /// Kind of the field.
    pub kind: ShownKind,
    /// Values, component-major.
    pub values: &'a [f64],
}

impl<'a> Shown<'a> {
    /// A field that the participant of the role `producer` sends, in a case with these bodies.
    #[must_use]
    pub fn new(
        producer: &str,
        grid: &'a Grid,
        kind: &FieldKind,
        values: &'a [f64],
        bodies: Option<&Bodies>,
    ) -> Self {
        let series = format!("{producer}_{}", shown(&grid.name, bodies));
        Self { series, grid, kind: ShownKind::of(kind, bodies), values }
    }
}
