//! Description of a participant, available before any run: `--describe` prints it as JSON.
//!
//! The coordinator knows no physics. From the descriptions it learns which models and effects
//! exist, which case keys they read, in which unit and range, and which fields they exchange.

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

/// Self-description of a participant.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Description {
    /// Version of the contract that the participant speaks ([`crate::PROTOCOL_VERSION`]).
    pub protocol: u32,
    /// Name of the program.
    pub name: String,
    /// Version of the program.
    pub version: String,
    /// Role of the participant: `mech`, `thermal`, or another word that a case uses as a table
    /// name.
    pub role: String,
    /// The participant has a result even if no effect is active. Otherwise it is started only when
    /// an active effect needs it.
    pub standalone: bool,
    /// `Configure` is cheap, so that a plan may ask for the layout without a run.
    pub estimates: bool,
    /// The participant answers `Advise`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub advises: bool,
    /// The process can take part in several runs in succession ([`crate::message::STAY`]); a run
    /// leaves nothing behind for the next.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub reusable: bool,
    /// Build of the program: a digest of the files that it consists of, or a build id. Results of
    /// two builds never stand in one table. Without it, only the files that the command names are
    /// compared.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub build: Option<String>,
    /// Models, cheapest first.
    pub models: Vec<ModelSpec>,
    /// Effects that the participant supports.
    pub effects: Vec<EffectSpec>,
    /// Case keys read by every model; keys of a single model or effect stand in that model or
    /// effect.
    pub keys: Vec<KeySpec>,
    /// Fields that are missing from [`crate::field::TABLE`].
    #[serde(default)]
    pub fields: Vec<FieldKind>,
    /// Figures of the participant's part of the summary, in reading order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub figures: Vec<FigureSpec>,
    /// Diagrams of the figures.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub diagrams: Vec<Diagram>,
    /// Keys of earlier versions and their replacements.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub renamed: Vec<Renamed>,
}

/// A renamed key.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Renamed {
    /// Dotted path in an earlier version.
    pub from: String,
    /// Replacement, in words.
    pub to: String,
}

impl Renamed {
    /// Returns a renamed key.
    #[must_use]
    pub fn new(from: &str, to: &str) -> Self {
        Self { from: from.to_owned(), to: to.to_owned() }
    }
}

impl Description {
    /// Returns the key with a dotted path, among the keys of the participant, its models and its
    /// effects.
    #[must_use]
    pub fn key(&self, path: &str) -> Option<&KeySpec> {
        let models = self.models.iter().flat_map(|model| &model.keys);
        let effects = self.effects.iter().flat_map(|effect| &effect.keys);
        self.keys.iter().chain(models).chain(effects).find(|key| key.is_of(path))
    }

    /// Checks a description received from another process.
    ///
    /// # Errors
    /// Fails for a name that is not a plain word, a text of more than one line, a field with fewer
    /// than 1 or more than 64 components, and a unit that does not fit its label. Fails for a
    /// figure that [`FigureSpec::check`] refuses or that occurs twice, a diagram that
    /// [`Diagram::check`] refuses, and a statement that [`Accuracy::check`] refuses.
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
                return Err(format!("figure `{}` is defined twice", figure.key));
            }
        }
        let keys = figures.iter().map(|figure| figure.key.as_str());
        self.diagrams.iter().try_for_each(|diagram| diagram.check(keys.clone()))?;
        Ok(())
    }

    /// Returns the kind of a field, from the table or from the participant's own fields.
    #[must_use]
    pub fn field_kind(&self, name: &str) -> Option<FieldKind> {
        let own = || self.fields.iter().find(|kind| kind.name == name).cloned();
        crate::field::find(name).map(FieldSpec::kind).or_else(own)
    }

    /// Checks a configuration against this description; the solver's own checks follow.
    ///
    /// # Errors
    /// Fails for an unknown model, a mode that the model does not support, an effect that the
    /// participant or the model does not support, and an output that nothing provides.
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
    /// Summary of the model, in one line.
    pub summary: String,
    /// Source of the equations.
    pub source: String,
    /// The model supports steady cases.
    pub steady: bool,
    /// The model supports transient cases.
    pub transient: bool,
    /// The model can solve a window repeatedly, each time from the accepted state. Other models are
    /// planned only where every window is solved once.
    #[serde(default = "always", skip_serializing_if = "Clone::clone")]
    pub rewinds: bool,
    /// Windows may differ in length. Otherwise the model is planned only where all windows are
    /// equal.
    #[serde(default = "always", skip_serializing_if = "Clone::clone")]
    pub varies_step: bool,
    /// Names of the fields that the model always consumes.
    pub consumes: Vec<String>,
    /// Names of the fields that the model can always provide.
    pub provides: Vec<String>,
    /// Case keys that only this model reads.
    pub keys: Vec<KeySpec>,
    /// Expected errors of the model.
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
    /// Source of the law.
    pub source: String,
    /// Names of the participant's models that support the effect.
    pub models: Vec<String>,
    /// Names of the fields that the effect consumes.
    pub consumes: Vec<String>,
    /// Names of the fields that the effect provides.
    pub provides: Vec<String>,
    /// Parameters: keys under `effects.NAME` and elsewhere.
    pub keys: Vec<KeySpec>,
    /// Figures that exist only with the effect, in reading order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub figures: Vec<FigureSpec>,
}

/// A key of the case file: its type, range and meaning.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeySpec {
    /// Dotted path; `*` stands for any one name (`materials.*.density`).
    pub path: String,
    /// Type of the value.
    #[serde(flatten)]
    pub kind: KeyKind,
    /// The key is required in every case that reaches the participant.
    #[serde(default)]
    pub required: bool,
    /// Value used when the key is absent (SI).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub default: Option<serde_json::Value>,
    /// Exclusive lower bound of numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub above: Option<f64>,
    /// Inclusive lower bound of numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_least: Option<f64>,
    /// Inclusive upper bound of numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_most: Option<f64>,
    /// Keys whose product is the exclusive upper bound of the magnitude.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub magnitude_below: Vec<String>,
    /// Group of alternatives: exactly one of the keys with the same group name must be given.
    /// Setting one replaces the others. A table (`motion.creepage`) counts through its keys.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub one_of: Option<String>,
    /// The group of alternatives may be absent as a whole, because something else takes its place.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub or_none: bool,
    /// Group of keys that must be given together or not at all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub together: Option<String>,
    /// A case may give a column of a table instead of one number. Readers of the key follow the
    /// values through [`Configuration::histories`].
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub varies: bool,
    /// A case may give a list of values instead of one.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub list: bool,
    /// The value is a temperature difference, for which °C is meaningless.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub difference: bool,
    /// Additional fields consumed, by the value of the key that requests them.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub consumes: BTreeMap<String, Vec<String>>,
    /// Plausible range; values outside produce a warning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plausible: Option<Plausible>,
    /// Columns of the table that the key names, see [`crate::table`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub columns: Vec<Column>,
    /// Meaning of the key, in one line.
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
        /// The permitted words.
        of: Vec<String>,
    },
    /// Any text.
    Text,
    /// A file. A relative path is resolved from the folder of the case file; the participant
    /// receives an absolute path.
    File,
    /// The name of a table under this path (`materials`).
    NameIn {
        /// Path of the parent table.
        table: String,
    },
}

impl KeyKind {
    /// Returns the SI unit of a number, "1" for a dimensionless one.
    #[must_use]
    pub fn unit(&self) -> &str {
        match self {
            Self::Quantity { unit } => unit,
            _ => "1",
        }
    }
}

/// Returns true if a dotted path matches a pattern, in which `*` stands for any one name.
#[must_use]
pub fn matches(pattern: &str, path: &str) -> bool {
    // Most paths differ from most patterns in their first letters.
    let (mut pattern, mut path) = (pattern.as_bytes(), path.as_bytes());
    loop {
        (pattern, path) = match (pattern, path) {
            ([], []) => return true,
            ([b'*', more @ ..], _) => {
                let end = path.iter().position(|&letter| letter == b'.').unwrap_or(path.len());
                (more, &path[end..])
            }
            ([expected, more @ ..], [letter, rest @ ..]) if expected == letter => (more, rest),
            _ => return false,
        };
    }
}

impl KeySpec {
    /// Returns true if a dotted path belongs to this key; `*` stands for any one name.
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

    /// Returns a key of a number with a unit.
    #[must_use]
    pub fn quantity(path: &str, unit: &str, help: &str) -> Self {
        Self::new(path, KeyKind::Quantity { unit: unit.to_owned() }, help)
    }

    /// Returns a key of a dimensionless number.
    #[must_use]
    pub fn number(path: &str, help: &str) -> Self {
        Self::quantity(path, "1", help)
    }

    /// Returns a key of a whole number.
    #[must_use]
    pub fn integer(path: &str, help: &str) -> Self {
        Self::new(path, KeyKind::Integer, help)
    }

    /// Returns a key of one of several words.
    #[must_use]
    pub fn choice(path: &str, of: &[&str], help: &str) -> Self {
        let of = of.iter().map(|s| (*s).to_owned()).collect();
        Self::new(path, KeyKind::Choice { of }, help)
    }

    /// Returns a key of any text.
    #[must_use]
    pub fn text(path: &str, help: &str) -> Self {
        Self::new(path, KeyKind::Text, help)
    }

    /// Returns a key of a Boolean.
    #[must_use]
    pub fn flag(path: &str, help: &str) -> Self {
        Self::new(path, KeyKind::Flag, help)
    }

    /// Returns a key of an existing file.
    #[must_use]
    pub fn file(path: &str, help: &str) -> Self {
        Self::new(path, KeyKind::File, help)
    }

    /// Returns a key of a file that holds a table with these columns.
    #[must_use]
    pub fn table(path: &str, columns: &[Column], help: &str) -> Self {
        let help = format!("table of {}: {help}", headings(columns));
        Self { columns: columns.to_vec(), ..Self::new(path, KeyKind::File, &help) }
    }

    /// Returns a key of the name of a table under `table`.
    #[must_use]
    pub fn name_in(path: &str, table: &str, help: &str) -> Self {
        Self::new(path, KeyKind::NameIn { table: table.to_owned() }, help)
    }

    /// Makes the key required.
    #[must_use]
    pub fn required(mut self) -> Self {
        self.required = true;
        self
    }

    /// Sets the value used when the key is absent.
    #[must_use]
    pub fn default_value(mut self, value: impl Into<serde_json::Value>) -> Self {
        self.default = Some(value.into());
        self
    }

    /// Sets the exclusive lower bound.
    #[must_use]
    pub fn above(mut self, bound: f64) -> Self {
        self.above = Some(bound);
        self
    }

    /// Sets the inclusive lower bound.
    #[must_use]
    pub fn at_least(mut self, bound: f64) -> Self {
        self.at_least = Some(bound);
        self
    }

    /// Sets the inclusive upper bound.
    #[must_use]
    pub fn at_most(mut self, bound: f64) -> Self {
        self.at_most = Some(bound);
        self
    }

    /// Bounds the magnitude by the product of other keys (exclusive).
    #[must_use]
    pub fn magnitude_below(mut self, keys: &[&str]) -> Self {
        self.magnitude_below = keys.iter().map(|s| (*s).to_owned()).collect();
        self
    }

    /// Adds the key to a group of alternatives, exactly one of which must be given.
    #[must_use]
    pub fn one_of(mut self, group: &str) -> Self {
        self.one_of = Some(group.to_owned());
        self
    }

    /// Adds the key to a group of alternatives, at most one of which may be given.
    #[must_use]
    pub fn one_of_or_none(mut self, group: &str) -> Self {
        self.or_none = true;
        self.one_of(group)
    }

    /// Permits a column of a table instead of one number.
    #[must_use]
    pub fn varies(mut self) -> Self {
        self.varies = true;
        self
    }

    /// Permits a list of values.
    #[must_use]
    pub fn or_list(mut self) -> Self {
        self.list = true;
        self
    }

    /// Marks a temperature difference; values in °C are refused.
    #[must_use]
    pub fn of_differences(mut self) -> Self {
        self.difference = true;
        self
    }

    /// Declares the fields that are consumed if the key has this value.
    #[must_use]
    pub fn consuming(mut self, word: &str, fields: &[&FieldSpec]) -> Self {
        self.consumes.insert(word.to_owned(), names(fields));
        self
    }

    /// Sets the plausible range of magnitudes and the reason for its bounds.
    #[must_use]
    pub fn expected(mut self, range: std::ops::RangeInclusive<f64>, why: &str) -> Self {
        self.plausible = Some(Plausible::within(range, why));
        self
    }

    /// Adds the key to a group that must be given together or not at all.
    #[must_use]
    pub fn together(mut self, group: &str) -> Self {
        self.together = Some(group.to_owned());
        self
    }
}

/// Returns the names of fields, for `consumes` and `provides`.
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
            build: None,
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
            windows: None,
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
