//! Identity of a result: the programs, case values and files from which it was computed.
//!
//! A command that continues earlier results compares identities first. Results of two identities
//! never stand in one table.

use crate::error::{RunError, file_failure};
use crate::plan::{Participant, Plan, Planned};
use crate::record::named_files;
use crate::sealed::{sum, sum_of_file};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::env;
use std::path::Path;
use std::sync::OnceLock;

/// Sections of a case that do not influence the figures of a summary.
const WITHOUT_INFLUENCE: [&str; 3] = ["case", "limits", "output"];
/// Largest number of differences in a message.
const LISTED: usize = 6;

/// Programs, values and files that determine a result.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Name, version and CRC-64 of the description of each program, by role.
    pub programs: BTreeMap<String, Program>,
    /// Values by dotted key, in SI units, with defaults filled in.
    pub values: BTreeMap<String, Value>,
    /// CRC-64 of the content of each file, by the dotted key that names it.
    pub files: BTreeMap<String, String>,
}

/// Identity of a program.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Program {
    /// Name and version.
    pub version: String,
    /// CRC-64 of the description, which includes the build that the program states; for the
    /// coordinator, CRC-64 of its executable.
    pub description: String,
}

impl Identity {
    /// Returns the identity of a planned run.
    ///
    /// # Errors
    /// A file that the case names cannot be read.
    pub fn of(planned: &Planned) -> Result<Self, RunError> {
        let Planned { case, plan } = planned;
        let own = format!("{}, protocol {}", env!("CARGO_PKG_VERSION"), contract::PROTOCOL_VERSION);
        let own = Program { version: format!("coordinator {own}"), description: own_sum() };
        let mut identity = Self::default();
        identity.programs.insert("coordinator".to_owned(), own);
        flatten(&case.values.0, &mut Vec::new(), &mut |key, value| {
            if !WITHOUT_INFLUENCE.contains(&key[0]) {
                identity.values.insert(key.join("."), value.clone());
            }
        });
        for participant in &plan.participants {
            identity.programs.insert(participant.role.clone(), program(participant));
        }
        identity.add_files(planned)?;
        Ok(identity)
    }

    /// Adds the content of a file in place of the value of its key. The path of the file does not
    /// matter.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn add_file(&mut self, key: &str, path: &Path) -> Result<(), RunError> {
        let found = sum_of_file(path).map_err(|error| file_failure(path, &error))?;
        self.values.remove(key);
        self.files.insert(key.to_owned(), hexadecimal(found));
        Ok(())
    }

    /// Returns the files of a planned run alone: what the case, its histories and its commands
    /// name.
    ///
    /// # Errors
    /// A file that the case names cannot be read.
    pub fn files(planned: &Planned) -> Result<BTreeMap<String, String>, RunError> {
        let mut identity = Self::default();
        identity.add_files(planned)?;
        Ok(identity.files)
    }

    fn add_files(&mut self, Planned { case, plan }: &Planned) -> Result<(), RunError> {
        for participant in &plan.participants {
            for (key, path) in named_files(&participant.description, &case.values.0) {
                self.add_file(&key, &path)?;
            }
            for (number, path) in participant.program.files() {
                self.add_file(&format!("{}.command[{number}]", participant.role), &path)?;
            }
        }
        if let Some(histories) = &case.histories {
            let content = json!(histories).to_string();
            self.files.insert("time.history".to_owned(), hexadecimal(sum(content.as_bytes())));
        }
        Ok(())
    }

    /// Describes the differences of a later identity; empty if both are the same.
    #[must_use]
    pub fn differences(&self, now: &Self) -> Vec<String> {
        let mut all = Vec::new();
        for role in keys(&self.programs, &now.programs) {
            match (self.programs.get(role), now.programs.get(role)) {
                (Some(was), Some(is)) if was == is => {}
                (Some(was), Some(is)) if was.version == is.version => {
                    all.push(format!("{role}: another build of {}", is.version));
                }
                (was, is) => {
                    let version =
                        |one: Option<&Program>| one.map_or("absent", |one| &one.version).to_owned();
                    all.push(format!("{role}: was {}, is {}", version(was), version(is)));
                }
            }
        }
        // Keys that only one of both has often follow from a changed one, such as the model.
        let (absent, mut one_sided) = (Value::from("absent"), Vec::new());
        for key in keys(&self.values, &now.values) {
            let of = |one: &Self| match one.files.contains_key(key) {
                true => Value::from("a file"),
                false => one.values.get(key).unwrap_or(&absent).clone(),
            };
            let (was, is) = (of(self), of(now));
            if was != is {
                let list = if was == absent || is == absent { &mut one_sided } else { &mut all };
                list.push(format!("{key}: was {}, is {}", word(&was), word(&is)));
            }
        }
        all.append(&mut one_sided);
        for key in keys(&self.files, &now.files) {
            match (self.files.get(key), now.files.get(key)) {
                (was, is) if was == is => {}
                (Some(_), Some(_)) => all.push(format!("{key}: the content of the file changed")),
                // A value that replaces a file, or is replaced by one, is already listed above.
                _ if self.values.contains_key(key) || now.values.contains_key(key) => {}
                (Some(_), None) => all.push(format!("{key}: was a file, is absent")),
                (None, _) => all.push(format!("{key}: was absent, is a file")),
            }
        }
        all
    }

    /// Checks that results of this identity may stand beside results of a later one.
    ///
    /// # Errors
    /// [`RunError::Usage`] names the place of the results, what differs, and what to do.
    pub fn require_same(&self, now: &Self, place: &str, fix: &str) -> Result<(), RunError> {
        let mut all = self.differences(now);
        let hidden = all.len().saturating_sub(LISTED);
        all.truncate(LISTED);
        if hidden > 0 {
            all.push(format!("and {hidden} more"));
        }
        match all.is_empty() {
            true => Ok(()),
            false => Err(RunError::Usage(format!(
                "{place} belongs to another case ({}); {fix}",
                all.join("; ")
            ))),
        }
    }

    /// Returns the CRC-64 of the identity, for files without room for all of it.
    #[must_use]
    pub fn digest(&self) -> String {
        hexadecimal(sum(json!(self).to_string().as_bytes()))
    }
}

/// Says which programs may change without a difference of their identities: programs that state no
/// build, of which only the files of the command are compared. Empty if there are none.
#[must_use]
pub fn unseen(plan: &Plan) -> String {
    let silent = |one: &&Participant| {
        one.description.build.is_none() && one.program.linked.is_none() && !one.program.is_ours()
    };
    let all: Vec<&str> =
        plan.participants.iter().filter(silent).map(|one| one.role.as_str()).collect();
    match all.is_empty() {
        true => String::new(),
        false => format!(
            "; {} states no build (docs/write-a-solver.md): a change of a file that its command \
             does not name is not seen",
            all.join(", ")
        ),
    }
}

fn program(participant: &Participant) -> Program {
    let description = &participant.description;
    Program {
        version: format!("{} {}", description.name, description.version),
        description: checksum(participant),
    }
}

/// Returns the CRC-64 of a participant's description, as a word.
pub(crate) fn checksum(participant: &Participant) -> String {
    let description = serde_json::to_vec(&*participant.description);
    hexadecimal(sum(&description.expect("a description is plain data")))
}

/// Returns the CRC-64 of this executable; empty if it cannot be read.
fn own_sum() -> String {
    static SUM: OnceLock<String> = OnceLock::new();
    let found = || env::current_exe().and_then(|path| sum_of_file(&path)).map(hexadecimal);
    SUM.get_or_init(|| found().unwrap_or_default()).clone()
}

fn hexadecimal(sum: u64) -> String {
    format!("{sum:016x}")
}

/// Formats a value as in a case file.
fn word(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// Returns the keys of both maps.
pub(crate) fn keys<'a, V>(
    one: &'a BTreeMap<String, V>,
    other: &'a BTreeMap<String, V>,
) -> BTreeSet<&'a String> {
    one.keys().chain(other.keys()).collect()
}

/// Calls `seen` with every value of a tree of tables and its key.
fn flatten<'a>(tree: &'a Value, key: &mut Vec<&'a str>, seen: &mut impl FnMut(&[&str], &Value)) {
    match tree {
        Value::Object(table) => {
            for (name, value) in table {
                key.push(name);
                flatten(value, key, seen);
                key.pop();
            }
        }
        value => seen(key, value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn identity() -> Identity {
        let program = Program { version: "mech-solver 1".into(), description: "a".into() };
        Identity {
            programs: BTreeMap::from([("mech".to_owned(), program)]),
            values: BTreeMap::from([("motion.speed".to_owned(), json!(38.9))]),
            files: BTreeMap::from([("bodies.rail.profile".to_owned(), "1".to_owned())]),
        }
    }

    #[test]
    fn every_difference_is_named_with_both_values() {
        assert!(identity().differences(&identity()).is_empty());
        assert!(identity().require_same(&identity(), "DIR", "fix").is_ok());
        type Change = fn(&mut Identity);
        let rows: [(Change, &str); 8] = [
            (
                |one| drop(one.values.insert("motion.speed".into(), json!(20.0))),
                "motion.speed: was 38.9, is 20.0",
            ),
            (|one| one.values.clear(), "motion.speed: was 38.9, is absent"),
            (
                |one| drop(one.values.insert("mech.model".into(), json!("half-space"))),
                "mech.model: was absent, is half-space",
            ),
            (
                |one| drop(one.files.insert("bodies.rail.profile".into(), "2".into())),
                "bodies.rail.profile: the content of the file changed",
            ),
            (|one| one.files.clear(), "bodies.rail.profile: was a file, is absent"),
            (
                |one| one.programs.get_mut("mech").unwrap().version = "mech-solver 2".into(),
                "mech: was mech-solver 1, is mech-solver 2",
            ),
            (
                |one| one.programs.get_mut("mech").unwrap().description = "b".into(),
                "mech: another build of mech-solver 1",
            ),
            (|one| one.programs.clear(), "mech: was mech-solver 1, is absent"),
        ];
        for (change, words) in rows {
            let mut now = identity();
            change(&mut now);
            assert_eq!(identity().differences(&now), [words]);
            assert_ne!(identity().digest(), now.digest());
            let refused = identity().require_same(&now, "DIR", "begin anew").unwrap_err();
            assert_eq!(refused.exit_code(), 2);
            let text = refused.to_string();
            assert!(text.contains("DIR") && text.contains(words), "{text}");
            assert!(text.ends_with("begin anew"), "{text}");
        }
    }

    /// The same content under another name is the same input; a value in place of a file is another
    /// input.
    #[test]
    fn a_file_counts_by_its_content() {
        let place = tempfile::tempdir().unwrap();
        let with = |name: &str, content: &str| {
            let path = place.path().join(name);
            fs::write(&path, content).unwrap();
            let mut identity = identity();
            identity.add_file("mech.table", &path).unwrap();
            identity
        };
        let one = with("a", "1,2");
        assert_eq!(one, with("b", "1,2"));
        assert_ne!(one, with("a", "1,3"));
        let mut value = identity();
        value.values.insert("mech.table".to_owned(), json!(3.0));
        assert_eq!(one.differences(&value), ["mech.table: was a file, is 3.0"]);
    }
}
