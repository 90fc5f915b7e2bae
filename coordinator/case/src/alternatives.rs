//! Of several alternatives, the one that an option sets replaces those of the file.

use super::groups::{Alternative, groups};
use super::known::{Known, References, instances};
use super::raw::RawCase;
use super::tree::{Origin, Table};

/// Keys of the file that an option has replaced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Replaced {
    /// The option, in full.
    pub option: String,
    /// The keys that it stands in the place of.
    pub keys: Vec<String>,
}

/// The case without the alternatives of the file that an option replaces, and what these are. Two that
/// both come from options, or both from the file, stay and are reported later.
pub(super) fn resolve(raw: &RawCase, known: &[Known<'_>]) -> (RawCase, Vec<Replaced>) {
    let mut case = raw.clone();
    let mut all = Vec::new();
    for group in groups(&instances(known, &raw.tree, &References::new())) {
        let set = |a: &Alternative| a.members.iter().any(|key| set_by(&raw.tree, key).is_some());
        let members = group.alternatives.iter().flat_map(|a| &a.members);
        let Some(option) = members.clone().find_map(|key| set_by(&raw.tree, key)) else { continue };
        let others = group.alternatives.iter().filter(|a| !set(a)).flat_map(|a| &a.members);
        let keys: Vec<String> = others.filter(|key| raw.has(key)).cloned().collect();
        for key in &keys {
            remove_with_empty_sections(&mut case.tree, key, &group.section);
        }
        if !keys.is_empty() {
            all.push(Replaced { option: raw.arguments[option].clone(), keys });
        }
    }
    (case, all)
}

/// The number of the option that has set a key.
fn set_by(tree: &Table, key: &str) -> Option<usize> {
    match tree.find(key)?.origin {
        Origin::Argument(number) => Some(number),
        Origin::File { .. } => None,
    }
}

/// Removes a key, and the sections below `keep` that it leaves empty.
fn remove_with_empty_sections(tree: &mut Table, key: &str, keep: &str) {
    let mut path: Vec<String> = key.split('.').map(str::to_owned).collect();
    if tree.remove(&path).is_none() {
        return;
    }
    while path.pop().is_some() && path.join(".").len() > keep.len() {
        if tree.table(&path.join(".")).is_none_or(|table| !table.entries.is_empty()) {
            return;
        }
        tree.remove(&path);
    }
}
