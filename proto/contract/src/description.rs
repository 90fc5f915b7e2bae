//! What a participant says of itself, before any run: `--describe` prints it as JSON.
//!
//! The coordinator knows no physics. Which models and effects exist, which case keys they read,
//! in which unit and range, and which fields they exchange, it learns from here.

use crate::accuracy::Accuracy;
use crate::configuration::{Configuration, Mode};
use crate::diagram::Diagram;
use crate::field::{FieldKind, FieldSpec};
use crate::figure::FigureSpec;
use crate::grid::{check_dotted, check_name};
use crate::plausible::Plausible;
use crate::refusal::Refusal;
use crate::table::{Column, headings};
use crate::text::check_lines;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

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
    /// It answers `--advise`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub advises: bool,
    /// Its process can take part in one run after the other ([`crate::message::STAY`]), and a run
    /// leaves nothing behind for the next.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub reusable: bool,
    /// Models, cheapest first.
    pub models: Vec<ModelSpec>,
    /// Effects it can take part in.
    pub effects: Vec<EffectSpec>,
    /// Case keys it reads whatever the model; keys of a model or an effect stand there.
    pub keys: Vec<KeySpec>,
    /// Fields that are not in [`crate::field::TABLE`].
    #[serde(default)]
    pub fields: Vec<FieldKind>,
    /// The figures of its part of the summary, in the order in which a person reads them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub figures: Vec<FigureSpec>,
    /// Diagrams of its figures.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub diagrams: Vec<Diagram>,
    /// Keys of earlier versions, with what stands in their place now.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub renamed: Vec<Renamed>,
}

/// A key that has another spelling now.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Renamed {
    /// Dotted path of an earlier version.
    pub from: String,
    /// What to write now, in words.
    pub to: String,
}

impl Renamed {
    /// One key.
    #[must_use]
    pub fn new(from: &str, to: &str) -> Self {
        Self { from: from.to_owned(), to: to.to_owned() }
    }
}

impl Description {
    /// The key of this dotted path, of the participant, a model or an effect.
    #[must_use]
    pub fn key(&self, path: &str) -> Option<&KeySpec> {
        let models = self.models.iter().flat_map(|model| &model.keys);
        let effects = self.effects.iter().flat_map(|effect| &effect.keys);
        self.keys.iter().chain(models).chain(effects).find(|key| key.is_of(path))
    }

    /// What is wrong with a description that came from outside.
    ///
    /// # Errors
    /// Names that are no plain words, texts that are more than one line, fields without components or
    /// with a unit that does not fit its label, figures that [`FigureSpec::check`] refuses or that stand
    /// twice, diagrams that [`Diagram::check`] refuses, and expectations of accuracy that make no sense.
    pub fn check(&self) -> Result<(), String> {
        check_lines("description", self)?;
        check_name("role", &self.role)?;
        for model in &self.models {
            model.accuracy.check().map_err(|fault| format!("model `{}`: {fault}", model.name))?;
        }
        for field in &self.fields {
            check_dotted("field", &field.name)?;
            let unit = &field.unit;
            if unit.is_empty() || unit.len() > 15 || !unit.is_ascii() {
                return Err(format!("field `{}` has the unit {unit:?}", field.name));
            }
            if !(1..=64).contains(&field.components) {
                return Err(format!("field `{}` has {} components", field.name, field.components));
            }
        }
        let of_effects = self.effects.iter().flat_map(|effect| &effect.figures);
        let figures: Vec<&FigureSpec> = self.figures.iter().chain(of_effects).collect();
        for (index, figure) in figures.iter().enumerate() {
            figure.check()?;
            if figures[..index].iter().any(|other| other.key == figure.key) {
                return Err(format!("figure `{}` stands twice", figure.key));
            }
        }
        let keys = figures.iter().map(|figure| figure.key.as_str());
        self.diagrams.iter().try_for_each(|diagram| diagram.check(keys.clone()))?;
        Ok(())
    }

    /// The kind of a field that it speaks of: of the table, or one of its own.
    #[must_use]
    pub fn field_kind(&self, name: &str) -> Option<FieldKind> {
        let own = || self.fields.iter().find(|kind| kind.name == name).cloned();
        crate::field::find(name).map(FieldSpec::kind).or_else(own)
    }

    /// What no participant that describes itself like this can take; a solver's own checks follow.
    ///
    /// # Errors
    /// A model or mode it does not have, an effect that it or the model does not have, a field that
    /// nothing of it provides.
    pub fn admit(&self, given: &Configuration) -> Result<(), Refusal> {
        let role = &self.role;
        let Some(model) = self.models.iter().find(|model| model.name == given.model) else {
            let known: Vec<_> = self.models.iter().map(|model| model.name.as_str()).collect();
            let reason = format!("`{}` is not a model of {}", given.model, self.name);
            let fix = format!("write one of: {}", known.join(", "));
            return Err(Refusal::new(&format!("{role}.model"), reason, fix));
        };
        let (offered, other) = match given.mode {
            Mode::Steady => (model.steady, "transient"),
            Mode::Transient => (model.transient, "steady"),
        };
        if !offered {
            let reason = format!("model `{}` answers {other} cases only", model.name);
            return Err(Refusal::new("time.mode", reason, format!("write mode = \"{other}\"")));
        }
        if let Some(histories) = &given.histories {
            let refused = |reason: String| Refusal::new("time", reason, "correct the table");
            histories.check().map_err(refused)?;
        }
        let active = given.case.get("effects").and_then(serde_json::Value::as_object);
        for name in active.into_iter().flatten().map(|(name, _)| name) {
            self.admit_effect(name, &model.name)?;
        }
        let effects = self.effects.iter().flat_map(|effect| &effect.provides);
        let provided: Vec<&String> = model.provides.iter().chain(effects).collect();
        match given.outputs.iter().chain(&given.observed).find(|name| !provided.contains(name)) {
            None => Ok(()),
            Some(field) => Err(Refusal::new(
                &format!("{role}.model"),
                format!("`{}` does not provide the field `{field}`", model.name),
                "do not request this field, or name a model that provides it",
            )),
        }
    }

    fn admit_effect(&self, name: &str, model: &str) -> Result<(), Refusal> {
        let key = format!("effects.{name}");
        let Some(effect) = self.effects.iter().find(|effect| effect.name == name) else {
            let known: Vec<_> = self.effects.iter().map(|effect| effect.name.as_str()).collect();
            let fix = format!("remove it; known are: {}", known.join(", "));
            return Err(Refusal::new(&key, format!("{} has no such effect", self.name), fix));
        };
        if effect.models.iter().any(|supporting| supporting == model) {
            return Ok(());
        }
        let fix = format!("choose one of {}, or remove the effect", effect.models.join(", "));
        Err(Refusal::new(&key, format!("the model `{model}` does not support it"), fix))
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
    /// It can solve a window more than once, always from the accepted state. One that cannot is
    /// planned only where every window is solved once.
    #[serde(default = "always", skip_serializing_if = "Clone::clone")]
    pub rewinds: bool,
    /// Windows of the model may differ in length. One whose may not is planned only where all are equal.
    #[serde(default = "always", skip_serializing_if = "Clone::clone")]
    pub varies_step: bool,
    /// Fields it always consumes, by name.
    pub consumes: Vec<String>,
    /// Fields it always can provide, by name.
    pub provides: Vec<String>,
    /// Case keys that only this model reads.
    pub keys: Vec<KeySpec>,
    /// What is known of its errors.
    #[serde(default, skip_serializing_if = "Accuracy::is_silent")]
    pub accuracy: Accuracy,
}

fn always() -> bool {
    true
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
    /// Figures that there are with the effect alone, in the order in which a person reads them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub figures: Vec<FigureSpec>,
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
    /// That group of alternatives may be left out as a whole: something else takes its place.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub or_none: bool,
    /// Of all keys with the same word here all or none must be given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub together: Option<String>,
    /// A case may give a column of a table in the place of one number; whoever reads the key follows it
    /// through [`Configuration::histories`].
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub varies: bool,
    /// A case may give a list of values in the place of one.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub list: bool,
    /// A difference of temperatures, for which °C has no meaning.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub difference: bool,
    /// Fields that the participant consumes besides, by the word of the key that asks for them.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub consumes: BTreeMap<String, Vec<String>>,
    /// What is expected of it; a case is run whose value is otherwise, and told so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plausible: Option<Plausible>,
    /// The columns of the table that the key names, see [`crate::table`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub columns: Vec<Column>,
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

impl KeyKind {
    /// The SI unit of a number, "1" for a plain one.
    #[must_use]
    pub fn unit(&self) -> &str {
        match self {
            Self::Quantity { unit } => unit,
            _ => "1",
        }
    }
}

/// A dotted path is of a pattern, in which `*` stands for any one name.
#[must_use]
pub fn matches(pattern: &str, path: &str) -> bool {
    let (mut pattern, mut path) = (pattern.split('.'), path.split('.'));
    loop {
        match (pattern.next(), path.next()) {
            (None, None) => return true,
            (Some(part), Some(name)) if part == "*" || part == name => {}
            _ => return false,
        }
    }
}

impl KeySpec {
    /// A dotted path is of this key; `*` stands for any one name.
    #[must_use]
    pub fn is_of(&self, path: &str) -> bool {
        matches(&self.path, path)
    }

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
            or_none: false,
            together: None,
            varies: false,
            list: false,
            difference: false,
            consumes: BTreeMap::new(),
            plausible: None,
            columns: Vec::new(),
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

    /// A file that holds a table of these columns.
    #[must_use]
    pub fn table(path: &str, columns: &[Column], help: &str) -> Self {
        let help = format!("table of {}: {help}", headings(columns));
        Self { columns: columns.to_vec(), ..Self::new(path, KeyKind::File, &help) }
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

    /// One of a group of alternatives, or none of them.
    #[must_use]
    pub fn one_of_or_none(mut self, group: &str) -> Self {
        self.or_none = true;
        self.one_of(group)
    }

    /// It may vary.
    #[must_use]
    pub fn varies(mut self) -> Self {
        self.varies = true;
        self
    }

    /// A case may give a list of values.
    #[must_use]
    pub fn or_list(mut self) -> Self {
        self.list = true;
        self
    }

    /// A difference of temperatures: a value in °C is refused.
    #[must_use]
    pub fn of_differences(mut self) -> Self {
        self.difference = true;
        self
    }

    /// A word of it asks for these fields.
    #[must_use]
    pub fn consuming(mut self, word: &str, fields: &[&FieldSpec]) -> Self {
        self.consumes.insert(word.to_owned(), names(fields));
        self
    }

    /// Expected in this range of magnitudes, and why.
    #[must_use]
    pub fn expected(mut self, range: std::ops::RangeInclusive<f64>, why: &str) -> Self {
        self.plausible = Some(Plausible::within(range, why));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Params;
    use serde_json::json;

    fn description() -> Description {
        let model = |name: &str, transient| ModelSpec {
            name: name.to_owned(),
            summary: "a model".to_owned(),
            source: "a book".to_owned(),
            steady: true,
            transient,
            rewinds: true,
            varies_step: true,
            consumes: Vec::new(),
            provides: vec!["pressure".to_owned()],
            keys: Vec::new(),
            accuracy: Accuracy::default(),
        };
        let effect = EffectSpec {
            figures: Vec::new(),
            name: "wear".to_owned(),
            law: "a law".to_owned(),
            source: "a book".to_owned(),
            models: vec!["fine".to_owned()],
            consumes: Vec::new(),
            provides: vec!["wear_depth".to_owned()],
            keys: Vec::new(),
        };
        Description {
            protocol: crate::PROTOCOL_VERSION,
            name: "program".to_owned(),
            version: "1".to_owned(),
            role: "mech".to_owned(),
            standalone: true,
            estimates: true,
            advises: false,
            reusable: true,
            models: vec![model("coarse", false), model("fine", true)],
            effects: vec![effect],
            keys: Vec::new(),
            fields: Vec::new(),
            figures: Vec::new(),
            diagrams: Vec::new(),
            renamed: Vec::new(),
        }
    }

    #[test]
    fn a_text_of_several_lines_or_with_escapes_is_refused() {
        assert_eq!(description().check(), Ok(()));
        for text in ["two\nlines", "\u{1b}[2J", "\u{9b}31m"] {
            let mut said = description();
            text.clone_into(&mut said.effects[0].law);
            let fault = said.check().unwrap_err();
            assert!(fault.contains("description.effects.law"), "{fault}");
            assert!(!fault.contains(['\n', '\u{1b}', '\u{9b}']), "{fault}");
        }
    }

    fn given(model: &str, mode: Mode, case: serde_json::Value, outputs: &[&str]) -> Configuration {
        Configuration {
            role: "mech".to_owned(),
            model: model.to_owned(),
            mode,
            case: Params(case),
            histories: None,
            inputs: Vec::new(),
            outputs: outputs.iter().map(|name| (*name).to_owned()).collect(),
            observed: Vec::new(),
            threads: 1,
        }
    }

    #[test]
    fn what_is_described_is_admitted_and_nothing_else() {
        let said = description();
        let wear = || json!({"effects": {"wear": {}}});
        let admitted = |given: Configuration| said.admit(&given).map_err(|refusal| refusal.key);
        let (steady, transient) = (Mode::Steady, Mode::Transient);
        assert_eq!(admitted(given("fine", transient, wear(), &["pressure", "wear_depth"])), Ok(()));
        assert_eq!(admitted(given("coarse", steady, json!({}), &["pressure"])), Ok(()));
        let refused = |key: &str| Err(key.to_owned());
        assert_eq!(admitted(given("none", steady, json!({}), &[])), refused("mech.model"));
        assert_eq!(admitted(given("coarse", transient, json!({}), &[])), refused("time.mode"));
        assert_eq!(admitted(given("coarse", steady, wear(), &[])), refused("effects.wear"));
        let rust = json!({"effects": {"rust": {}}});
        assert_eq!(admitted(given("fine", steady, rust, &[])), refused("effects.rust"));
        assert_eq!(admitted(given("fine", steady, json!({}), &["x"])), refused("mech.model"));
    }
}
