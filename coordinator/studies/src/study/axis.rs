//! What a study varies: a key of the case and its values.

use super::range;
use serde::{Deserialize, Serialize};

/// How values are written.
const FORM: &str = "KEY=A,B,C, or KEY=FROM..TO/COUNT like motion.speed=10..50/5 or load.normal_force=40kN..90kN/3, or KEY=FROM..TO/COUNTlog, or /COUNTcheb";

/// A key and the values it takes, one run after the other.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Axis {
    /// Dotted key of the case.
    pub key: String,
    /// TOML values.
    pub values: Vec<String>,
}

impl Axis {
    /// Reads `KEY=A,B,…`, where a comma within brackets, braces or quotes belongs to its value, or
    /// `KEY=FROM..TO/COUNT`.
    ///
    /// # Errors
    /// No key, no value between two commas, or a range that is none.
    pub fn read(option: &str) -> Result<Self, String> {
        let wrong = |why: &str| format!("`{option}` {why}; write {FORM}");
        let none = || wrong("names no key with values");
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

    /// The values as numbers, with their unit where they have one in common; `None` if one is none.
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

/// How many combinations there are.
pub fn combinations(axes: &[Axis]) -> usize {
    axes.iter().map(|one| one.values.len()).product()
}

/// The combination of this number, from 0 on, the last key's values in turn first: an index into the values
/// of each key.
pub fn combination(axes: &[Axis], mut n: usize) -> Vec<usize> {
    let mut at = vec![0; axes.len()];
    for (index, one) in at.iter_mut().zip(axes).rev() {
        *index = n % one.values.len();
        n /= one.values.len();
    }
    at
}

/// Splits at the commas that stand outside of brackets, braces and quotes.
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
