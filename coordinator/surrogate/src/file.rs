//! Layout and validation of the file of a surrogate.
//!
//! The file is untrusted. The limit on its length bounds the memory for reading; the limits on
//! keys, figures, degrees and terms bound the work of an evaluation.

use serde::{Deserialize, Serialize};
use std::collections::HashSet;

/// Version of the layout.
pub const SCHEMA: u32 = 1;
/// Largest degree of a coordinate.
pub const LARGEST_DEGREE: u8 = 32;
/// Largest length of the file \[byte\].
pub const LONGEST: usize = 8 << 20;
/// Maximum number of keys, and of coordinates.
const MOST_KEYS: usize = 16;
/// Maximum number of figures.
const MOST_FIGURES: usize = 4096;
/// Maximum number of terms of all figures together.
const MOST_TERMS: usize = 1 << 17;

/// Contents of the file of a surrogate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Document {
    /// Version of the layout, [`SCHEMA`].
    pub schema: u32,
    /// Sweep to which the surrogate is fitted.
    pub origin: Origin,
    /// Varied keys of the case, in the order of the values of a point.
    pub keys: Vec<Key>,
    /// Arguments of the figures.
    pub coordinates: Vec<Coordinate>,
    /// Fitted figures.
    pub figures: Vec<FittedFigure>,
}

/// Origin of a surrogate.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Origin {
    /// Name of the case.
    pub case: String,
    /// The case file.
    pub file: String,
    /// Changes common to all runs, as options of `run`.
    pub options: Vec<String>,
    /// Identity of the sweep: a digest of its programs, values and files.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub identity: String,
    /// Number of points used for the fit.
    pub points: usize,
    /// Number of points left out: points without a result, and points outside the box.
    pub left_out: usize,
}

/// A varied key of the case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Key {
    /// Dotted key.
    pub key: String,
    /// SI unit, "1" for a plain number; empty if unknown.
    pub unit: String,
    /// Smallest value \[SI\].
    pub from: f64,
    /// Largest value \[SI\].
    pub to: f64,
}

/// A coordinate: a key, or the quotient of two keys.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coordinate {
    /// Dotted key.
    pub key: String,
    /// Dotted key of the divisor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub per: Option<String>,
    /// Smallest value \[SI\].
    pub from: f64,
    /// Largest value \[SI\].
    pub to: f64,
}

/// Scale of a coordinate or figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// Linear scale.
    Linear,
    /// Logarithmic scale.
    Log,
}

/// Measure of an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// Relative to the value of the figure.
    Relative,
    /// Absolute, in the unit of the figure.
    Absolute,
}

/// Errors at points that were held out of the fit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeldOutError {
    /// Measure of the errors.
    pub measure: Measure,
    /// Largest error.
    pub largest: f64,
    /// Root mean square of the errors.
    pub rms: f64,
}

impl HeldOutError {
    /// Largest error for a value, in the unit of the figure.
    #[must_use]
    pub fn bound(&self, value: f64) -> f64 {
        match self.measure {
            Measure::Relative => self.largest * value.abs(),
            Measure::Absolute => self.largest,
        }
    }
}

/// A fitted figure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FittedFigure {
    /// Dotted key in `summary.json`.
    pub key: String,
    /// Description in words.
    pub words: String,
    /// Error of the fit.
    pub held: HeldOutError,
    /// Scale: the figure is a sum, or the exponential of a sum.
    pub scale: Scale,
    /// Whether the exponential has a negative sign.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub negative: bool,
    /// Scale of each coordinate.
    pub scales: Vec<Scale>,
    /// Terms: one degree for each coordinate.
    pub degrees: Vec<Vec<u8>>,
    /// Coefficient of each term.
    pub coefficients: Vec<f64>,
}

/// Reason why a file is not a valid surrogate.
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// The file is too long.
    #[error("the file has {0} bytes; at most {LONGEST} are allowed")]
    Long(usize),
    /// The file is not JSON, or has another layout.
    #[error("the file does not have the layout of a surrogate: {0}")]
    Layout(#[from] serde_json::Error),
    /// The file has another version.
    #[error("the layout has version {0}, supported is {SCHEMA}")]
    Version(u64),
    /// The contents are invalid.
    #[error("{place}: {what}")]
    Content {
        /// Place of the problem: a key or a list.
        place: String,
        /// Description of the problem.
        what: String,
    },
}

fn refuse<T>(place: &str, what: impl Into<String>) -> Result<T, Fault> {
    Err(Fault::Content { place: place.to_owned(), what: what.into() })
}

/// Keys common to the files of all versions.
#[derive(Deserialize)]
struct Head {
    schema: u64,
}

impl Document {
    /// Reads and validates a surrogate.
    ///
    /// # Errors
    /// The file is too long, has another version or layout, or its contents are invalid.
    pub fn read(text: &[u8]) -> Result<Self, Fault> {
        if text.len() > LONGEST {
            return Err(Fault::Long(text.len()));
        }
        let Head { schema } = serde_json::from_slice(text)?;
        if schema != u64::from(SCHEMA) {
            return Err(Fault::Version(schema));
        }
        let document: Self = serde_json::from_slice(text)?;
        document.check()?;
        Ok(document)
    }

    /// Validates the contents.
    ///
    /// # Errors
    /// The first problem found: too few or too many entries, duplicate or unknown keys, empty
    /// intervals, or inconsistent figures.
    pub fn check(&self) -> Result<(), Fault> {
        let most = [
            ("keys", self.keys.len(), MOST_KEYS),
            ("coordinates", self.coordinates.len(), MOST_KEYS),
            ("figures", self.figures.len(), MOST_FIGURES),
            ("terms", self.figures.iter().map(|one| one.degrees.len()).sum(), MOST_TERMS),
        ];
        for (what, count, most) in most {
            if !(1..=most).contains(&count) {
                return refuse(what, format!("there are {count}; allowed are 1 to {most}"));
            }
        }
        let mut names = HashSet::new();
        let named =
            self.keys.iter().map(|one| &one.key).chain(self.figures.iter().map(|one| &one.key));
        if let Some(twice) = named.into_iter().find(|name| !names.insert(*name)) {
            return refuse(twice, "defined twice");
        }
        for Key { key, from, to, .. } in &self.keys {
            check_interval(key, *from, *to)?;
        }
        self.coordinates.iter().try_for_each(|one| self.check_coordinate(one))?;
        self.figures.iter().try_for_each(|one| self.check_figure(one))
    }

    /// Index of a key.
    #[must_use]
    pub fn place(&self, key: &str) -> Option<usize> {
        self.keys.iter().position(|one| one.key == key)
    }

    /// Returns a copy with only these figures, in this order.
    ///
    /// # Errors
    /// The first figure that does not exist.
    pub fn only<'a>(&self, figures: &[&'a str]) -> Result<Self, &'a str> {
        let find = |key: &&'a str| {
            let found = self.figures.iter().find(|one| one.key == **key);
            found.cloned().ok_or(*key)
        };
        let figures = figures.iter().map(find).collect::<Result<Vec<_>, _>>()?;
        Ok(Self { figures, ..self.clone() })
    }

    fn check_coordinate(&self, one: &Coordinate) -> Result<(), Fault> {
        check_interval(&one.key, one.from, one.to)?;
        for key in std::iter::once(&one.key).chain(&one.per) {
            if self.place(key).is_none() {
                return refuse(key, "a coordinate refers to this key, which does not exist");
            }
        }
        let divisor = one.per.as_ref().and_then(|key| self.keys.get(self.place(key)?));
        match divisor.filter(|key| key.from <= 0.0 && key.to >= 0.0) {
            Some(zero) => refuse(&zero.key, "its range includes 0, but it is a divisor"),
            None => Ok(()),
        }
    }

    fn check_figure(&self, one: &FittedFigure) -> Result<(), Fault> {
        let FittedFigure { key, held, scales, degrees, coefficients, .. } = one;
        if scales.len() != self.coordinates.len() {
            return refuse(key, "its number of scales differs from the number of coordinates");
        }
        let logarithmic =
            |(scale, one): (&Scale, &Coordinate)| *scale == Scale::Log && one.from <= 0.0;
        if scales.iter().zip(&self.coordinates).any(logarithmic) {
            return refuse(key, "it takes the logarithm of a coordinate that can be 0 or negative");
        }
        if degrees.len() != coefficients.len() || degrees.is_empty() {
            return refuse(key, "each of its terms needs a coefficient");
        }
        if degrees.iter().any(|term| term.len() != self.coordinates.len()) {
            return refuse(
                key,
                "the number of degrees of a term differs from the number of coordinates",
            );
        }
        if degrees.iter().flatten().any(|degree| *degree > LARGEST_DEGREE) {
            return refuse(key, format!("a degree is above {LARGEST_DEGREE}"));
        }
        let numbers = coefficients.iter().chain([&held.largest, &held.rms]);
        if numbers.into_iter().any(|number| !number.is_finite())
            || held.largest < 0.0
            || held.rms < 0.0
        {
            return refuse(key, "a number is not finite, or an error is negative");
        }
        Ok(())
    }
}

/// Checks that an interval has finite ends and a positive, finite length.
fn check_interval(key: &str, from: f64, to: f64) -> Result<(), Fault> {
    match from < to && (to - from).is_finite() && (to + from).is_finite() {
        true => Ok(()),
        false => refuse(key, format!("the range from {from} to {to} is not an interval")),
    }
}
