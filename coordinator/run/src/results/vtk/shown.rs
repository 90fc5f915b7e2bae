//! What is written: fields as they are now.

use contract::field::FieldKind;
use contract::grid::Grid;

/// Fields and their values.
pub(super) type Fields<'a> = [(&'a FieldKind, &'a [f64])];

/// One field as it is now.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// Role of the participant that sends it.
    pub producer: &'a str,
    /// Where it lives.
    pub grid: &'a Grid,
    /// Kind of the field.
    pub kind: &'a FieldKind,
    /// Values, component-major.
    pub values: &'a [f64],
}

impl Shown<'_> {
    /// Fields of the same producer and grid share their files.
    pub(in crate::results) fn series_name(&self) -> String {
        format!("{}_{}", self.producer, self.grid.name)
    }
}
