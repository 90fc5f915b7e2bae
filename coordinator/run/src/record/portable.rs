//! What a recording says is the same on every machine: files that the case names travel with it,
//! and no path does.

use crate::error::{RunError, input_failure};
use crate::plan::Plan;
use contract::description::{Description, KeyKind};
use contract::input_file;
use contract::message::StateFile;
use proto::recording::{CaseFile, FILES};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Larger files are refused [byte].
const MOST_BYTES: u64 = 4 << 30;

/// The files that a plan's configurations name, with their contents.
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

/// The files that a configuration's case names, by their dotted keys: those of keys that are files.
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

/// Every text of a tree with its key.
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

/// Some key of the participant that is a file has this path.
fn names_file(participant: &Description, key: &[&str]) -> bool {
    let models = participant.models.iter().flat_map(|model| &model.keys);
    let effects = participant.effects.iter().flat_map(|effect| &effect.keys);
    let mut all = participant.keys.iter().chain(models).chain(effects);
    all.any(|spec| spec.kind == KeyKind::File && fits(&spec.path, key))
}

/// A dotted path in which `*` stands for any one name fits a key.
#[must_use]
pub fn fits(path: &str, key: &[&str]) -> bool {
    let parts = path.split('.');
    parts.clone().count() == key.len()
        && parts.zip(key).all(|(part, name)| part == "*" || part == *name)
}

/// The body of `Configure` with the names of attachments in the place of paths; one that is no
/// configuration as it is.
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

/// The body of `Restore` with the grids alone.
pub(super) fn without_files(body: &[u8]) -> Vec<u8> {
    let file: StateFile = serde_json::from_slice(body).expect("we have written it ourselves");
    let file = StateFile { path: PathBuf::new(), outputs: Vec::new(), ..file };
    serde_json::to_vec(&file).expect("grids are plain data")
}

/// A dotted key as a JSON pointer.
fn pointer(key: &str) -> String {
    key.split('.').map(|part| format!("/{part}")).collect()
}

/// A text with every absolute path cut down to its last part.
#[must_use]
pub fn without_paths(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    let mut before = ' ';
    while let Some(c) = rest.chars().next() {
        // A path in quotes may hold anything else.
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

/// `-I`, behind which a path may follow at once.
fn ends_in_an_option(text: &str) -> bool {
    let mut last = text.chars().rev();
    let letter = last.next().is_some_and(|c| c.is_ascii_alphabetic());
    letter && last.next() == Some('-') && last.next().is_none_or(begins_a_word)
}

fn ends_a_path(c: char) -> bool {
    c.is_whitespace() || matches!(c, '"' | '\'' | '`' | ',' | ';' | ')' | ']' | '}' | '<' | '>')
}

/// The name of a file of the case in a recording.
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
