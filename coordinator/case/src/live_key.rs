//! A key of the case whose value is given from outside as the run goes.

use contract::field::FieldKind;

/// A key whose value is given from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveKey {
    /// The field as which it travels, named like the dotted key.
    pub field: FieldKind,
    /// Its first value, in SI units.
    pub first: f64,
    /// Least and largest value, in SI units.
    pub limits: [f64; 2],
}
