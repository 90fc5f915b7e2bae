//! Numbers for a reader: few digits, and a unit with a suitable prefix.
//!
//! This module uses no other module of the crate, so that all of them may use it.

use contract::readable::units;
pub use contract::readable::{Scale, number, quantity, superscript};
use std::time::Duration;

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
    let units = units(si);
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
}
