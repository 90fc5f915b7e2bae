//! The suite file: cases, expected outcomes with reasons, and sweeps of the critical parameters.

use console::case_arguments::Changes;
use contract::figure::value;
use contract::input_file;
use run::error::RunError;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// Size above which a file is refused [byte].
const MOST_BYTES: u64 = 1 << 24;

/// A suite read from its file.
#[derive(Clone, Debug)]
pub(crate) struct Suite {
    path: PathBuf,
    /// Contents of the file.
    pub(super) text: String,
    /// Limits of every case, unless the case sets its own.
    pub(super) every: Limits,
    entries: Vec<Entry>,
}

/// Contents of the suite file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct SuiteText {
    every: Limits,
    hard: Vec<EntryText>,
}

/// Limits common to all cases, unless a case sets its own.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Limits {
    /// Fields that cannot be negative for physical reasons.
    pub(super) not_negative: Vec<String>,
    /// Largest negative value of these fields, relative to their largest value [-].
    pub(super) undershoot: f64,
    /// Largest relative difference between heat sent and received [-].
    pub(super) energy: f64,
}

/// One hard case, as in the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct EntryText {
    number: u32,
    name: String,
    title: String,
    case: Spanned<PathBuf>,
    #[serde(default)]
    set: Vec<String>,
    #[serde(default)]
    unset: Vec<String>,
    #[serde(default)]
    expect: Expected,
    undershoot: Option<f64>,
    energy: Option<f64>,
    #[serde(default)]
    check: Vec<Check>,
    #[serde(default)]
    sweep: Vec<Sweep>,
}

/// One hard case.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// Number in the list of hard cases.
    pub(super) number: u32,
    /// Name, for `--only`.
    pub(super) name: String,
    /// Title: the difficulty of the case.
    pub(super) title: String,
    /// The case file.
    pub(super) case: PathBuf,
    changes: Changes,
    /// Expected outcome.
    pub(super) expect: Expected,
    undershoot: Option<f64>,
    energy: Option<f64>,
    /// Checks of the case's quantities.
    pub(super) checks: Vec<Check>,
    /// Parameters to vary up to their edges, starting from this case.
    pub(super) sweeps: Vec<Sweep>,
}

/// Expected outcome of a run.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(super) enum Expected {
    /// A result within every bound.
    #[default]
    Answer,
    /// An error.
    Refusal {
        /// Exit code of the command.
        exit_code: u8,
        /// Words that the message contains.
        saying: Vec<String>,
    },
    /// A result that violates the named check, without a message.
    Breach(String),
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Answer => f.write_str("a result within its bounds"),
            Self::Refusal { exit_code, saying } => {
                write!(f, "exit code {exit_code}: “{}”", saying.join(" … "))
            }
            Self::Breach(check) => write!(f, "no message; the result fails `{check}`"),
        }
    }
}

/// A bound of a quantity, and its reason.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "CheckText")]
pub(super) struct Check {
    /// Short name.
    pub(super) name: String,
    /// Quantity to check.
    pub(super) of: PowerProduct,
    /// Bound of the quantity.
    pub(super) bound: Bound,
    because: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct CheckText {
    name: String,
    of: PowerProduct,
    at_most: Option<f64>,
    at_least: Option<f64>,
    equals: Option<f64>,
    within: Option<f64>,
    because: String,
}

/// Bound of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Bound {
    /// Upper bound, positive.
    AtMost(f64),
    /// Lower bound, positive.
    AtLeast(f64),
    /// Target value and tolerance. The tolerance is relative, or absolute if the target is 0.
    Near(f64, f64),
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AtMost(most) => write!(f, "≤ {}", short(*most)),
            Self::AtLeast(least) => write!(f, "≥ {}", short(*least)),
            Self::Near(0.0, within) => write!(f, "= 0 ± {}", short(*within)),
            Self::Near(value, within) => {
                write!(f, "= {} (1 ± {})", short(*value), short(*within))
            }
        }
    }
}

/// Formats a number, with a power of ten if it is very large or small.
fn short(value: f64) -> String {
    match value.abs() {
        magnitude if (1e-3..1e4).contains(&magnitude) => value.to_string(),
        _ => format!("{value:e}"),
    }
}

impl TryFrom<CheckText> for Check {
    type Error = String;

    fn try_from(text: CheckText) -> Result<Self, String> {
        let bound = match (text.at_most, text.at_least, text.equals, text.within) {
            (Some(most), None, None, None) if most > 0.0 => Bound::AtMost(most),
            (None, Some(least), None, None) if least > 0.0 => Bound::AtLeast(least),
            (None, None, Some(value), Some(within)) if within > 0.0 => Bound::Near(value, within),
            _ => {
                return Err(format!(
                    "check `{}` needs one bound: a positive `at_most`, a positive `at_least`, or \
                     `equals` with a positive `within`",
                    text.name
                ));
            }
        };
        Ok(Self { name: text.name, of: text.of, bound, because: text.because })
    }
}

impl Check {
    /// Name, bound and reason of the check.
    pub(super) fn row(&self) -> [String; 3] {
        [self.name.clone(), format!("{} {}", self.of, self.bound), self.because.clone()]
    }
}

/// A parameter to vary towards its edge.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Sweep {
    /// Name of the parameter.
    pub(super) parameter: String,
    /// Keys to set; `{}` stands for the value.
    set: Vec<String>,
    /// Values to run, in order.
    pub(super) values: Vec<String>,
    /// Behaviour up to the edge.
    pub(super) before: String,
    /// Edge; absent if there is none within the values.
    pub(super) edge: Option<Edge>,
    /// Reason for the edge, or for its absence.
    pub(super) why: String,
}

/// Edge at which a parameter's results end.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Edge {
    /// First value beyond the edge.
    at: String,
    /// Expected outcome from the edge onwards.
    pub(super) beyond: Expected,
}

impl Sweep {
    /// Changes of the case at a value.
    pub(super) fn at(&self, base: &Changes, value: &str) -> Changes {
        let mut variant = base.clone();
        variant.set.extend(self.set.iter().map(|option| option.replace("{}", value)));
        variant
    }

    /// Expected outcome at a value, where the case itself expects `before`.
    pub(super) fn expected<'a>(&'a self, value: &str, before: &'a Expected) -> &'a Expected {
        let place = |wanted: &str| self.values.iter().position(|value| value == wanted);
        match &self.edge {
            Some(edge) if place(value) >= place(&edge.at) => &edge.beyond,
            _ => before,
        }
    }
}

impl Entry {
    /// Changes of the case file.
    pub(super) fn variant(&self) -> Changes {
        self.changes.clone()
    }

    /// Limits of the case: the common ones, unless the case sets its own.
    pub(super) fn limits(&self, every: &Limits) -> Limits {
        Limits {
            not_negative: every.not_negative.clone(),
            undershoot: self.undershoot.unwrap_or(every.undershoot),
            energy: self.energy.unwrap_or(every.energy),
        }
    }
}

impl Suite {
    /// Reads a suite; paths in the file are relative to its folder.
    ///
    /// # Errors
    /// [`RunError::Usage`] with file and line: the file or a case is missing, a key is unknown,
    /// missing or invalid, a name occurs twice, or an edge is not one of the values.
    pub(crate) fn read(path: &Path) -> Result<Self, RunError> {
        let text = input_file::read_text(path, MOST_BYTES).map_err(|error| {
            let fix = "name a suite file, or run the command in the root of the repository";
            RunError::Usage(format!("{}: {error}; {fix}", path.display()))
        })?;
        let fault = |place: Option<usize>, reason: &str| {
            let line = place.map_or(1, |at| text[..at.min(text.len())].matches('\n').count() + 1);
            RunError::Usage(format!("{}:{line}: {reason}", path.display()))
        };
        let read: SuiteText = toml::from_str(&text)
            .map_err(|error| fault(error.span().map(|span| span.start), error.message()))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut entries: Vec<Entry> = Vec::new();
        for entry in read.hard {
            let place = entry.case.span().start;
            let entry = Entry::of(entry, folder);
            entry.check(&entries).map_err(|reason| fault(Some(place), &reason))?;
            entries.push(entry);
        }
        let (path, every) = (path.to_owned(), read.every);
        Ok(Self { path, text, every, entries })
    }

    /// Path of the suite as given.
    #[must_use]
    pub(crate) fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// Entries with these names, or all if the list is empty.
    pub(super) fn chosen(&self, only: &[String]) -> Result<Vec<&Entry>, RunError> {
        let has = |name: &&String| self.entries.iter().any(|entry| entry.name == **name);
        if let Some(unknown) = only.iter().find(|name| !has(name)) {
            let known: Vec<&str> = self.entries.iter().map(|entry| entry.name.as_str()).collect();
            return Err(RunError::Usage(format!(
                "{} has no case `{unknown}`; known: {}",
                self.name(),
                known.join(", ")
            )));
        }
        let wanted = |entry: &&Entry| only.is_empty() || only.contains(&entry.name);
        Ok(self.entries.iter().filter(wanted).collect())
    }
}

impl Entry {
    fn of(text: EntryText, folder: &Path) -> Self {
        let EntryText { number, name, title, set, unset, expect, undershoot, energy, .. } = text;
        Self {
            number,
            name,
            title,
            case: folder.join(text.case.into_inner()),
            changes: Changes { set, unset },
            expect,
            undershoot,
            energy,
            checks: text.check,
            sweeps: text.sweep,
        }
    }

    /// Refuses duplicate names, missing case files, and edges or expectations that refer to
    /// nothing.
    fn check(&self, before: &[Self]) -> Result<(), String> {
        let name = &self.name;
        if before.iter().any(|other| other.name == *name) {
            return Err(format!("`{name}` is defined twice; give each case a name of its own"));
        }
        if !self.case.is_file() {
            let path = self.case.display();
            return Err(format!(
                "there is no case file {path}; paths are relative to the suite's folder"
            ));
        }
        for sweep in &self.sweeps {
            if let Some(Edge { at, beyond }) = &sweep.edge {
                if !sweep.values.contains(at) {
                    let what = &sweep.parameter;
                    return Err(format!(
                        "the edge of `{name}`, {what} at {at}, is not one of the values"
                    ));
                }
                self.has_check(beyond)?;
            }
        }
        self.has_check(&self.expect)
    }

    fn has_check(&self, expected: &Expected) -> Result<(), String> {
        match expected {
            Expected::Breach(check) if self.checks.iter().all(|one| one.name != *check) => {
                Err(format!(
                    "`{}` expects to break the check `{check}`, but has no check `{check}`",
                    self.name
                ))
            }
            _ => Ok(()),
        }
    }
}

/// A product of powers: keys and exponents.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(transparent)]
pub(super) struct PowerProduct(BTreeMap<String, f64>);

impl PowerProduct {
    /// Value of the product, or the key that the results lack.
    pub(super) fn value(&self, quantities: &Value) -> Result<f64, &str> {
        self.0.iter().try_fold(1.0, |product, (key, exponent)| {
            let factor = value(quantities, key).ok_or(key.as_str())?;
            Ok(product * factor.powf(*exponent))
        })
    }
}

impl fmt::Display for PowerProduct {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (key, exponent)) in self.0.iter().enumerate() {
            let space = if index == 0 { "" } else { " · " };
            match *exponent {
                1.0 => write!(f, "{space}{key}")?,
                other => write!(f, "{space}{key}^{other}")?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_product_of_powers() {
        let product: PowerProduct = toml::from_str("\"a.b\" = 2\n\"c\" = -0.5").unwrap();
        assert_eq!(product.value(&json!({"a": {"b": 3.0}, "c": 4.0})), Ok(4.5));
        assert_eq!(product.value(&json!({"a": {"b": 3.0}})), Err("c"));
        assert_eq!(product.to_string(), "a.b^2 · c^-0.5");
        assert!(product.value(&json!({"a": {"b": 3.0}, "c": -1.0})).unwrap().is_nan());
    }
}
