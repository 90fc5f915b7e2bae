//! What a participant thinks of effects in a scene, before anything is run: `--advise`.
//!
//! Participants are asked in the order of the flow of data, and then once more: each adds to what is known of the scene the figures
//! that it can estimate, under the keys of the summary, and says of its effects what these figures let it say.

use crate::configuration::Mode;
use crate::params::Params;
use crate::text::check_lines;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Relative change from which on an effect matters.
pub const MATTERS: f64 = 0.01;

/// Estimated figures by their keys in the summary, in SI units.
pub type Known = BTreeMap<String, f64>;

/// On standard input of `--advise`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// All values of the case, in SI units, defaults filled in; those of the first row where they vary.
    pub case: Params,
    /// Steady or transient.
    pub mode: Mode,
    /// What is known so far.
    pub known: Known,
}

/// What `--advise` prints.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Opinion {
    /// What this participant adds to what is known.
    #[serde(default)]
    pub known: Known,
    /// What it says of its effects.
    pub advice: Vec<Advice>,
}

/// What there is to say of an effect in a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Advice {
    /// The effect.
    pub effect: String,
    /// Dimensionless numbers that decide.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub numbers: Vec<Number>,
    /// Which figure the effect moves most, and by about how much against a scene without it; absent where nothing can be said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub change: Option<Change>,
    /// With the effect the scene has no answer.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub impossible: bool,
    /// How it was estimated, or why not, in a line.
    pub why: String,
    /// What adds the effect to the case, as `--set` takes it; empty where the case has to give what cannot be guessed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<String>,
}

/// A dimensionless number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Number {
    /// What it is called.
    pub name: String,
    /// Its value.
    pub value: f64,
}

/// An estimated change of a figure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Key of the figure in the summary.
    pub figure: String,
    /// Relative change of its size; infinite where the figure is not there without the effect.
    #[serde(with = "unbounded")]
    pub relative: f64,
}

impl Advice {
    /// Of an effect, for now without an estimate.
    #[must_use]
    pub fn new(effect: &str, why: impl Into<String>) -> Self {
        Self { effect: effect.to_owned(), why: why.into(), ..Self::default() }
    }

    /// With a number that decides.
    #[must_use]
    pub fn number(mut self, name: &str, value: f64) -> Self {
        if value.is_finite() {
            self.numbers.push(Number { name: name.to_owned(), value });
        }
        self
    }

    /// With it the scene has no answer.
    #[must_use]
    pub fn impossible(mut self) -> Self {
        self.impossible = true;
        self
    }

    /// It moves this figure by this part of its value without the effect.
    #[must_use]
    pub fn moves(mut self, figure: impl Into<String>, relative: f64) -> Self {
        if !relative.is_nan() {
            self.change = Some(Change { figure: figure.into(), relative });
        }
        self
    }

    /// This adds it to the case.
    #[must_use]
    pub fn with(mut self, set: impl Into<String>) -> Self {
        self.set.push(set.into());
        self
    }

    /// The effect moves a figure by enough to be worth its while.
    #[must_use]
    pub fn matters(&self) -> bool {
        self.impossible
            || self.change.as_ref().is_some_and(|change| change.relative.abs() >= MATTERS)
    }
}

impl Opinion {
    /// What is wrong with an opinion that came from outside.
    ///
    /// # Errors
    /// Texts of more than one line, figures that are not finite.
    pub fn check(&self) -> Result<(), String> {
        check_lines("advice", &self.advice)?;
        match self.known.iter().find(|(_, value)| !value.is_finite()) {
            Some((key, _)) => Err(format!("the estimate of `{key}` is not finite")),
            None => Ok(()),
        }
    }
}

/// JSON has no infinity: `null` stands for it.
mod unbounded {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature that serde asks for")]
    pub(super) fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
        value.is_finite().then_some(*value).serialize(to)
    }

    pub(super) fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::<f64>::deserialize(from)?.unwrap_or(f64::INFINITY))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_survives_the_wire() {
        let advice = Advice::new("heat", "why")
            .number("Pe", 3.0)
            .number("none", f64::NAN)
            .moves("temperature.rail.max_rise_k", f64::INFINITY)
            .with("effects.heat={}");
        assert!(advice.matters() && advice.numbers.len() == 1);
        let opinion = Opinion { advice: vec![advice], ..Opinion::default() };
        let text = serde_json::to_string(&opinion).unwrap();
        assert_eq!(serde_json::from_str::<Opinion>(&text).unwrap(), opinion);
        assert_eq!(opinion.check(), Ok(()));
        let little = Advice::new("heat", "two\nlines").moves("a", 0.001);
        assert!(!little.matters());
        assert!(Opinion { advice: vec![little], ..Opinion::default() }.check().is_err());
        let known = [("a".to_owned(), f64::NAN)].into();
        assert!(Opinion { known, advice: Vec::new() }.check().is_err());
    }
}
