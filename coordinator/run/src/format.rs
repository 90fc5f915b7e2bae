//! Numbers for a reader: few digits, and a unit with a suitable prefix.
//!
//! This module uses no other module of the crate, so that all of them may use it.

use std::time::Duration;

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
        let known = prefixed(si);
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

/// Returns the units in which values of this SI unit are shown, the largest first.
fn prefixed(si: &str) -> &'static [(f64, &'static str)] {
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

/// Units by the endings of keys, the longest ending first.
const UNITS: [(&str, &str); 14] = [
    ("_m_per_s", "m/s"),
    ("_per_m", "1/m"),
    ("_bytes", "byte"),
    ("_ohm", "Ohm"),
    ("_v", "V"),
    ("_pa", "Pa"),
    ("_nm", "Nm"),
    ("_m2", "m2"),
    ("_m", "m"),
    ("_n", "N"),
    ("_k", "K"),
    ("_w", "W"),
    ("_j", "J"),
    ("_s", "s"),
];

/// Splits a key of the summary into its stem and its unit.
#[must_use]
pub fn stem_and_unit(key: &str) -> (&str, &'static str) {
    match UNITS.iter().find(|(ending, _)| key.ends_with(ending)) {
        Some((ending, si)) => (key.strip_suffix(ending).unwrap_or(key), si),
        None if key.ends_with("bytes_exchanged") => (key, "byte"),
        None => (key, "-"),
    }
}

/// Returns the unit that suits a value of this key of the summary.
#[must_use]
pub fn of_key(key: &str, value: f64) -> Scale {
    Scale::of(stem_and_unit(key).1, value)
}

/// Returns a ratio in per cent, free of the rounding error of the product.
#[must_use]
pub fn percent(ratio: f64) -> f64 {
    format!("{:.12e}", 100.0 * ratio).parse().unwrap_or(f64::NAN)
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

/// Formats a number with as many digits as give it back, without hundreds of zeros: 1e300 is not
/// written out.
#[must_use]
pub fn exact(value: f64) -> String {
    match value.abs() {
        0.0 | 1e-4..1e7 => value.to_string(),
        _ => format!("{value:e}"),
    }
}

/// Formats a time in minutes and seconds, or hours, minutes and seconds: "1:23", "2:03:04".
#[must_use]
pub fn clock(time: Duration) -> String {
    let seconds = time.as_secs();
    match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
        (0, minutes, seconds) => format!("{minutes}:{seconds:02}"),
        (hours, minutes, seconds) => format!("{hours}:{minutes:02}:{seconds:02}"),
    }
}

/// Formats an exponent in raised digits.
#[must_use]
pub fn superscript(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = |c: char| c.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]);
    exponent.to_string().chars().map(raised).collect()
}

/// Formats a count with its noun: `1 window`, `2 windows`.
#[must_use]
pub fn counted(count: u64, thing: &str) -> String {
    let ending = match count {
        1 => "",
        _ if thing.ends_with("ch") => "es",
        _ => "s",
    };
    format!("{count} {thing}{ending}")
}

/// Returns the name of a field or key as words.
#[must_use]
pub fn words(name: &str) -> String {
    name.replace('_', " ")
}

/// Formats a measured or estimated time to three significant digits.
#[must_use]
pub fn seconds(value: f64) -> String {
    let (factor, unit) = unit_of("s", value);
    format!("{} {unit}", number(value / factor, 3))
}

/// Formats a number of bytes to three significant digits.
#[must_use]
pub fn bytes(value: u64) -> String {
    match unit_of("byte", value as f64) {
        (1.0, unit) => format!("{value} {unit}"),
        (factor, unit) => format!("{} {unit}", number(value as f64 / factor, 3)),
    }
}

/// Formats a time from a case with all of its digits.
#[must_use]
pub fn duration(value: f64) -> String {
    let (factor, unit) = unit_of("s", value);
    // The division adds rounding errors to the digits of the case.
    let digits: f64 = format!("{:.11e}", value / factor).parse().unwrap_or(value);
    format!("{digits} {unit}")
}

/// Returns the largest unit of which a value is at least one, to three digits.
fn unit_of(si: &str, value: f64) -> (f64, &'static str) {
    let units = prefixed(si);
    let fits = |(factor, _): &&(f64, &str)| match value {
        0.0 => *factor == 1.0,
        _ => value >= 0.9995 * factor,
    };
    units.iter().find(fits).or(units.last()).copied().unwrap_or((1.0, ""))
}

/// Returns the text with a capital first letter.
#[must_use]
pub fn sentence(text: &str) -> String {
    let mut rest = text.chars();
    rest.next().map(|first| first.to_uppercase().chain(rest).collect()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn huge_and_tiny_numbers_are_not_written_out() {
        let shown = [0.0, 2.5e-4, -1.0, 1e300, 1e-300].map(exact);
        assert_eq!(shown, ["0", "0.00025", "-1", "1e300", "1e-300"]);
    }

    #[test]
    fn per_cent_is_as_written() {
        assert_eq!([1e-6, 1e-3, 0.07].map(percent), [1e-4, 0.1, 7.0]);
        assert_eq!(percent(1e-6).to_string(), "0.0001");
    }

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
    fn powers_and_plurals_fit() {
        let power = |value: f64| Scale::of("W", value).show(value, 3);
        assert_eq!(
            [power(2.0), power(1530.0), power(25.9e3)].map(|p| p.replace('\u{a0}', " ")),
            ["2.00 W", "1.53 kW", "25.9 kW"]
        );
        let windows = [0, 1, 2].map(|count| counted(count, "window"));
        assert_eq!(windows, ["0 windows", "1 window", "2 windows"]);
        assert_eq!(counted(2, "patch"), "2 patches");
    }

    #[test]
    fn times_and_sizes_have_three_digits() {
        let times = [0.0, 2.5e-10, 9.9999e-7, 0.201145, 0.9996, 1.0, 62.68, 3720.0].map(seconds);
        let shown =
            ["0 s", "0.250 ns", "1.00 µs", "201 ms", "1.00 s", "1.00 s", "62.7 s", "3720 s"];
        assert_eq!(times, shown);
        let sizes = [0, 24, 999, 3660, 999_999, 513_900, 12_345_678].map(bytes);
        assert_eq!(sizes, ["0 B", "24 B", "999 B", "3.66 kB", "1.00 MB", "514 kB", "12.3 MB"]);
        assert_eq!([5e-4, 0.02, 2e-6, 1.5].map(duration), ["500 µs", "20 ms", "2 µs", "1.5 s"]);
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
