//! Values over a temperature, from the lines of a file, straight between them.

use std::path::Path;

/// Larger files are refused.
const MOST_BYTES: u64 = 1 << 24;

/// `N` values at temperatures [K] that rise.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Curve<const N: usize> {
    points: Vec<(f64, [f64; N])>,
    /// The first and the last values hold beyond them.
    clamps: bool,
}

impl<const N: usize> Curve<N> {
    /// From a file of lines of a temperature and `N` values; `#` begins a comment. `check` says what values have to be.
    ///
    /// # Errors
    /// What is wrong with the file, and in which line.
    pub(crate) fn read(
        path: &Path,
        clamps: bool,
        check: impl Fn(&[f64; N]) -> Result<(), String>,
    ) -> Result<Self, String> {
        let bytes = std::fs::metadata(path).map_err(|error| error.to_string())?.len();
        if bytes > MOST_BYTES {
            return Err(format!("has {bytes} bytes"));
        }
        Self::of(&std::fs::read(path).map_err(|error| error.to_string())?, clamps, check)
    }

    /// The same from text.
    ///
    /// # Errors
    /// What is wrong with it, and in which line.
    pub(crate) fn of(
        text: &[u8],
        clamps: bool,
        check: impl Fn(&[f64; N]) -> Result<(), String>,
    ) -> Result<Self, String> {
        Ok(Self { points: parse(text, check)?, clamps })
    }

    /// No value rises with the temperature.
    pub(crate) fn falls(&self) -> bool {
        let falls = |low: &[f64; N], high: &[f64; N]| low.iter().zip(high).all(|(a, b)| a >= b);
        self.points.windows(2).all(|pair| falls(&pair[0].1, &pair[1].1))
    }

    /// The values at a temperature [K]; `None` beyond the lines, if their ends do not hold there.
    pub(crate) fn at(&self, temperature: f64) -> Option<[f64; N]> {
        let Self { points, clamps } = self;
        let right = points.partition_point(|(at, _)| *at <= temperature);
        let (first, last) = (points[0], points[points.len() - 1]);
        if temperature == last.0 {
            return Some(last.1);
        }
        match right {
            0 => clamps.then_some(first.1),
            _ if right == points.len() => clamps.then_some(last.1),
            _ => {
                let ((t0, low), (t1, high)) = (points[right - 1], points[right]);
                let between =
                    |k: usize| low[k] + (high[k] - low[k]) * (temperature - t0) / (t1 - t0);
                Some(std::array::from_fn(between))
            }
        }
    }
}

fn parse<const N: usize>(
    text: &[u8],
    check: impl Fn(&[f64; N]) -> Result<(), String>,
) -> Result<Vec<(f64, [f64; N])>, String> {
    let text = std::str::from_utf8(text).map_err(|_| "is not text".to_owned())?;
    let mut points: Vec<(f64, [f64; N])> = Vec::new();
    for (line, number) in text.lines().zip(1..) {
        let line = line.split('#').next().unwrap_or_default().trim();
        if line.is_empty() {
            continue;
        }
        let words: Vec<f64> = line
            .split([',', ' ', '\t'])
            .filter(|word| !word.is_empty())
            .map_while(|word| word.parse().ok().filter(|value: &f64| value.is_finite()))
            .collect();
        let split = words.split_first().map(|(first, rest)| (*first, rest.try_into()));
        let Some((temperature, Ok(values))) = split else {
            return Err(format!("is not {} numbers in line {number}", N + 1));
        };
        check(&values).map_err(|reason| format!("{reason} in line {number}"))?;
        if points.last().is_some_and(|(last, _)| temperature <= *last) {
            return Err(format!("does not rise in line {number}"));
        }
        points.push((temperature, values));
    }
    if points.is_empty() { Err("has no line".to_owned()) } else { Ok(points) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn curve<const N: usize>(text: &[u8], clamps: bool) -> Result<Curve<N>, String> {
        let positive = |values: &[f64; N]| match values.iter().all(|value| *value > 0.0) {
            true => Ok(()),
            false => Err("has no value above 0".to_owned()),
        };
        Curve::of(text, clamps, positive)
    }

    #[test]
    fn lines_and_ends() {
        let of = |clamps| curve(b"# rise, f\n0, 0.5\n100 0.3\n200\t0.2 # hot\n", clamps).unwrap();
        assert_eq!(of(false).at(50.0), Some([0.4]));
        assert_eq!(of(false).at(200.0), Some([0.2]));
        assert_eq!((of(false).at(201.0), of(false).at(-1.0)), (None, None));
        assert_eq!((of(true).at(1e9), of(true).at(-1.0)), (Some([0.2]), Some([0.5])));
        let two: Curve<2> = curve(b"0 1 1\n10 0.5 0.25\n", false).unwrap();
        assert_eq!(two.at(5.0), Some([0.75, 0.625]));
        for (text, part) in [
            ("", "no line"),
            ("1,2\n1,2", "line 2"),
            ("1", "2 numbers in line 1"),
            ("0,0", "above 0"),
        ] {
            let error = curve::<1>(text.as_bytes(), false).unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
        assert!(curve::<1>(&[0xff], false).unwrap_err().contains("text"));
    }

    proptest! {
        /// Any bytes are read or refused.
        #[test]
        fn any_bytes_are_read_or_refused(text in "[-0-9eEinfa.,; #\n]{0,200}") {
            if let Ok(curve) = curve::<1>(text.as_bytes(), false) {
                prop_assert!(curve.points.windows(2).all(|pair| pair[0].0 < pair[1].0));
            }
        }
    }
}
