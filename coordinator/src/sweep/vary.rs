//! What a sweep varies: keys of the case, and the values of each.

use serde::{Deserialize, Serialize};

/// Most values of a key.
const MOST: u32 = 100_000;

/// A key and its values, as they are written in a case.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Vary {
    /// The key.
    pub key: String,
    /// Its values.
    pub values: Vec<String>,
}

impl Vary {
    /// Reads `KEY=A,B,C`, `KEY=FROM..TO/COUNT`, or `KEY=FROM..TO/COUNTlog` for values in a constant ratio.
    ///
    /// # Errors
    /// What is wrong, for a person.
    pub(super) fn read(text: &str) -> Result<Self, String> {
        let form = "KEY=A,B,C, or KEY=FROM..TO/COUNT like motion.speed=10..50/5, or …/COUNTlog";
        let wrong = |why: &str| format!("`{text}` {why}; write {form}");
        let (key, values) = text.split_once('=').ok_or_else(|| wrong("names no value"))?;
        let key = key.trim().to_owned();
        let Some((ends, count)) = values.rsplit_once('/').filter(|(ends, _)| ends.contains(".."))
        else {
            let values: Vec<String> = values.split(',').map(|v| v.trim().to_owned()).collect();
            return match values.iter().any(String::is_empty) {
                true => Err(wrong("has an empty value")),
                false => Ok(Self { key, values }),
            };
        };
        let (from, to) = ends.split_once("..").unwrap_or((ends, ""));
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|value| value.is_finite());
        let (Some(from), Some(to)) = (number(from), number(to)) else {
            return Err(wrong("has an end that is no number (a range has SI numbers)"));
        };
        let (count, log) = match count.trim().strip_suffix("log") {
            Some(count) => (count, true),
            None => (count.trim(), false),
        };
        let count: u32 = count.parse().map_err(|_| wrong("has a count that is no whole number"))?;
        if !(2..=MOST).contains(&count) {
            return Err(wrong(&format!("has {count} values, and a range has 2 to {MOST}")));
        }
        if log && from * to <= 0.0 {
            return Err(wrong("has ends without a ratio: they need one sign, and not 0"));
        }
        let value = |n: u32| {
            let part = f64::from(n) / f64::from(count - 1);
            let value = match (n, log) {
                (0, _) => from,
                (n, _) if n == count - 1 => to,
                (_, true) => from * (to / from).powf(part),
                (_, false) => from + part * (to - from),
            };
            // As written by hand: without what rounding adds.
            let short: f64 = format!("{value:.12e}").parse().unwrap_or(value);
            format!("{short:?}")
        };
        Ok(Self { key, values: (0..count).map(value).collect() })
    }

    /// The values as numbers, with their unit where they have one in common; `None` if one is none.
    #[must_use]
    pub(super) fn numbers(&self) -> Option<(Vec<f64>, String)> {
        let parts = self.values.iter().map(|value| {
            let (number, unit) = value.split_once(' ').unwrap_or((value, ""));
            Some((number.parse::<f64>().ok()?, unit.trim()))
        });
        let parts: Vec<(f64, &str)> = parts.collect::<Option<_>>()?;
        let unit = parts.first()?.1;
        let alike = parts.iter().all(|(_, other)| *other == unit);
        alike.then(|| (parts.iter().map(|(number, _)| *number).collect(), unit.to_owned()))
    }
}

/// All combinations, the last key's values in turn first: an index into the values of each key.
pub(super) fn points(vary: &[Vary]) -> impl Iterator<Item = Vec<usize>> + '_ {
    let total: usize = vary.iter().map(|one| one.values.len()).product();
    (0..total).map(move |mut n| {
        let mut at = vec![0; vary.len()];
        for (index, one) in at.iter_mut().zip(vary).rev() {
            *index = n % one.values.len();
            n /= one.values.len();
        }
        at
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<String> {
        Vary::read(text).unwrap().values
    }

    #[test]
    fn values_are_listed_or_between_two_ends() {
        assert_eq!(values("a.b=1, 2 kN,x"), ["1", "2 kN", "x"]);
        assert_eq!(values("a=0.1..0.4/4"), ["0.1", "0.2", "0.3", "0.4"]);
        assert_eq!(values("a=1..1e4/3log"), ["1.0", "100.0", "10000.0"]);
        assert_eq!(values("a=-1..-4/3log"), ["-1.0", "-2.0", "-4.0"]);
        assert_eq!(values("a=up/down,left"), ["up/down", "left"]);
        for (wrong, why) in [
            ("a", "names no value"),
            ("a=1,,2", "empty value"),
            ("a=1..x/3", "no number"),
            ("a=1..2/1", "has 1 values"),
            ("a=1..2/2.5", "no whole number"),
            ("a=-1..2/4log", "without a ratio"),
        ] {
            assert!(Vary::read(wrong).unwrap_err().contains(why), "{wrong}");
        }
    }

    #[test]
    fn numbers_have_a_common_unit() {
        let numbers = |text: &str| Vary::read(text).unwrap().numbers();
        assert_eq!(numbers("a=1 kN,2.5 kN"), Some((vec![1.0, 2.5], "kN".to_owned())));
        assert_eq!(numbers("a=1 kN,2 N"), None);
        assert_eq!(numbers("a=one,two"), None);
    }

    #[test]
    fn the_last_key_goes_first() {
        let vary = ["a=1,2", "b=1,2,3"].map(|text| Vary::read(text).unwrap());
        let all: Vec<Vec<usize>> = points(&vary).collect();
        assert_eq!(all.len(), 6);
        assert_eq!((&all[1], &all[3]), (&vec![0, 1], &vec![1, 0]));
    }
}
