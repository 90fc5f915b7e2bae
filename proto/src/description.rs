//! What a participant says of itself, before any run: `--describe` prints it as JSON.
//!
//! The coordinator knows no physics. Which models and effects exist, which case keys they read,
//! in which unit and range, and which fields they exchange, it learns from here.

use crate::field::{FieldKind, FieldSpec};
use crate::grid::check_name;
use serde::{Deserialize, Serialize};

/// Everything a participant says of itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Description {
    /// Version of the contract it speaks ([`crate::PROTOCOL_VERSION`]).
    pub protocol: u32,
    /// Name of the program.
    pub name: String,
    /// Version of the program.
    pub version: String,
    /// The role it plays: `mech`, `thermal`, or another word that a case names as a table.
    pub role: String,
    /// It has an answer of its own even if no effect is active. A participant without is started
    /// only when an active effect needs it.
    pub standalone: bool,
    /// It answers `--estimate`.
    pub estimates: bool,
    /// Models, cheapest first.
    pub models: Vec<ModelSpec>,
    /// Effects it can take part in.
    pub effects: Vec<EffectSpec>,
    /// Case keys it reads whatever the model; keys of a model or an effect stand there.
    pub keys: Vec<KeySpec>,
    /// Fields that are not in [`crate::field::TABLE`].
    #[serde(default)]
    pub fields: Vec<FieldKind>,
}

impl Description {
    /// What is wrong with a description that came from outside.
    ///
    /// # Errors
    /// Names that are no plain words, and fields without components or with a unit that does not
    /// fit its label.
    pub fn check(&self) -> Result<(), String> {
        check_name("role", &self.role)?;
        for field in &self.fields {
            check_name("field", &field.name)?;
            let unit = &field.unit;
            if unit.is_empty() || unit.len() > 15 || !unit.is_ascii() {
                return Err(format!("field `{}` has the unit {unit:?}", field.name));
            }
            if !(1..=64).contains(&field.components) {
                return Err(format!("field `{}` has {} components", field.name, field.components));
            }
        }
        Ok(())
    }
}

/// One model (fidelity level) of a participant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelSpec {
    /// Name in the case file, `[ROLE] model = "NAME"`.
    pub name: String,
    /// One line: what it computes.
    pub summary: String,
    /// Where the equations come from.
    pub source: String,
    /// It can answer a steady case.
    pub steady: bool,
    /// It can answer a transient case.
    pub transient: bool,
    /// Fields it always consumes, by name.
    pub consumes: Vec<String>,
    /// Fields it always can provide, by name.
    pub provides: Vec<String>,
    /// Case keys that only this model reads.
    pub keys: Vec<KeySpec>,
}

/// One participant's part in an effect. Several participants may claim the same effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectSpec {
    /// Name in the case file, `[effects.NAME]`.
    pub name: String,
    /// The law, as a formula or a sentence.
    pub law: String,
    /// Where the law comes from.
    pub source: String,
    /// Models of this participant that support it, by name.
    pub models: Vec<String>,
    /// Fields it consumes, by name.
    pub consumes: Vec<String>,
    /// Fields it provides, by name.
    pub provides: Vec<String>,
    /// Parameters: keys under `effects.NAME` (and elsewhere).
    pub keys: Vec<KeySpec>,
}

/// One key of the case file, its type, its range and what it is for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeySpec {
    /// Dotted path; `*` stands for any one name (`materials.*.density`).
    pub path: String,
    /// Type of the value.
    #[serde(flatten)]
    pub kind: KeyKind,
    /// A case that reaches the participant must have it.
    #[serde(default)]
    pub required: bool,
    /// Value used when the case does not have it (SI).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub default: Option<serde_json::Value>,
    /// Numbers must be greater than this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub above: Option<f64>,
    /// Numbers must be at least this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_least: Option<f64>,
    /// Numbers must be at most this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_most: Option<f64>,
    /// The magnitude must be less than the product of these other keys' values.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub magnitude_below: Vec<String>,
    /// Of all keys with the same word here exactly one must be given; setting one replaces the
    /// others. A table (`motion.creepage`) counts through its keys.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub one_of: Option<String>,
    /// Of all keys with the same word here all or none must be given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub together: Option<String>,
    /// One line for people.
    pub help: String,
}

/// Type of a case value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case")]
pub enum KeyKind {
    /// A number in SI units, or a string with a unit of this dimension.
    Quantity {
        /// The SI unit, as an expression ("m", "N", "J/(kg K)", "1/m", "1" for a plain number).
        unit: String,
    },
    /// A whole number.
    Integer,
    /// True or false.
    Flag,
    /// One of these words.
    Choice {
        /// The words.
        of: Vec<String>,
    },
    /// Any text.
    Text,
    /// A file; a relative path is meant from the case file's folder, and reaches the participant as
    /// an absolute one.
    File,
    /// Name of a table under this path (`materials`).
    NameIn {
        /// Path of the parent table.
        table: String,
    },
}

impl KeySpec {
    fn new(path: &str, kind: KeyKind, help: &str) -> Self {
        Self {
            path: path.to_owned(),
            kind,
            required: false,
            default: None,
            above: None,
            at_least: None,
            at_most: None,
            magnitude_below: Vec::new(),
            one_of: None,
            together: None,
            help: help.to_owned(),
        }
    }

    /// A number with a unit.
    #[must_use]
    pub fn quantity(path: &str, unit: &str, help: &str) -> Self {
        Self::new(path, KeyKind::Quantity { unit: unit.to_owned() }, help)
    }

    /// A number without a unit.
    #[must_use]
    pub fn number(path: &str, help: &str) -> Self {
        Self::quantity(path, "1", help)
    }

    /// A whole number.
    #[must_use]
    pub fn integer(path: &str, help: &str) -> Self {
        Self::new(path, KeyKind::Integer, help)
    }

    /// One of some words.
    #[must_use]
    pub fn choice(path: &str, of: &[&str], help: &str) -> Self {
        let of = of.iter().map(|s| (*s).to_owned()).collect();
        Self::new(path, KeyKind::Choice { of }, help)
    }

    /// Any text.
    #[must_use]
    pub fn text(path: &str, help: &str) -> Self {
        Self::new(path, KeyKind::Text, help)
    }

    /// True or false.
    #[must_use]
    pub fn flag(path: &str, help: &str) -> Self {
        Self::new(path, KeyKind::Flag, help)
    }

    /// A file that exists.
    #[must_use]
    pub fn file(path: &str, help: &str) -> Self {
        Self::new(path, KeyKind::File, help)
    }

    /// The name of a table under `table`.
    #[must_use]
    pub fn name_in(path: &str, table: &str, help: &str) -> Self {
        Self::new(path, KeyKind::NameIn { table: table.to_owned() }, help)
    }

    /// The case must have it.
    #[must_use]
    pub fn required(mut self) -> Self {
        self.required = true;
        self
    }

    /// Used when the case does not have it.
    #[must_use]
    pub fn default_value(mut self, value: impl Into<serde_json::Value>) -> Self {
        self.default = Some(value.into());
        self
    }

    /// Greater than.
    #[must_use]
    pub fn above(mut self, bound: f64) -> Self {
        self.above = Some(bound);
        self
    }

    /// At least.
    #[must_use]
    pub fn at_least(mut self, bound: f64) -> Self {
        self.at_least = Some(bound);
        self
    }

    /// At most.
    #[must_use]
    pub fn at_most(mut self, bound: f64) -> Self {
        self.at_most = Some(bound);
        self
    }

    /// Smaller in magnitude than the product of other keys.
    #[must_use]
    pub fn magnitude_below(mut self, keys: &[&str]) -> Self {
        self.magnitude_below = keys.iter().map(|s| (*s).to_owned()).collect();
        self
    }

    /// One of a group of alternatives.
    #[must_use]
    pub fn one_of(mut self, group: &str) -> Self {
        self.one_of = Some(group.to_owned());
        self
    }

    /// All or none of a group.
    #[must_use]
    pub fn together(mut self, group: &str) -> Self {
        self.together = Some(group.to_owned());
        self
    }
}

/// Names of fields, for `consumes` and `provides`.
#[must_use]
pub fn names(fields: &[&FieldSpec]) -> Vec<String> {
    fields.iter().map(|f| f.name.to_owned()).collect()
}
