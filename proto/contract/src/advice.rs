//! Advice of a participant on the effects in a scene, before a run: `--advise`.
//!
//! The coordinator asks the participants in the order of the data flow, and then once more. Each
//! participant adds its estimates of figures, under the keys of the summary. From all estimates
//! known so far it advises on its own effects.

use crate::configuration::Mode;
use crate::params::Params;
use crate::text::check_lines;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Relative change above which an effect matters.
pub const SIGNIFICANT_CHANGE: f64 = 0.01;

/// Estimated figures in SI units, by key in the summary.
pub type Known = BTreeMap<String, f64>;

/// Input of `--advise`, read from standard input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// All values of the case in SI units, with defaults filled in; varying values are those of the
    /// first row.
    pub case: Params,
    /// Steady or transient case.
    pub mode: Mode,
    /// Figures estimated so far.
    pub known: Known,
}

/// Output of `--advise`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Opinion {
    /// Figures that this participant adds.
    #[serde(default)]
    pub known: Known,
    /// Advice on the effects of this participant.
    pub advice: Vec<Advice>,
}

/// Advice on one effect in a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Advice {
    /// Name of the effect.
    pub effect: String,
    /// Dimensionless numbers on which the advice is based.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub numbers: Vec<Number>,
    /// Figure that the effect changes most, and the estimated change against a scene without the
    /// effect; `None` without an estimate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub change: Option<Change>,
    /// The scene has no solution with the effect.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub impossible: bool,
    /// Basis of the estimate, or the reason why there is none, in one line.
    pub why: String,
    /// Arguments of `--set` that add the effect to the case; empty if the case must supply values
    /// that cannot be guessed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<String>,
}

/// A dimensionless number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Number {
    /// Name of the number.
    pub name: String,
    /// Value of the number.
    pub value: f64,
}

/// An estimated change of a figure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Key of the figure in the summary.
    pub figure: String,
    /// Relative change of the magnitude; infinite if the figure exists only with the effect.
    #[serde(with = "unbounded")]
    pub relative: f64,
}

impl Advice {
    /// Returns advice on an effect, without an estimate yet.
    #[must_use]
    pub fn new(effect: &str, why: impl Into<String>) -> Self {
        Self { effect: effect.to_owned(), why: why.into(), ..Self::default() }
    }

    /// Adds a dimensionless number, if finite.
    #[must_use]
    pub fn number(mut self, name: &str, value: f64) -> Self {
        if value.is_finite() {
            self.numbers.push(Number { name: name.to_owned(), value });
        }
        self
    }

    /// Marks the scene as having no solution with the effect.
    #[must_use]
    pub fn impossible(mut self) -> Self {
        self.impossible = true;
        self
    }

    /// Sets the most affected figure and its relative change.
    #[must_use]
    pub fn moves(mut self, figure: impl Into<String>, relative: f64) -> Self {
        if !relative.is_nan() {
            self.change = Some(Change { figure: figure.into(), relative });
        }
        self
    }

    /// Adds a `--set` argument that belongs to the effect.
    #[must_use]
    pub fn with(mut self, set: impl Into<String>) -> Self {
        self.set.push(set.into());
        self
    }

    /// Returns true if the effect changes a figure by [`SIGNIFICANT_CHANGE`] or more, or is
    /// impossible.
    #[must_use]
    pub fn matters(&self) -> bool {
        self.impossible
            || self
                .change
                .as_ref()
                .is_some_and(|change| change.relative.abs() >= SIGNIFICANT_CHANGE)
    }
}

impl Opinion {
    /// Checks an opinion received from another process.
    ///
    /// # Errors
    /// Fails for a text of more than one line and for an estimate that is not finite.
    pub fn check(&self) -> Result<(), String> {
        check_lines("advice", &self.advice)?;
        match self.known.iter().find(|(_, value)| !value.is_finite()) {
            Some((key, _)) => Err(format!("the estimate of `{key}` is not finite")),
            None => Ok(()),
        }
    }
}

/// Writes infinity as `null`, because JSON has no infinity.
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
