//! Entries of the lists of models and effects.

use crate::advice::situation::Situation;
use crate::terms::{Kind, Terms};
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::{EffectSpec, KeySpec, ModelSpec, names};
use proto::field::FieldSpec;
use proto::figure::FigureSpec;
use proto::model::Setup;

/// Checks a configuration and stores the terms of its effects.
pub(crate) type Configure = fn(&Configuration, Terms) -> Result<Setup, Refusal>;

/// Model of the crate.
pub struct ModelEntry {
    /// Name in the case file.
    pub name: &'static str,
    /// Returns the entry of the model in the description.
    pub spec: fn() -> ModelSpec,
    /// Kinds of terms that the model uses.
    pub takes: &'static [Kind],
    /// Checks a configuration that names the model, with the terms of its effects. Support of the
    /// effects and fields has been checked before.
    pub(crate) configure: Configure,
}

/// Effect of the crate.
pub struct Effect {
    /// Name in the case file.
    pub name: &'static str,
    /// Law of the effect in one line.
    pub law: &'static str,
    /// Source of the law.
    pub source: &'static str,
    /// Kinds of terms that the effect creates.
    pub kinds: &'static [Kind],
    /// Fields that the effect consumes.
    pub consumes: &'static [&'static FieldSpec],
    /// Fields that the effect provides.
    pub provides: &'static [&'static FieldSpec],
    /// Returns the keys of the effect.
    pub keys: fn() -> Vec<KeySpec>,
    /// Returns the summary quantities that exist only with the effect.
    pub figures: fn() -> Vec<FigureSpec>,
    /// Estimates the influence of the effect in a scene; `None` if the other side of the contact
    /// does so.
    pub(crate) advise: Option<fn(&Situation<'_>) -> Advice>,
    /// Creates the terms of the effect; refuses values that are missing or out of range.
    pub(crate) terms: fn(&Configuration) -> Result<Terms, Refusal>,
}

impl Effect {
    /// Returns the entry of the effect in the description, with the models that support it.
    #[must_use]
    pub fn spec(&self, models: Vec<String>) -> EffectSpec {
        EffectSpec {
            name: self.name.to_owned(),
            law: self.law.to_owned(),
            source: self.source.to_owned(),
            models,
            consumes: names(self.consumes),
            provides: names(self.provides),
            keys: (self.keys)(),
            figures: (self.figures)(),
        }
    }
}
