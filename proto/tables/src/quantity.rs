//! Quantities as people write them: a number and a unit, "134 kN", "0.6 mm", "140 km/h".
//!
//! The number is a decimal. Powers of ten of the unit shift its exponent before the conversion to
//! `f64`, so "0.6 mm" is exactly the `f64` of 0.0006.

use crate::unit::{Unit, UnitError, parse_unit};
use std::fmt::Write as _;

/// Zero of the Celsius scale \[K\].
const CELSIUS_ZERO: f64 = 273.15;

/// Reason why a text is not the requested quantity.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum QuantityError {
    /// The text does not begin with a decimal number.
    #[error("`{0}` does not begin with a number")]
    NotANumber(String),
    /// The number has a decimal comma instead of a point.
    #[error("`{0}` has a decimal comma; numbers have a point")]
    DecimalComma(String),
    /// The unit is missing.
    #[error("`{text}` has no unit; its unit would be {expected}")]
    NoUnit {
        /// The text.
        text: String,
        /// Requested unit.
        expected: String,
    },
    /// A symbol is unknown.
    #[error("unknown unit `{symbol}`{}", hint(.suggestion.as_deref()))]
    UnknownUnit {
        /// The symbol.
        symbol: String,
        /// Known symbol with a similar spelling.
        suggestion: Option<String>,
    },
    /// The unit is not a product of powers of symbols.
    #[error("`{0}` is not a unit")]
    Syntax(String),
    /// The unit has a different dimension.
    #[error("unit `{found}` cannot be converted to {expected}")]
    Dimension {
        /// The unit in the text.
        found: String,
        /// Requested unit.
        expected: String,
    },
    /// Degrees Celsius occur in a product, power or quotient.
    #[error("°C has its own zero and cannot be part of `{0}`; K can")]
    Celsius(String),
    /// A temperature difference is given in degrees Celsius.
    #[error("`{0}` is a temperature, but a temperature difference is expected")]
    Difference(String),
    /// The value exceeds the range of `f64`.
    #[error("`{0}` is too large")]
    NotFinite(String),
}

fn hint(suggestion: Option<&str>) -> String {
    suggestion.map(|near| format!("; did you mean `{near}`?")).unwrap_or_default()
}

/// Parses a quantity and returns its value in `unit`, an expression like "m", "J/(kg K)" or "1".
///
/// # Errors
/// Fails if the text is not a number with a unit, or if its unit cannot be converted to `unit`.
pub fn parse_quantity(text: &str, unit: &str) -> Result<f64, QuantityError> {
    let expected = parse_unit(unit).map_err(|error| unit_error(error, unit))?;
    let text = text.trim();
    let (number, rest) = split_number(text);
    if !number.contains(|c: char| c.is_ascii_digit()) {
        return Err(QuantityError::NotANumber(text.to_owned()));
    }
    if rest.starts_with(',') {
        return Err(QuantityError::DecimalComma(text.to_owned()));
    }
    let rest = rest.trim();
    if rest.is_empty() && unit.trim() != "1" {
        return Err(QuantityError::NoUnit { text: text.to_owned(), expected: unit.to_owned() });
    }
    let found = if rest.is_empty() { "1" } else { rest };
    let given = parse_unit(found).map_err(|error| unit_error(error, found))?;
    if given.dimension != expected.dimension {
        let (found, expected) = (found.to_owned(), unit.to_owned());
        return Err(QuantityError::Dimension { found, expected });
    }
    let value = scale(number, &given.over(&expected));
    let value = if given.celsius { value + CELSIUS_ZERO } else { value };
    if value.is_finite() { Ok(value) } else { Err(QuantityError::NotFinite(text.to_owned())) }
}

/// Parses a difference, such as a temperature rise, and returns its value in `unit`. A unit with an
/// offset, such as °C, is meaningless for a difference and is refused.
///
/// # Errors
/// Fails like [`parse_quantity`], or if the unit has an offset.
pub fn parse_difference(text: &str, unit: &str) -> Result<f64, QuantityError> {
    let value = parse_quantity(text, unit)?;
    let (_, given) = split_number(text.trim());
    match parse_unit(given) {
        Ok(given) if given.celsius => Err(QuantityError::Difference(text.trim().to_owned())),
        _ => Ok(value),
    }
}

/// Conversion of decimal numbers, written without a unit, from one unit to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Conversion {
    quotient: Unit,
}

impl Conversion {
    /// Returns the conversion from `unit` to `to`.
    ///
    /// # Errors
    /// Fails if either unit is invalid, or if the dimensions differ.
    pub fn new(unit: &str, to: &str) -> Result<Self, QuantityError> {
        let given = parse_unit(unit).map_err(|error| unit_error(error, unit))?;
        let expected = parse_unit(to).map_err(|error| unit_error(error, to))?;
        if given.dimension != expected.dimension {
            let (found, expected) = (unit.to_owned(), to.to_owned());
            return Err(QuantityError::Dimension { found, expected });
        }
        Ok(Self { quotient: Unit { celsius: given.celsius, ..given.over(&expected) } })
    }

    /// Returns true if the unit has an offset, like °C.
    #[must_use]
    pub fn has_offset(&self) -> bool {
        self.quotient.celsius
    }

    /// Converts a decimal number with the same rounding as [`parse_quantity`]. Returns `None` if
    /// the text is not a number or the result is not finite. `scratch` is a buffer reused between
    /// calls.
    #[must_use]
    pub fn apply(&self, number: &str, scratch: &mut String) -> Option<f64> {
        let Unit { ten, num, den, celsius, .. } = self.quotient;
        let decimal: f64 = match ten {
            0 => number.parse().ok()?,
            _ if number.contains(['e', 'E']) => {
                let _: f64 = number.parse().ok()?;
                scale(number, &Unit { num: 1.0, den: 1.0, ..self.quotient })
            }
            _ => {
                scratch.clear();
                // Writing to a string cannot fail.
                let _ = write!(scratch, "{number}e{ten}");
                scratch.parse().ok()?
            }
        };
        let value = decimal * num / den;
        let value = if celsius { value + CELSIUS_ZERO } else { value };
        value.is_finite().then_some(value)
    }
}

/// Returns true if both texts are the same unit.
#[must_use]
pub fn is_same_unit(one: &str, other: &str) -> bool {
    matches!((parse_unit(one), parse_unit(other)), (Ok(one), Ok(other)) if one == other)
}

fn unit_error(error: UnitError, unit: &str) -> QuantityError {
    match error {
        UnitError::Unknown(symbol, suggestion) => QuantityError::UnknownUnit { symbol, suggestion },
        UnitError::Syntax => QuantityError::Syntax(unit.to_owned()),
        UnitError::Celsius => QuantityError::Celsius(unit.to_owned()),
    }
}

/// Splits off the longest decimal number at the start; an `e` without digits belongs to the rest.
fn split_number(text: &str) -> (&str, &str) {
    let sign = usize::from(text.starts_with(['+', '-']));
    let digits = |from: usize| {
        let rest = &text.as_bytes()[from..];
        from + rest.iter().take_while(|b| b.is_ascii_digit() || **b == b'_').count()
    };
    let mut end = digits(sign);
    if text[end..].starts_with('.') {
        end = digits(end + 1);
    }
    if text[end..].starts_with(['e', 'E']) {
        let exponent = end + 1 + usize::from(text[end + 1..].starts_with(['+', '-']));
        if text[exponent..].starts_with(|c: char| c.is_ascii_digit()) {
            end = digits(exponent);
        }
    }
    text.split_at(end)
}

/// Returns a decimal number times a scale, rounded once if the scale is a power of ten.
fn scale(number: &str, unit: &Unit) -> f64 {
    let number = number.replace('_', "");
    let (mantissa, exponent) = number.split_once(['e', 'E']).unwrap_or((&number, "0"));
    // Beyond these exponents the value is infinite or zero for any mantissa that fits into memory.
    let bound = 1_i64 << 40;
    let negative = exponent.starts_with('-');
    let exponent = exponent.parse::<i64>().unwrap_or(if negative { -bound } else { bound });
    let exponent = exponent.clamp(-bound, bound) + i64::from(unit.ten);
    let decimal: f64 = format!("{mantissa}e{exponent}").parse().unwrap_or(f64::NAN);
    decimal * unit.num / unit.den
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit::PREFIXES;
    use proptest::prelude::*;

    #[test]
    fn decimals_are_exact() {
        let exact = [
            ("0.6 mm", "m", 0.0006),
            ("134 kN", "N", 134e3),
            ("210 GPa", "Pa", 210e9),
            ("140 km/h", "m/s", 140.0 / 3.6),
            ("72km/h", "m/s", 20.0),
            ("7.85 t/m³", "kg/m3", 7850.0),
            ("7.85 g/cm^3", "kg/m3", 7850.0),
            ("419.5 J/(kg K)", "J/(kg K)", 419.5),
            ("0.4195 kJ/(kg*K)", "J/(kg K)", 419.5),
            ("50 W/m/K", "W/(m·K)", 50.0),
            ("50 W m-1 K^-1", "W/(m K)", 50.0),
            ("14 mm²/s", "m^2/s", 14e-6),
            ("14 mm2/s", "m²/s", 14e-6),
            ("3 kN/m", "N/m", 3000.0),
            ("0.2 1/m", "rad/m", 0.2),
            ("0.2 rad/m", "1/m", 0.2),
            ("2.7e-12 m/Pa", "m/Pa", 2.7e-12),
            ("1.2 %", "1", 0.012),
            ("0.3", "1", 0.3),
            ("30 °C", "K", 303.15),
            ("20 degC", "K", 293.15),
            ("300 K", "K", 300.0),
            ("5 µm", "m", 5e-6),
            ("5 μm", "m", 5e-6),
            ("5 um", "m", 5e-6),
            ("90 min", "s", 5400.0),
            ("2 h", "s", 7200.0),
            ("1.5 bar", "Pa", 1.5e5),
            ("3 t", "kg", 3000.0),
            ("64 MB", "B", 64e6),
            ("2 KiB", "B", 2048.0),
            ("1_000 Hz", "1/s", 1000.0),
            ("-6.5e-2 cm", "m", -6.5e-4),
            ("180 deg", "rad", std::f64::consts::PI),
            ("4 (m/s)^2", "m2/s2", 4.0),
            ("9 s^(-1)", "Hz", 9.0),
        ];
        for (text, unit, value) in exact {
            assert_eq!(parse_quantity(text, unit), Ok(value), "{text} in {unit}");
        }
    }

    #[test]
    fn errors_name_the_cause() {
        let cases = [
            ("fast", "m/s", "`fast` does not begin with a number"),
            ("", "m", "`` does not begin with a number"),
            ("-", "m", "`-` does not begin with a number"),
            ("nan m", "m", "`nan m` does not begin with a number"),
            ("0,6 mm", "m", "`0,6 mm` has a decimal comma; numbers have a point"),
            ("0.46", "m", "`0.46` has no unit; its unit would be m"),
            ("140 kmh", "m/s", "unknown unit `kmh`; did you mean `km/h`?"),
            ("134 kNN", "N", "unknown unit `kNN`; did you mean `kN`?"),
            ("20 celsius", "K", "unknown unit `celsius`; did you mean `°C`?"),
            ("210 Gpa", "Pa", "unknown unit `Gpa`; did you mean `GPa`?"),
            ("3 furlong", "m", "unknown unit `furlong`"),
            ("3 m/", "m", "`m/` is not a unit"),
            ("3 m^", "m", "`m^` is not a unit"),
            ("3 (m", "m", "`(m` is not a unit"),
            ("3 m)", "m", "`m)` is not a unit"),
            ("3 m^99", "m", "`m^99` is not a unit"),
            ("3 ((((((((((m))))))))))", "m", "`((((((((((m))))))))))` is not a unit"),
            ("140 km/h", "N", "unit `km/h` cannot be converted to N"),
            ("64 MB", "1", "unit `MB` cannot be converted to 1"),
            ("3 %", "m", "unit `%` cannot be converted to m"),
            (
                "3 W/(m °C)",
                "W/(m K)",
                "°C has its own zero and cannot be part of `W/(m °C)`; K can",
            ),
            ("3 °C^1", "K", "°C has its own zero and cannot be part of `°C^1`; K can"),
            ("1e400 m", "m", "`1e400 m` is too large"),
            ("1e99999999999999999999 m", "m", "`1e99999999999999999999 m` is too large"),
        ];
        for (text, unit, message) in cases {
            let error = parse_quantity(text, unit).expect_err(text);
            assert_eq!(error.to_string(), message);
        }
    }

    /// A difference in °C would be 273.15 K too large and is refused; units without an offset are
    /// accepted.
    #[test]
    fn a_difference_has_no_zero() {
        assert_eq!(parse_difference("200 K", "K"), Ok(200.0));
        assert_eq!(parse_difference("200 mK", "K"), Ok(0.2));
        assert_eq!(parse_difference("3 K/s", "K/s"), Ok(3.0));
        for text in ["200 °C", "200degC", " 200 °C "] {
            let refused = QuantityError::Difference(text.trim().to_owned());
            assert_eq!(parse_difference(text, "K"), Err(refused), "{text}");
        }
        let message = parse_difference("2 °C", "m").unwrap_err().to_string();
        assert_eq!(message, "unit `°C` cannot be converted to m");
    }

    /// Columns of tables are converted to the same bits as quantities of a case.
    #[test]
    fn a_conversion_is_that_of_the_quantity() {
        let mut scratch = String::new();
        for (unit, si) in
            [("mm", "m"), ("km/h", "m/s"), ("°C", "K"), ("kN", "N"), ("%", "1"), ("m", "m")]
        {
            let conversion = Conversion::new(unit, si).unwrap();
            for number in ["0.6", "-36.9985632", "140", "+1.5", "1e-3", "2.5E2", "0"] {
                let expected = parse_quantity(&format!("{number} {unit}"), si).unwrap();
                assert_eq!(
                    conversion.apply(number, &mut scratch),
                    Some(expected),
                    "{number} {unit}"
                );
            }
            assert_eq!(conversion.apply("1,5", &mut scratch), None);
            assert_eq!(conversion.apply("nan", &mut scratch), None);
        }
        assert!(Conversion::new("kN", "m").is_err());
        assert!(is_same_unit("m/s", "m s-1") && !is_same_unit("m/s", "km/h"));
    }

    #[test]
    fn an_e_without_digits_belongs_to_the_unit() {
        assert_eq!(split_number("1e3 m"), ("1e3", " m"));
        assert_eq!(split_number("1 e"), ("1", " e"));
        assert_eq!(split_number("1eV"), ("1", "eV"));
        assert_eq!(split_number("1e-"), ("1", "e-"));
        assert_eq!(split_number(".5mm"), (".5", "mm"));
        assert_eq!(parse_quantity("1e-99999999999999999999 m", "m"), Ok(0.0));
    }

    proptest! {
        #[test]
        fn any_number_survives_its_own_unit(value in any::<f64>().prop_filter("finite", |v| v.is_finite())) {
            prop_assert_eq!(parse_quantity(&format!("{value:e} m"), "m"), Ok(value));
            prop_assert_eq!(parse_quantity(&format!("{value}"), "1"), Ok(value));
        }

        #[test]
        fn a_prefix_is_an_exponent(digits in -999_999_i64..999_999, places in 0_u32..9, which in 0..PREFIXES.len()) {
            let (prefix, ten) = PREFIXES[which];
            let number = format!("{digits}e-{places}");
            let literal: f64 = format!("{digits}e{}", i64::from(ten) - i64::from(places)).parse().unwrap();
            prop_assert_eq!(parse_quantity(&format!("{number} {prefix}Pa"), "Pa"), Ok(literal));
        }

        #[test]
        fn a_unit_over_itself_is_one(power in -9_i32..=9, which in 0..PREFIXES.len()) {
            let unit = format!("{}N^{power}", PREFIXES[which].0);
            prop_assert_eq!(parse_quantity(&format!("2.5 {unit}"), &unit), Ok(2.5));
        }

        #[test]
        fn no_text_panics(text in ".*", unit in ".*") {
            let _ = parse_quantity(&text, "m");
            let _ = parse_quantity(&format!("1 {text}"), "J/(kg K)");
            let _ = parse_quantity("1 m", &unit);
        }

        #[test]
        fn no_unit_like_text_panics(text in "[-+0-9eE._mskgKNPaW°C%/*·^()²⁻ ]*") {
            if let Ok(value) = parse_quantity(&text, "m/s") {
                prop_assert!(value.is_finite());
            }
        }
    }
}
