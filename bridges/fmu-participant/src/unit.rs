//! Units of variables as defined by the FMU, and their conversion to and from SI.
//!
//! FMI defines a unit by exponents of the base units, a factor and an offset. A value v of the FMU
//! equals factor · v + offset in SI units.

use std::fmt::Write as _;

/// Exponent attributes of a `BaseUnit`, with the symbols used in a case.
pub const BASE: [(&str, &str); 8] = [
    ("kg", "kg"),
    ("m", "m"),
    ("s", "s"),
    ("A", "A"),
    ("K", "K"),
    ("mol", "mol"),
    ("cd", "cd"),
    ("rad", "rad"),
];

/// Exponents of the base units.
pub type Exponents = [i32; BASE.len()];

/// Derived units with a common name.
const DERIVED: [(&str, Exponents); 5] = [
    ("N", [1, 1, -2, 0, 0, 0, 0, 0]),
    ("Pa", [1, -1, -2, 0, 0, 0, 0, 0]),
    ("W", [1, 2, -3, 0, 0, 0, 0, 0]),
    ("N m", [1, 2, -2, 0, 0, 0, 0, 0]),
    ("N/m", [1, 0, -2, 0, 0, 0, 0, 0]),
];

/// Unit of a variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Name in the FMU; empty for a variable without unit.
    pub name: String,
    /// SI unit as an expression of base units (`kg m/s2`); `None` if the FMU does not define the
    /// unit.
    pub base: Option<String>,
    /// Factor from a value of the FMU to SI.
    pub factor: f64,
    /// Offset added after the factor.
    pub offset: f64,
}

impl Unit {
    /// Creates a unit the FMU names without defining it; values are used unchanged.
    #[must_use]
    pub fn named(name: &str) -> Self {
        Self { name: name.to_owned(), base: None, factor: 1.0, offset: 0.0 }
    }

    /// Creates a unit the FMU defines.
    #[must_use]
    pub fn defined(name: &str, exponents: Exponents, factor: f64, offset: f64) -> Self {
        Self { name: name.to_owned(), base: Some(expression(exponents)), factor, offset }
    }

    /// True if values are in SI units, or are treated as such.
    #[must_use]
    pub fn is_si(&self) -> bool {
        self.factor == 1.0 && self.offset == 0.0
    }

    /// Returns the SI unit of a converted value: the unit's own name if it is SI and fits a field
    /// label.
    #[must_use]
    pub fn si(&self) -> &str {
        match &self.base {
            _ if self.is_si() && fits(&self.name) => &self.name,
            Some(base) if fits(base) => base,
            _ => "1",
        }
    }

    /// Converts a value of the FMU to SI.
    #[must_use]
    pub fn to_si(&self, value: f64) -> f64 {
        if self.is_si() { value } else { self.factor * value + self.offset }
    }

    /// Converts a value in SI units to the unit of the FMU.
    #[must_use]
    pub fn in_own(&self, value: f64) -> f64 {
        if self.is_si() { value } else { (value - self.offset) / self.factor }
    }
}

/// True if the name fits the label of a field.
fn fits(name: &str) -> bool {
    (1..16).contains(&name.len()) && name.chars().all(|c| c.is_ascii_graphic() || c == ' ')
}

/// Formats exponents: `kg m/s2` for kg 1, m 1, s −2; `1` for a plain number.
fn expression(exponents: Exponents) -> String {
    if let Some((name, _)) = DERIVED.iter().find(|(_, derived)| *derived == exponents) {
        return (*name).to_owned();
    }
    let product = |sign: i32| {
        let mut text = String::new();
        for ((_, symbol), exponent) in BASE.iter().zip(exponents) {
            let power = sign.saturating_mul(exponent);
            if power > 0 {
                let space = if text.is_empty() { "" } else { " " };
                let power = if power > 1 { power.to_string() } else { String::new() };
                let _ = write!(text, "{space}{symbol}{power}");
            }
        }
        text
    };
    let (above, below) = (product(1), product(-1));
    let above = if above.is_empty() { "1".to_owned() } else { above };
    match below.as_str() {
        "" => above,
        one if !one.contains(' ') => format!("{above}/{one}"),
        several => format!("{above}/({several})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_become_an_expression() {
        assert_eq!(expression([1, 1, -2, 0, 0, 0, 0, 0]), "N");
        assert_eq!(expression([1, 1, -1, 0, 0, 0, 0, 0]), "kg m/s");
        assert_eq!(expression([0; 8]), "1");
        assert_eq!(expression([1, 0, -3, 0, -1, 0, 0, 0]), "kg/(s3 K)");
        assert_eq!(expression([0, 0, -1, 0, 0, 0, 0, 1]), "rad/s");
    }

    #[test]
    fn values_go_to_si_and_back() {
        let degrees = Unit::defined("degC", [0, 0, 0, 0, 1, 0, 0, 0], 1.0, 273.15);
        assert_eq!((degrees.to_si(20.0), degrees.si()), (293.15, "K"));
        assert!((degrees.in_own(293.15) - 20.0).abs() < 1e-12, "rounding of 293.15 − 273.15");
        let newton = Unit::defined("N", [1, 1, -2, 0, 0, 0, 0, 0], 1.0, 0.0);
        assert_eq!((newton.to_si(0.1), newton.in_own(0.1), newton.si()), (0.1, 0.1, "N"));
        let kilo = Unit::defined("kN", [1, 1, -2, 0, 0, 0, 0, 0], 1e3, 0.0);
        assert_eq!((kilo.to_si(2.0), kilo.in_own(2e3), kilo.si()), (2e3, 2.0, "N"));
        assert_eq!(Unit::named("").si(), "1");
        assert_eq!(Unit::named("µm").si(), "1");
    }
}
