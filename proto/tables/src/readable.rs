//! Numbers and quantities for a reader: few digits, and a unit with a suitable prefix.
//!
//! Messages, summaries and pages show numbers through this module; [`crate::quantity`] reads what a
//! user writes.

/// A unit in which values are shown, with its conversion to SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// Number of SI units in one of this unit \[-\].
    pub factor: f64,
    /// Spelling of the unit; empty for a pure number.
    pub unit: String,
}

impl Scale {
    /// Returns the unit for SI values up to `largest` in magnitude. `largest` usually is at least
    /// two of this unit, if there is a unit that small.
    #[must_use]
    pub fn of(si: &str, largest: f64) -> Self {
        let known = units(si);
        let suits = |(factor, _): &&(f64, &str)| largest.abs() >= enough(si) * factor;
        let chosen = known.iter().find(suits).or(match largest == 0.0 || !largest.is_finite() {
            true => known.iter().find(|(factor, _)| *factor == 1.0),
            false => known.last(),
        });
        match chosen {
            Some((factor, unit)) => Self { factor: *factor, unit: (*unit).to_owned() },
            None => Self { factor: 1.0, unit: spelt(si) },
        }
    }

    /// Formats a value in this unit to `digits` significant digits.
    #[must_use]
    pub fn show(&self, value: f64, digits: usize) -> String {
        let number = number(value / self.factor, digits);
        if self.unit.is_empty() { number } else { format!("{number}\u{a0}{}", self.unit) }
    }
}

/// Returns the smallest value that is shown in a unit, in that unit.
fn enough(si: &str) -> f64 {
    match si {
        "m/s" => 0.05,
        "W" | "N" | "Nm" => 1.0,
        _ => 2.0,
    }
}

/// Returns the units in which values of this SI unit are shown, the largest first, and their sizes.
#[must_use]
pub fn units(si: &str) -> &'static [(f64, &'static str)] {
    match si {
        "Pa" => &[(1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa"), (1.0, "Pa")],
        "m" => &[(1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm")],
        "s" => &[(1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns")],
        "N" => &[(1e6, "MN"), (1e3, "kN"), (1.0, "N"), (1e-3, "mN"), (1e-6, "µN")],
        "Nm" => &[(1e3, "kN·m"), (1.0, "N·m"), (1e-3, "mN·m")],
        "W" => &[(1e6, "MW"), (1e3, "kW"), (1.0, "W"), (1e-3, "mW"), (1e-6, "µW")],
        "J" => &[(1e6, "MJ"), (1e3, "kJ"), (1.0, "J"), (1e-3, "mJ"), (1e-6, "µJ")],
        "W/m2" => &[(1e9, "GW/m²"), (1e6, "MW/m²"), (1e3, "kW/m²"), (1.0, "W/m²")],
        "m/s" => &[(1.0, "m/s"), (1e-3, "mm/s"), (1e-6, "µm/s")],
        "m2" => &[(1.0, "m²"), (1e-6, "mm²")],
        "V" => &[(1e3, "kV"), (1.0, "V"), (1e-3, "mV"), (1e-6, "µV")],
        "Ohm" => &[(1e3, "kΩ"), (1.0, "Ω"), (1e-3, "mΩ"), (1e-6, "µΩ"), (1e-9, "nΩ")],
        "byte" => &[(1e9, "GB"), (1e6, "MB"), (1e3, "kB"), (1.0, "B")],
        _ => &[],
    }
}

fn spelt(si: &str) -> String {
    match si {
        "-" | "1" => String::new(),
        other => other.replace("m2", "m²").replace("m3", "m³"),
    }
}

/// Formats a number to `digits` significant digits with a true minus sign; a whole number keeps all
/// its digits. Very large and very small numbers get a power of ten.
#[must_use]
pub fn number(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return "not finite".to_owned();
    }
    // Whole numbers, which may be counts, keep all their digits. Otherwise rounding comes first:
    // 999.96 is 1000 to four digits.
    let rounded = match value.fract() == 0.0 && value.abs() < 1e6 {
        true => value,
        false => format!("{value:.*e}", digits.max(1) - 1).parse().unwrap_or(value),
    };
    let magnitude = rounded.abs().log10().floor() as i32;
    let text = if (-4..6).contains(&magnitude) {
        let decimals = (digits as i32 - 1 - magnitude).max(0) as usize;
        format!("{rounded:.decimals$}")
    } else {
        let mantissa = rounded / 10f64.powi(magnitude);
        format!("{mantissa:.*} × 10{}", digits.min(3) - 1, superscript(magnitude))
    };
    text.replace('-', "−")
}

/// Formats a value in SI units to `digits` significant digits, in a unit with a suitable prefix:
/// `7.896 mm`. A case accepts most of such texts.
#[must_use]
pub fn quantity(value: f64, si: &str, digits: usize) -> String {
    Scale::of(si, value).show(value, digits).replace('\u{a0}', " ")
}

/// Formats an exponent in raised digits.
#[must_use]
pub fn superscript(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = |c: char| c.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]);
    exponent.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_suit_the_values() {
        let shown = |si: &str, value: f64| Scale::of(si, value).show(value, 4);
        assert_eq!(shown("Pa", 1.36444e9), "1364\u{a0}MPa");
        assert_eq!(shown("m", 7.8959e-3), "7.896\u{a0}mm");
        assert_eq!(shown("m", -54.8e-6), "−54.80\u{a0}µm");
        assert_eq!(shown("m/s", 0.7793), "0.7793\u{a0}m/s");
        assert_eq!(shown("W/m2", 3.2e8), "320.0\u{a0}MW/m²");
        assert_eq!(shown("K", 225.912), "225.9\u{a0}K");
        assert_eq!(shown("-", 0.58), "0.5800");
        assert_eq!(shown("Pa", 0.0), "0\u{a0}Pa");
    }

    #[test]
    fn messages_have_plain_blanks() {
        let shown = [(7.8959e-3, "m"), (2.5e-5, "s"), (3.2e8, "Pa")];
        let shown = shown.map(|(value, si)| quantity(value, si, 3));
        assert_eq!(shown, ["7.90 mm", "25.0 µs", "320 MPa"]);
    }

    #[test]
    fn numbers_keep_their_digits() {
        assert_eq!(number(999.96, 4), "1000");
        assert_eq!(
            [120_005.0, 12_345.0, 12_345.6].map(|value| number(value, 4)),
            ["120005", "12345", "12350"]
        );
        assert_eq!(number(-0.0123456, 3), "−0.0123");
        assert_eq!(number(2.24e-16, 2), "2.2 × 10⁻¹⁶");
        assert_eq!(number(f64::NAN, 2), "not finite");
    }
}
