//! The file of a surrogate: its layout, and all that has to hold before it is evaluated.
//!
//! It comes from outside. Its length limits what reading it allocates, its numbers of keys, figures, degrees and
//! terms what evaluating it does.

use serde::{Deserialize, Serialize};
use std::collections::HashSet;

/// Version of the layout.
pub const SCHEMA: u32 = 1;
/// Largest degree of a coordinate.
pub const LARGEST_DEGREE: u8 = 32;
/// Longest file \[byte\].
pub const LONGEST: usize = 8 << 20;
/// Most keys, and most coordinates.
const MOST_KEYS: usize = 16;
/// Most figures.
const MOST_FIGURES: usize = 4096;
/// Most terms of all figures.
const MOST_TERMS: usize = 1 << 17;

/// A surrogate as its file has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Document {
    /// Version of the layout, [`SCHEMA`].
    pub schema: u32,
    /// What it was made of.
    pub origin: Origin,
    /// The keys of the case that varied, in the order in which values are given.
    pub keys: Vec<Key>,
    /// What the figures are functions of.
    pub coordinates: Vec<Coordinate>,
    /// The figures.
    pub figures: Vec<FittedFigure>,
}

/// What a surrogate was made of.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Origin {
    /// Name of the case.
    pub case: String,
    /// The case file.
    pub file: String,
    /// What was changed for all runs, as options of `run`.
    pub options: Vec<String>,
    /// Identity of the sweep: a digest of its programs, values and files.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub identity: String,
    /// Points of the sweep that it is fitted to.
    pub points: usize,
    /// Points that have no answer, or were left out with them.
    pub left_out: usize,
}

/// A key of the case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Key {
    /// Dotted key.
    pub key: String,
    /// Its SI unit, "1" for a plain number; empty if it is not known.
    pub unit: String,
    /// Least value \[SI\].
    pub from: f64,
    /// Largest value \[SI\].
    pub to: f64,
}

/// A key, or the quotient of two.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coordinate {
    /// Dotted key.
    pub key: String,
    /// Dotted key by whose value it is divided.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub per: Option<String>,
    /// Least value \[SI\].
    pub from: f64,
    /// Largest value \[SI\].
    pub to: f64,
}

/// How a coordinate or a figure is scaled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// As it is.
    Linear,
    /// Its logarithm.
    Log,
}

/// What an error is relative to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// The value of the figure.
    Relative,
    /// Nothing: it has the unit of the figure.
    Absolute,
}

/// Errors at points that the fit had not seen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Held {
    /// What they are relative to.
    pub measure: Measure,
    /// The largest.
    pub largest: f64,
    /// The root of their mean square.
    pub rms: f64,
}

impl Held {
    /// The largest error of a value, in the unit of the figure.
    #[must_use]
    pub fn bound(&self, value: f64) -> f64 {
        match self.measure {
            Measure::Relative => self.largest * value.abs(),
            Measure::Absolute => self.largest,
        }
    }
}

/// A figure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FittedFigure {
    /// Dotted key in `summary.json`.
    pub key: String,
    /// What it is, in words.
    pub words: String,
    /// Its error.
    pub held: Held,
    /// It is a sum, or the exponential of one.
    pub scale: Scale,
    /// The exponential is taken negative.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub negative: bool,
    /// How each coordinate is scaled for it.
    pub scales: Vec<Scale>,
    /// The terms: a degree for each coordinate.
    pub degrees: Vec<Vec<u8>>,
    /// The factor of each term.
    pub coefficients: Vec<f64>,
}

/// Why a file is no surrogate.
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// It is too long.
    #[error("it has {0} bytes, and a surrogate has at most {LONGEST}")]
    Long(usize),
    /// It is no JSON, or not of this layout.
    #[error("it is not of the layout of a surrogate: {0}")]
    Layout(#[from] serde_json::Error),
    /// It is of another version.
    #[error("its layout has version {0}, supported is {SCHEMA}")]
    Version(u64),
    /// Something in it cannot be.
    #[error("{place}: {what}")]
    Content {
        /// Where.
        place: String,
        /// What.
        what: String,
    },
}

fn refuse<T>(place: &str, what: impl Into<String>) -> Result<T, Fault> {
    Err(Fault::Content { place: place.to_owned(), what: what.into() })
}

/// What the file of every version begins with.
#[derive(Deserialize)]
struct Head {
    schema: u64,
}

impl Document {
    /// Reads a file.
    ///
    /// # Errors
    /// It is too long, of another version or layout, or something in it cannot be.
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

    /// Looks whether everything in it can be.
    ///
    /// # Errors
    /// The first thing that cannot.
    pub fn check(&self) -> Result<(), Fault> {
        let most = [
            ("keys", self.keys.len(), MOST_KEYS),
            ("coordinates", self.coordinates.len(), MOST_KEYS),
            ("figures", self.figures.len(), MOST_FIGURES),
            ("terms", self.figures.iter().map(|one| one.degrees.len()).sum(), MOST_TERMS),
        ];
        for (what, count, most) in most {
            if !(1..=most).contains(&count) {
                return refuse(what, format!("there are {count}; there have to be 1 to {most}"));
            }
        }
        let mut names = HashSet::new();
        let named =
            self.keys.iter().map(|one| &one.key).chain(self.figures.iter().map(|one| &one.key));
        if let Some(twice) = named.into_iter().find(|name| !names.insert(*name)) {
            return refuse(twice, "it is there twice");
        }
        for Key { key, from, to, .. } in &self.keys {
            check_interval(key, *from, *to)?;
        }
        self.coordinates.iter().try_for_each(|one| self.check_coordinate(one))?;
        self.figures.iter().try_for_each(|one| self.check_figure(one))
    }

    /// Where a key is among those of the surrogate.
    #[must_use]
    pub fn place(&self, key: &str) -> Option<usize> {
        self.keys.iter().position(|one| one.key == key)
    }

    /// The same with these figures only, in this order.
    ///
    /// # Errors
    /// The first that it has not.
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
                return refuse(key, "a coordinate is made of it, and it is none of the keys");
            }
        }
        let divisor = one.per.as_ref().and_then(|key| self.keys.get(self.place(key)?));
        match divisor.filter(|key| key.from <= 0.0 && key.to >= 0.0) {
            Some(zero) => refuse(&zero.key, "it can be 0, and a coordinate is divided by it"),
            None => Ok(()),
        }
    }

    fn check_figure(&self, one: &FittedFigure) -> Result<(), Fault> {
        let FittedFigure { key, held, scales, degrees, coefficients, .. } = one;
        if scales.len() != self.coordinates.len() {
            return refuse(key, "it has another number of scales than there are coordinates");
        }
        let logarithmic =
            |(scale, one): (&Scale, &Coordinate)| *scale == Scale::Log && one.from <= 0.0;
        if scales.iter().zip(&self.coordinates).any(logarithmic) {
            return refuse(key, "it takes the logarithm of a coordinate that can be 0 or less");
        }
        if degrees.len() != coefficients.len() || degrees.is_empty() {
            return refuse(key, "each of its terms needs a coefficient");
        }
        if degrees.iter().any(|term| term.len() != self.coordinates.len()) {
            return refuse(key, "a term has another number of degrees than there are coordinates");
        }
        if degrees.iter().flatten().any(|degree| *degree > LARGEST_DEGREE) {
            return refuse(key, format!("a degree is above {LARGEST_DEGREE}"));
        }
        let numbers = coefficients.iter().chain([&held.largest, &held.rms]);
        if numbers.into_iter().any(|number| !number.is_finite())
            || held.largest < 0.0
            || held.rms < 0.0
        {
            return refuse(key, "a number of it is not finite, or an error is negative");
        }
        Ok(())
    }
}

/// An interval has two finite ends, a finite length, and the larger one last.
fn check_interval(key: &str, from: f64, to: f64) -> Result<(), Fault> {
    match from < to && (to - from).is_finite() && (to + from).is_finite() {
        true => Ok(()),
        false => refuse(key, format!("its values go from {from} to {to}, which is no interval")),
    }
}
