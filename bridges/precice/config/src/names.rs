//! Names in a case: roles of participants, fields of data, and the words of their command.

use crate::configuration::Configuration;
use std::collections::BTreeMap;

/// Program that plays a participant of a configuration.
pub const PROGRAM: &str = "precice-participant";
/// Name of its only model.
pub const MODEL: &str = "program";
/// Start of a word that stands for an unknown program.
const PLACEHOLDER: &str = "PROGRAM-OF-";
/// Longest name of a role or a field.
const LONGEST: usize = 31;

/// Sections of a case and parts of a summary, which are no roles.
const TAKEN: [&str; 20] = [
    "case",
    "time",
    "coupling",
    "mapping",
    "output",
    "limits",
    "effects",
    "bodies",
    "materials",
    "motion",
    "load",
    "friction",
    "track",
    "wheelset",
    "surfaces",
    "coordinator",
    "wall",
    "plan",
    "start",
    "finish",
];

/// Returns the role of a participant by its name: small letters, digits, `_` and `-`.
#[must_use]
pub fn role(name: &str) -> String {
    let role = plain(&name.to_lowercase());
    let taken = TAKEN.contains(&role.as_str());
    if taken { format!("{role}-participant") } else { role }
}

/// Returns the field of some data by its name, which stays the same if it is valid.
#[must_use]
pub fn field(data: &str) -> String {
    let allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-');
    let valid = (1..=LONGEST).contains(&data.len()) && data.chars().all(allowed);
    if valid { data.to_owned() } else { plain(data) }
}

/// Returns the name of data as a wire has it: in double quotes if it holds more than letters,
/// digits, `_`, `-` and `.`. A double quote in it is written twice.
#[must_use]
pub fn quoted(data: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.');
    match data.chars().all(is_plain) {
        true => data.to_owned(),
        false => format!("\"{}\"", data.replace('"', "\"\"")),
    }
}

/// Returns the word that stands for the unknown program of a participant.
#[must_use]
pub fn placeholder(participant: &str) -> String {
    format!("{PLACEHOLDER}{participant}")
}

/// Returns the participant for whose program a word stands.
#[must_use]
pub fn of_placeholder(word: &str) -> Option<&str> {
    word.strip_prefix(PLACEHOLDER)
}

/// Returns a valid name that resembles a text.
fn plain(text: &str) -> String {
    let mut name = String::new();
    for c in text.chars() {
        let c = if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' };
        if c != '_' || !name.ends_with('_') {
            name.push(c);
        }
    }
    let name = name.trim_matches('_');
    if name.is_empty() { "unnamed".to_owned() } else { fitted(name) }
}

/// Returns a name that is short enough. The longest of its words are cut, so that names that differ
/// in one word still do.
fn fitted(name: &str) -> String {
    let words: Vec<&str> = name.split_inclusive(['-', '_']).collect();
    let cut = |length: usize| -> String {
        let short = words.iter().map(|word| match word.find(['-', '_']) {
            Some(end) => format!("{}{}", &word[..end.min(length)], &word[end..]),
            None => word[..word.len().min(length)].to_owned(),
        });
        short.collect()
    };
    let fits = (1..=LONGEST).rev().map(cut).find(|short| short.len() <= LONGEST);
    fits.unwrap_or_else(|| name[..name.len().min(LONGEST)].to_owned())
}

/// Returns the name with a number, if it is already in use.
fn unique(name: String, used: &[String]) -> String {
    let numbered = |number: usize| {
        let end = format!("-{number}");
        format!("{}{end}", &name[..name.len().min(LONGEST - end.len())])
    };
    let mut candidates = std::iter::once(name.clone()).chain((2..).map(numbered));
    candidates.find(|candidate| !used.contains(candidate)).unwrap_or(name)
}

/// Names of all participants and all data of a configuration.
#[derive(Clone, Debug)]
pub(crate) struct Names {
    roles: BTreeMap<String, String>,
    /// Fields by data and by the participant that writes them.
    fields: BTreeMap<(String, String), String>,
}

impl Names {
    /// Names roles and fields. A field that would have one of the reserved names gets another one.
    pub(crate) fn new(configuration: &Configuration, reserved: &[String]) -> Self {
        let mut roles = BTreeMap::new();
        let mut used = Vec::new();
        for participant in &configuration.participants {
            let role = unique(role(&participant.name), &used);
            used.push(role.clone());
            roles.insert(participant.name.clone(), role);
        }
        let mut fields = BTreeMap::new();
        let mut used = reserved.to_vec();
        for data in &configuration.data {
            let writers: Vec<&String> = configuration
                .participants
                .iter()
                .filter(|one| one.writes.iter().any(|written| written.data == data.name))
                .map(|one| &one.name)
                .collect();
            for writer in &writers {
                // A field has one producer.
                let short = field(&data.name);
                let wanted = match writers.as_slice() {
                    [_] if !reserved.contains(&short) => short,
                    _ => plain(&format!("{}_{}", roles[*writer], data.name)),
                };
                let name = unique(wanted, &used);
                used.push(name.clone());
                fields.insert((data.name.clone(), (*writer).clone()), name);
            }
        }
        Self { roles, fields }
    }

    /// Returns the role of a participant.
    pub(crate) fn role(&self, participant: &str) -> &str {
        self.roles.get(participant).map_or("", String::as_str)
    }

    /// Returns the field of some data of a participant that writes them.
    pub(crate) fn field(&self, data: &str, writer: &str) -> Option<&str> {
        self.fields.get(&(data.to_owned(), writer.to_owned())).map(String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roles_are_small_and_fit() {
        assert_eq!(role("Fluid"), "fluid");
        assert_eq!(role("Solid-Upstream"), "solid-upstream");
        assert_eq!(role("Ä Solver (2)"), "solver_2");
        assert_eq!(role("Coupling"), "coupling-participant");
        assert_eq!(role("§"), "unnamed");
        assert_eq!(role(&"x".repeat(100)).len(), 31);
    }

    #[test]
    fn valid_data_keep_their_names() {
        for valid in ["Temperature", "Heat-Flux", "k_00", "a__b_"] {
            assert_eq!(field(valid), valid);
        }
        assert_eq!(field("Heat-Flux [W/m2]"), "Heat-Flux_W_m2");
        assert_eq!(
            field("Heat-Transfer-Coefficient-Fluid-Inner"),
            "Heat-Transf-Coeffi-Fluid-Inner"
        );
        assert_eq!(
            field("Heat-Transfer-Coefficient-Fluid-Outer"),
            "Heat-Transf-Coeffi-Fluid-Outer"
        );
        assert_eq!(field(&"a-".repeat(40)), "a-".repeat(40)[..31]);
    }

    #[test]
    fn a_used_name_gets_a_number() {
        let used = ["a", "a-2", &"x".repeat(31)].map(str::to_owned);
        assert_eq!(unique("a".to_owned(), &used), "a-3");
        assert_eq!(unique("x".repeat(31), &used), format!("{}-2", "x".repeat(29)));
    }

    #[test]
    fn names_with_separators_are_quoted() {
        assert_eq!(quoted("Heat-Flux.x"), "Heat-Flux.x");
        assert_eq!(quoted("Wärme"), "Wärme");
        assert_eq!(quoted("Wall Heat"), "\"Wall Heat\"");
        assert_eq!(quoted("a\"->b"), "\"a\"\"->b\"");
    }

    #[test]
    fn a_placeholder_names_its_participant() {
        assert_eq!(of_placeholder(&placeholder("Fluid")), Some("Fluid"));
        assert_eq!(of_placeholder("python3"), None);
    }
}
