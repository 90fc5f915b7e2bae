//! The suite file: which cases, what is expected of each and why, and how far each hard parameter is
//! driven.

use super::figure::PowerProduct;
use crate::study::Variant;
use contract::input_file;
use run::error::RunError;
use serde::Deserialize;
use std::fmt;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// Larger files are refused [byte].
const MOST_BYTES: u64 = 1 << 24;

/// A suite that has been read.
#[derive(Clone, Debug)]
pub(crate) struct Suite {
    path: PathBuf,
    /// What holds for every case that says nothing else.
    pub(super) every: Limits,
    entries: Vec<Entry>,
}

/// The file as it is written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct SuiteText {
    every: Limits,
    hard: Vec<EntryText>,
}

/// Limits that no case may pass unless it says so.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Limits {
    /// Fields that physics keeps from being negative.
    pub(super) not_negative: Vec<String>,
    /// Largest negative value of those, over the largest one [-].
    pub(super) undershoot: f64,
    /// Largest relative difference of heat sent and received [-].
    pub(super) energy: f64,
}

/// One hard case as it is written.
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
    /// Its number in the list of hard cases.
    pub(super) number: u32,
    /// A word, for `--only`.
    pub(super) name: String,
    /// What is hard about it.
    pub(super) title: String,
    /// The case file.
    pub(super) case: PathBuf,
    changes: Variant,
    /// How it has to end.
    pub(super) expect: Expected,
    undershoot: Option<f64>,
    energy: Option<f64>,
    /// Bounds of its quantities.
    pub(super) checks: Vec<Check>,
    /// Parameters that are driven to their edges from here.
    pub(super) sweeps: Vec<Sweep>,
}

/// How a run has to end.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(super) enum Expected {
    /// With an answer within every bound.
    #[default]
    Answer,
    /// With an error.
    Refusal {
        /// The exit code of the command.
        exit_code: u8,
        /// Words that the message holds.
        saying: Vec<String>,
    },
    /// With an answer that breaks this one of its checks, and no word of it.
    Breach(String),
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Answer => f.write_str("an answer within its bounds"),
            Self::Refusal { exit_code, saying } => {
                write!(f, "exit code {exit_code}: “{}”", saying.join(" … "))
            }
            Self::Breach(check) => write!(f, "no message; the answer fails `{check}`"),
        }
    }
}

/// A bound of a quantity, and why it holds.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "CheckText")]
pub(super) struct Check {
    /// What it is, in few words.
    pub(super) name: String,
    /// The quantity.
    pub(super) of: PowerProduct,
    /// Where it has to be.
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

/// Where a quantity has to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Bound {
    /// Not above this positive number.
    AtMost(f64),
    /// Not below this positive number.
    AtLeast(f64),
    /// As far from a number as this, relative to it, or as it is if the number is 0.
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

/// The number as it is written, with a power of ten where it is very large or small.
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
    /// Name, bound and reason.
    pub(super) fn row(&self) -> [String; 3] {
        [self.name.clone(), format!("{} {}", self.of, self.bound), self.because.clone()]
    }
}

/// A parameter that is driven towards the edge.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Sweep {
    /// What it is.
    pub(super) parameter: String,
    /// Keys to set; `{}` stands for the value.
    set: Vec<String>,
    /// Its values, one run after the other.
    pub(super) values: Vec<String>,
    /// What is seen up to the edge.
    pub(super) before: String,
    /// Where it breaks; absent: nowhere within the values.
    pub(super) edge: Option<Edge>,
    /// Why it breaks there, or why it does not.
    pub(super) why: String,
}

/// Where a parameter's answers end.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Edge {
    /// The first value that breaks.
    at: String,
    /// What happens there and beyond.
    pub(super) beyond: Expected,
}

impl Sweep {
    /// The case at a value.
    pub(super) fn at(&self, base: &Variant, value: &str) -> Variant {
        let mut variant = base.clone();
        variant.set.extend(self.set.iter().map(|option| option.replace("{}", value)));
        variant
    }

    /// What is expected at one of its values, where the case itself expects `before`.
    pub(super) fn expected<'a>(&'a self, value: &str, before: &'a Expected) -> &'a Expected {
        let place = |wanted: &str| self.values.iter().position(|value| value == wanted);
        match &self.edge {
            Some(edge) if place(value) >= place(&edge.at) => &edge.beyond,
            _ => before,
        }
    }
}

impl Entry {
    /// What is changed in the case file.
    pub(super) fn variant(&self) -> Variant {
        self.changes.clone()
    }

    /// The limits of every case, with this one's own.
    pub(super) fn limits(&self, every: &Limits) -> Limits {
        Limits {
            not_negative: every.not_negative.clone(),
            undershoot: self.undershoot.unwrap_or(every.undershoot),
            energy: self.energy.unwrap_or(every.energy),
        }
    }
}

impl Suite {
    /// Reads a suite; paths in it are relative to its folder.
    ///
    /// # Errors
    /// [`RunError::Usage`] with file and line: the file or a case it names is missing, a key is
    /// unknown, missing or wrong, a name stands twice, or an edge is none of the values.
    pub(crate) fn read(path: &Path) -> Result<Self, RunError> {
        let text = input_file::read_text(path, MOST_BYTES).map_err(|error| {
            let fix = "name a suite file, or leave it out in the root of the repository";
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
        Ok(Self { path: path.to_owned(), every: read.every, entries })
    }

    /// The suite's path as it was given.
    #[must_use]
    pub(crate) fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// The entries of these names, all if there are none.
    pub(super) fn chosen(&self, only: &[String]) -> Result<Vec<&Entry>, RunError> {
        let has = |name: &&String| self.entries.iter().any(|entry| entry.name == **name);
        if let Some(unknown) = only.iter().find(|name| !has(name)) {
            let known: Vec<&str> = self.entries.iter().map(|entry| entry.name.as_str()).collect();
            return Err(RunError::Usage(format!(
                "{} has no case `{unknown}`; it has {}",
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
            changes: Variant { set, unset },
            expect,
            undershoot,
            energy,
            checks: text.check,
            sweeps: text.sweep,
        }
    }

    /// Refuses what cannot be run or distinguished.
    fn check(&self, before: &[Self]) -> Result<(), String> {
        let name = &self.name;
        if before.iter().any(|other| other.name == *name) {
            return Err(format!("`{name}` is defined twice; give each case a name of its own"));
        }
        if !self.case.is_file() {
            let path = self.case.display();
            return Err(format!("there is no case file {path}; paths are from the suite's folder"));
        }
        for sweep in &self.sweeps {
            if let Some(Edge { at, beyond }) = &sweep.edge {
                if !sweep.values.contains(at) {
                    let what = &sweep.parameter;
                    return Err(format!("the edge of `{name}`, {what} at {at}, is not a value"));
                }
                self.has_check(beyond)?;
            }
        }
        self.has_check(&self.expect)
    }

    fn has_check(&self, expected: &Expected) -> Result<(), String> {
        match expected {
            Expected::Breach(check) if self.checks.iter().all(|one| one.name != *check) => {
                Err(format!("`{}` has no check `{check}` to break", self.name))
            }
            _ => Ok(()),
        }
    }
}
