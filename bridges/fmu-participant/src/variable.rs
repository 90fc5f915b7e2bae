//! A variable of an FMU, as its model description has it.

use crate::unit::Unit;

/// The type of a variable's values. Texts and binaries, clocks and FMI 2.0's strings are none that cross.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// FMI 2.0: `Real`.
    Float64,
    /// FMI 3.0.
    Float32,
    /// FMI 3.0.
    Int8,
    /// FMI 3.0.
    UInt8,
    /// FMI 3.0.
    Int16,
    /// FMI 3.0.
    UInt16,
    /// FMI 2.0: `Integer` and `Enumeration`.
    Int32,
    /// FMI 3.0.
    UInt32,
    /// FMI 3.0, `Enumeration` among them.
    Int64,
    /// FMI 3.0.
    UInt64,
    /// True or false, as 1 or 0.
    Boolean,
}

impl Kind {
    /// Values have a fraction.
    #[must_use]
    pub fn is_real(self) -> bool {
        matches!(self, Self::Float64 | Self::Float32)
    }

    /// Values are integers of 64 bits, of which a double does not have all.
    #[must_use]
    pub fn is_long(self) -> bool {
        matches!(self, Self::Int64 | Self::UInt64)
    }

    /// The least and the largest whole number that a value can be, of 64 bits those that a double has exactly; `None`
    /// for a real number, and for true or false.
    #[must_use]
    pub fn range(self) -> Option<[f64; 2]> {
        /// 2⁵³: doubles beyond it leave out whole numbers.
        const EXACT: f64 = 9_007_199_254_740_992.0;
        Some(match self {
            Self::Float64 | Self::Float32 | Self::Boolean => return None,
            Self::Int8 => [f64::from(i8::MIN), f64::from(i8::MAX)],
            Self::UInt8 => [0.0, f64::from(u8::MAX)],
            Self::Int16 => [f64::from(i16::MIN), f64::from(i16::MAX)],
            Self::UInt16 => [0.0, f64::from(u16::MAX)],
            Self::Int32 => [f64::from(i32::MIN), f64::from(i32::MAX)],
            Self::UInt32 => [0.0, f64::from(u32::MAX)],
            Self::Int64 => [-EXACT, EXACT],
            Self::UInt64 => [0.0, EXACT],
        })
    }
}

/// What a variable is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Set before the start.
    Parameter,
    /// Set from outside.
    Input,
    /// Given to the outside.
    Output,
    /// Anything else: it can be looked at.
    Inner,
}

/// A variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// How functions of FMI name it.
    pub reference: u32,
    /// The type of its values.
    pub kind: Kind,
    /// Number of its values: 1 for a scalar.
    pub size: usize,
    /// What it is for.
    pub causality: Causality,
    /// Of a parameter: it may be set before the start.
    pub settable: bool,
    /// Its values at the start, as far as the description has them, in its own unit.
    pub start: Vec<f64>,
    /// Its unit.
    pub unit: Unit,
    /// What it is, in words; may be empty.
    pub words: String,
}

impl Variable {
    /// A plain word for it, in keys of figures: what is no letter, digit or `_` becomes `_`.
    #[must_use]
    pub fn word(&self) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        self.name.chars().map(plain).collect()
    }
}
