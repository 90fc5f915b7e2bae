//! Numbers for a terminal.

use crate::format::{Scale, number};

/// A value in a unit that fits, as a terminal and its programs read numbers.
pub(super) fn with_unit(value: f64, si: &str, digits: usize) -> String {
    plain(&Scale::of(si, value).show(value, digits))
}

/// A number to some digits, with a plain minus sign.
pub(super) fn digits(value: f64, digits: usize) -> String {
    plain(&number(value, digits))
}

fn plain(text: &str) -> String {
    text.replace('\u{a0}', " ").replace('−', "-")
}

/// A temperature rise [K], with its sign.
pub(super) fn rise(value: f64) -> String {
    let sign = if value < 0.0 { "" } else { "+" };
    format!("{sign}{} K", digits(value, 5))
}
