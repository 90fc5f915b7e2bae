//! Variable of an FMU, as in its model description.

use crate::unit::Unit;

/// Type of the values of a variable. Strings, binaries and clocks are not exchanged.
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
    /// FMI 3.0, including `Enumeration`.
    Int64,
    /// FMI 3.0.
    UInt64,
    /// Boolean, exchanged as 1 or 0.
    Boolean,
}

impl Kind {
    /// True for real numbers.
    #[must_use]
    pub fn is_real(self) -> bool {
        matches!(self, Self::Float64 | Self::Float32)
    }

    /// True for 64-bit integers; a double cannot represent all of them.
    #[must_use]
    pub fn is_long(self) -> bool {
        matches!(self, Self::Int64 | Self::UInt64)
    }

    /// Returns the smallest and largest integer of the type; for 64 bits, the range a double
    /// represents exactly. Returns `None` for real numbers and booleans.
    #[must_use]
    pub fn range(self) -> Option<[f64; 2]> {
        /// 2⁵³: doubles beyond it skip integers.
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

/// Purpose of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Set before the start.
    Parameter,
    /// Set from outside in every step.
    Input,
    /// Read by others.
    Output,
    /// Any other variable; it can be read.
    Inner,
}

/// Numeric variable of an FMU.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Name of the variable.
    pub name: String,
    /// Value reference, which identifies the variable to functions of FMI.
    pub reference: u32,
    /// Type of the values.
    pub kind: Kind,
    /// Number of values: 1 for a scalar.
    pub size: usize,
    /// Purpose of the variable.
    pub causality: Causality,
    /// True for a parameter that may be set before the start.
    pub settable: bool,
    /// Start values in the unit of the variable, as far as given.
    pub start: Vec<f64>,
    /// Unit of the values.
    pub unit: Unit,
    /// Description; may be empty.
    pub words: String,
}

impl Variable {
    /// Returns the name for keys of figures: `_` replaces every character except letters, digits
    /// and `_`.
    #[must_use]
    pub fn word(&self) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        self.name.chars().map(plain).collect()
    }
}
