//! The axes of a study: keys of the case and the values to run.

use super::range;
use serde::{Deserialize, Serialize};

/// Accepted forms of the option, for error messages.
const FORM: &str = "KEY=A,B,C, or KEY=FROM..TO/COUNT like motion.speed=10..50/5 or load.normal_force=40kN..90kN/3, or KEY=FROM..TO/COUNTlog, or /COUNTcheb";

/// A key and its values, one run each.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Axis {
    /// Dotted key of the case.
    pub key: String,
    /// Values in TOML syntax.
    pub values: Vec<String>,
}

impl Axis {
    /// Parses `KEY=A,B,…` or `KEY=FROM..TO/COUNT`. A comma within brackets, braces or quotes is
    /// part of a value.
    ///
    /// # Errors
    /// The key or a value is empty, or the range is invalid.
    pub fn read(option: &str) -> Result<Self, String> {
        let wrong = |why: &str| format!("`{option}` {why}; write {FORM}");
        let none = || wrong("has no key, or no values");
        let (key, list) = option.split_once('=').ok_or_else(none)?;
        let values = match range::read(list) {
            Some(values) => values.map_err(|why| wrong(&why))?,
            None => split(list).iter().map(|text| text.trim().to_owned()).collect(),
        };
        if key.trim().is_empty() || values.iter().any(String::is_empty) {
            return Err(none());
        }
        Ok(Self { key: key.trim().to_owned(), values })
    }

    /// Returns an axis with a single value.
    #[must_use]
    pub fn of_one(key: &str, value: &str) -> Self {
        Self { key: key.to_owned(), values: vec![value.to_owned()] }
    }

    /// Returns the values as numbers with their common unit; `None` if a value is not a number or
    /// the units differ.
    #[must_use]
    pub fn numbers(&self) -> Option<(Vec<f64>, String)> {
        let parts = self.values.iter().map(|value| {
            let value = value.trim_matches('"');
            let (number, unit) = value.split_once(' ').unwrap_or((value, ""));
            Some((number.parse::<f64>().ok()?, unit.trim()))
        });
        let parts: Vec<(f64, &str)> = parts.collect::<Option<_>>()?;
        let unit = parts.first()?.1;
        let alike = parts.iter().all(|(_, other)| *other == unit);
        alike.then(|| (parts.iter().map(|(number, _)| *number).collect(), unit.to_owned()))
    }
}

/// Number of combinations of all axes.
pub fn combinations(axes: &[Axis]) -> usize {
    axes.iter().map(|one| one.values.len()).product()
}

/// Combination number `n`, counted from 0, as an index into the values of each axis. The last axis
/// varies fastest.
pub fn combination(axes: &[Axis], mut n: usize) -> Vec<usize> {
    let mut at = vec![0; axes.len()];
    for (index, one) in at.iter_mut().zip(axes).rev() {
        *index = n % one.values.len();
        n /= one.values.len();
    }
    at
}

/// Splits at commas outside brackets, braces and quotes.
fn split(list: &str) -> Vec<String> {
    let mut parts = vec![String::new()];
    let (mut depth, mut quote) = (0i32, None);
    for c in list.chars() {
        match (quote, c) {
            (Some(open), _) if c == open => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(c),
            (None, '[' | '{') => depth += 1,
            (None, ']' | '}') => depth -= 1,
            (None, ',') if depth == 0 => {
                parts.push(String::new());
                continue;
            }
            (None, _) => {}
        }
        parts.last_mut().expect("there is one from the start").push(c);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_parted_at_outer_commas() {
        let axis = Axis::read("a.b= 1, [2, 3],{ x = 4, y = 5 },\"six, seven\"").unwrap();
        assert_eq!(axis.key, "a.b");
        assert_eq!(axis.values, ["1", "[2, 3]", "{ x = 4, y = 5 }", "\"six, seven\""]);
        assert_eq!(Axis::read("a=1..3/3").unwrap().values, ["1.0", "2.0", "3.0"]);
    }

    #[test]
    fn an_axis_without_key_or_value_is_refused() {
        for wrong in ["a", "=1", "a=", "a=1,,2", "a=1,", "a=1..2/1"] {
            assert!(Axis::read(wrong).unwrap_err().contains("write KEY=A,B,C"), "{wrong}");
        }
    }

    #[test]
    fn numbers_have_a_common_unit() {
        let numbers = |text: &str| Axis::read(text).unwrap().numbers();
        assert_eq!(numbers("a=1 kN,\"2.5 kN\""), Some((vec![1.0, 2.5], "kN".to_owned())));
        assert_eq!(numbers("a=1 kN,2 N"), None);
        assert_eq!(numbers("a=one,two"), None);
    }

    #[test]
    fn the_last_key_goes_first() {
        let axes = ["a=1,2", "b=1,2,3"].map(|text| Axis::read(text).unwrap());
        assert_eq!(combinations(&axes), 6);
        assert_eq!([1, 3, 5].map(|n| combination(&axes, n)), [[0, 1], [1, 0], [1, 2]]);
    }
}
