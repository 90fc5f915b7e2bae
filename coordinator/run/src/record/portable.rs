//! Recordings without paths of this machine: the recording contains the files that the case names.

use crate::error::{RunError, input_failure};
use crate::plan::Plan;
use contract::description::{Description, KeyKind};
use contract::input_file;
use contract::message::StateFile;
use proto::recording::{CaseFile, FILES};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Largest file that is recorded [byte].
const MOST_BYTES: u64 = 4 << 30;

/// Returns the files named by the configurations of a plan, with their contents.
///
/// # Errors
/// A file cannot be read.
pub fn case_files(plan: &Plan) -> Result<Vec<(CaseFile, Vec<u8>)>, RunError> {
    let mut named = BTreeMap::new();
    for participant in &plan.participants {
        let case = serde_json::to_value(&participant.configuration.case)
            .expect("a configuration is plain data");
        named.extend(named_files(&participant.description, &case));
    }
    let read = |(key, path): (String, PathBuf)| {
        let content =
            input_file::read(&path, MOST_BYTES).map_err(|error| input_failure(&path, &error))?;
        Ok((CaseFile { attachment: attachment_name(&key), key }, content))
    };
    named.into_iter().map(read).collect()
}

/// Returns the files named by a configuration's case, by dotted key.
#[must_use]
pub fn named_files(participant: &Description, case: &Value) -> BTreeMap<String, PathBuf> {
    let mut named = BTreeMap::new();
    texts(case, &mut Vec::new(), &mut |key, path| {
        if names_file(participant, key) {
            named.insert(key.join("."), PathBuf::from(path));
        }
    });
    named
}

/// Calls `seen` with every text of a tree and its key.
fn texts<'a>(tree: &'a Value, key: &mut Vec<&'a str>, seen: &mut impl FnMut(&[&str], &str)) {
    match tree {
        Value::String(text) => seen(key, text),
        Value::Object(table) => {
            for (name, value) in table {
                key.push(name);
                texts(value, key, seen);
                key.pop();
            }
        }
        _ => {}
    }
}

/// Returns whether the participant describes this key as a file.
fn names_file(participant: &Description, key: &[&str]) -> bool {
    let models = participant.models.iter().flat_map(|model| &model.keys);
    let effects = participant.effects.iter().flat_map(|effect| &effect.keys);
    let mut all = participant.keys.iter().chain(models).chain(effects);
    all.any(|spec| spec.kind == KeyKind::File && fits(&spec.path, key))
}

/// Returns whether a key matches a dotted path in which `*` stands for any one name.
#[must_use]
pub fn fits(path: &str, key: &[&str]) -> bool {
    let parts = path.split('.');
    parts.clone().count() == key.len()
        && parts.zip(key).all(|(part, name)| part == "*" || part == *name)
}

/// Returns the body of `Configure` with names of attachments instead of paths. A body that is no
/// configuration is returned unchanged.
#[must_use]
pub fn portable_body(body: &[u8], files: &[CaseFile]) -> Vec<u8> {
    if files.is_empty() {
        return body.to_vec();
    }
    let Ok(mut configuration) = serde_json::from_slice::<Value>(body) else {
        return body.to_vec();
    };
    for file in files {
        if let Some(value) = configuration.pointer_mut(&format!("/case{}", pointer(&file.key))) {
            *value = Value::String(file.attachment.clone());
        }
    }
    serde_json::to_vec(&configuration).expect("a configuration is plain data")
}

/// Returns the body of `Restore` with only its grids.
pub(super) fn without_files(body: &[u8]) -> Vec<u8> {
    let file: StateFile = serde_json::from_slice(body).expect("we have written it ourselves");
    let file = StateFile { path: PathBuf::new(), outputs: Vec::new(), ..file };
    serde_json::to_vec(&file).expect("grids are plain data")
}

/// Returns a dotted key as a JSON pointer.
fn pointer(key: &str) -> String {
    key.split('.').map(|part| format!("/{part}")).collect()
}

/// Returns the text with every absolute path cut to its last part.
#[must_use]
pub fn without_paths(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    let mut before = ' ';
    while let Some(c) = rest.chars().next() {
        // A quoted path may contain any other character.
        let quoted = matches!(before, '"' | '\'' | '`').then(|| rest.find(before)).flatten();
        let end = quoted.or_else(|| rest.find(ends_a_path)).unwrap_or(rest.len());
        if c == '/' && end > 1 && (begins_a_word(before) || ends_in_an_option(&out)) {
            let path = rest[..end].trim_end_matches('/');
            out.push_str(path.rsplit('/').next().unwrap_or_default());
            rest = &rest[end..];
            before = '/';
        } else {
            out.push(c);
            before = c;
            rest = &rest[c.len_utf8()..];
        }
    }
    out
}

fn begins_a_word(before: char) -> bool {
    !before.is_alphanumeric() && !matches!(before, '/' | '.' | '_' | '-' | ')' | ']' | '~')
}

/// Returns whether the text ends in an option such as `-I`, which a path may follow without a
/// space.
fn ends_in_an_option(text: &str) -> bool {
    let mut last = text.chars().rev();
    let letter = last.next().is_some_and(|c| c.is_ascii_alphabetic());
    letter && last.next() == Some('-') && last.next().is_none_or(begins_a_word)
}

fn ends_a_path(c: char) -> bool {
    c.is_whitespace() || matches!(c, '"' | '\'' | '`' | ',' | ';' | ')' | ']' | '}' | '<' | '>')
}

/// Returns the name of a case file in a recording.
fn attachment_name(key: &str) -> String {
    format!("{FILES}{key}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_fits_any_one_name() {
        assert!(fits("materials.*.curve", &["materials", "steel", "curve"]));
        assert!(!fits("materials.*.curve", &["materials", "curve"]));
        assert!(!fits("bodies.wheel.profile", &["rail", "profile"]));
    }

    #[test]
    fn paths_lose_their_folders_and_units_stay() {
        let text = "command = [\"/home/me/solver\", '--file=/tmp/x/y.csv'] # 5 m/s, W/m2, 1 / 2";
        let out = without_paths(text);
        assert_eq!(out, "command = [\"solver\", '--file=y.csv'] # 5 m/s, W/m2, 1 / 2");
        assert_eq!(without_paths("state file /a/b.state: gone"), "state file b.state: gone");
        assert_eq!(without_paths("at `/a/b/`"), "at `b`");
        assert_eq!(without_paths("\"/home/Jane Doe/x y\", -I/home/me/z"), "\"x y\", -Iz");
        assert_eq!(without_paths("J/(kg K), a-b/c"), "J/(kg K), a-b/c");
        assert_eq!(without_paths("profiles/rail.csv"), "profiles/rail.csv");
    }
}
