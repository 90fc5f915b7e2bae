//! Units of variables: what an FMU defines of them, and the way to SI and back.
//!
//! FMI says of a unit its exponents over seven base units, a factor and an offset: in SI a value v is
//! factor · v + offset.

use std::fmt::Write as _;

/// Attributes of a `BaseUnit` that are exponents, and the symbols of the case.
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

/// Exponents over the base units.
pub type Exponents = [i32; BASE.len()];

/// Units that people know by another name than that of their base units.
const DERIVED: [(&str, Exponents); 5] = [
    ("N", [1, 1, -2, 0, 0, 0, 0, 0]),
    ("Pa", [1, -1, -2, 0, 0, 0, 0, 0]),
    ("W", [1, 2, -3, 0, 0, 0, 0, 0]),
    ("N m", [1, 2, -2, 0, 0, 0, 0, 0]),
    ("N/m", [1, 0, -2, 0, 0, 0, 0, 0]),
];

/// The unit of a variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// As the FMU calls it; empty for a variable without one.
    pub name: String,
    /// The SI unit as an expression of base units (`kg m/s2`); `None` where the FMU does not define it.
    pub base: Option<String>,
    /// In SI a value is so many times as large.
    pub factor: f64,
    /// What is added then.
    pub offset: f64,
}

impl Unit {
    /// A unit that the FMU names and does not define; its values are taken as they are.
    #[must_use]
    pub fn named(name: &str) -> Self {
        Self { name: name.to_owned(), base: None, factor: 1.0, offset: 0.0 }
    }

    /// One that it defines.
    #[must_use]
    pub fn defined(name: &str, exponents: Exponents, factor: f64, offset: f64) -> Self {
        Self { name: name.to_owned(), base: Some(expression(exponents)), factor, offset }
    }

    /// It is an SI unit, or passes for one.
    #[must_use]
    pub fn is_si(&self) -> bool {
        self.factor == 1.0 && self.offset == 0.0
    }

    /// The SI unit of a value that has crossed: its own name, where that is one.
    #[must_use]
    pub fn si(&self) -> &str {
        match &self.base {
            _ if self.is_si() && fits(&self.name) => &self.name,
            Some(base) if fits(base) => base,
            _ => "1",
        }
    }

    /// A value of the FMU in SI.
    #[must_use]
    pub fn to_si(&self, value: f64) -> f64 {
        if self.is_si() { value } else { self.factor * value + self.offset }
    }

    /// A value in SI as the FMU has it.
    #[must_use]
    pub fn in_own(&self, value: f64) -> f64 {
        if self.is_si() { value } else { (value - self.offset) / self.factor }
    }
}

/// A unit that fits the label of a field.
fn fits(name: &str) -> bool {
    (1..16).contains(&name.len()) && name.chars().all(|c| c.is_ascii_graphic() || c == ' ')
}

/// `kg m/s2` for kg 1, m 1, s −2; `1` for a plain number.
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
