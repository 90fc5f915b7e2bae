//! What the lists of models and effects are made of.

use crate::advice::situation::Situation;
use crate::terms::{Kind, Terms};
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::{EffectSpec, KeySpec, ModelSpec, names};
use proto::field::FieldSpec;
use proto::figure::FigureSpec;
use proto::model::Setup;

/// Checks a configuration and takes the terms of its effects.
pub(crate) type Configure = fn(&Configuration, Terms) -> Result<Box<dyn Setup>, Refusal>;

/// One model of the crate.
pub struct ModelEntry {
    /// Name in the case file.
    pub name: &'static str,
    /// What the description says of it.
    pub spec: fn() -> ModelSpec,
    /// The kinds of terms that it takes.
    pub takes: &'static [Kind],
    /// Checks a configuration that names it, and whose effects and fields it provides, with the terms
    /// of the effects.
    pub(crate) configure: Configure,
}

/// An effect of the list.
pub struct Effect {
    /// Name in the case file.
    pub name: &'static str,
    /// Its law in a line.
    pub law: &'static str,
    /// Where the law comes from.
    pub source: &'static str,
    /// The kinds of terms that it makes.
    pub kinds: &'static [Kind],
    /// The fields that it consumes.
    pub consumes: &'static [&'static FieldSpec],
    /// The fields that it provides.
    pub provides: &'static [&'static FieldSpec],
    /// The keys of its table.
    pub keys: fn() -> Vec<KeySpec>,
    /// The figures that there are with it alone.
    pub figures: fn() -> Vec<FigureSpec>,
    /// What it says of itself in a scene; `None` where the other side of the contact says it.
    pub(crate) advise: Option<fn(&Situation<'_>) -> Advice>,
    /// Makes its terms; refuses values that are missing or out of range.
    pub(crate) terms: fn(&Configuration) -> Result<Terms, Refusal>,
}

impl Effect {
    /// What the description says of it, with the models that support it.
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
