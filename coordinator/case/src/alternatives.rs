//! Groups of alternatives: exactly one of all keys with the same `one_of` word is given.
//!
//! The first part of a key after the common section distinguishes the alternatives of a group. Of
//! `motion.speed`, `motion.creepage.xi` and `motion.creepage.eta`, the last two form one
//! alternative, `motion.creepage`.
//!
//! An alternative set by an option replaces the alternatives of the file.

use super::known::{Instance, KnownKey, References, instances};
use super::raw::RawCase;
use super::tree::{Origin, Table};
use std::collections::BTreeMap;

/// One alternative of a group.
#[derive(Clone, Debug)]
pub(super) struct Alternative {
    /// Name shown to the user: the key, or the section that the keys share.
    pub(super) label: String,
    /// Dotted keys.
    pub(super) members: Vec<String>,
}

/// A group of alternatives, exactly one of which is given.
#[derive(Clone, Debug)]
pub(super) struct Group {
    /// The section that all alternatives share; empty for none.
    pub(super) section: String,
    /// The alternatives, in the order of their declaration.
    pub(super) alternatives: Vec<Alternative>,
}

impl Group {
    /// Returns the alternative that contains a key.
    pub(super) fn alternative_of(&self, key: &str) -> Option<&Alternative> {
        self.alternatives.iter().find(|a| a.members.iter().any(|m| m == key))
    }
}

/// Finds the groups among some keys.
pub(super) fn groups(instances: &[Instance<'_>]) -> Vec<Group> {
    let mut members: BTreeMap<(String, &str), Vec<&str>> = BTreeMap::new();
    for instance in instances {
        if let Some(word) = &instance.known.spec.one_of {
            let group = members.entry((word.clone(), &instance.binding)).or_default();
            if !group.contains(&instance.path.as_str()) {
                group.push(&instance.path);
            }
        }
    }
    members.into_values().map(|keys| group(&keys)).collect()
}

fn group(keys: &[&str]) -> Group {
    let split: Vec<Vec<&str>> = keys.iter().map(|key| key.split('.').collect()).collect();
    let sections = split.iter().map(|parts| &parts[..parts.len() - 1]);
    let shared = sections.reduce(|a, b| {
        let same = a.iter().zip(b).take_while(|(x, y)| x == y).count();
        &a[..same]
    });
    let depth = shared.map_or(0, <[&str]>::len);
    let mut alternatives: Vec<Alternative> = Vec::new();
    for (key, parts) in keys.iter().zip(&split) {
        let label = parts[..=depth].join(".");
        match alternatives.iter_mut().find(|a| a.label == label) {
            Some(alternative) => alternative.members.push((*key).to_owned()),
            None => alternatives.push(Alternative { label, members: vec![(*key).to_owned()] }),
        }
    }
    for alternative in &mut alternatives {
        if let [only] = alternative.members.as_slice() {
            alternative.label.clone_from(only);
        }
    }
    let section = shared.map(|parts| parts.join(".")).unwrap_or_default();
    Group { section, alternatives }
}

/// Keys of the file that an option has replaced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Replaced {
    /// The option, in full.
    pub option: String,
    /// The replaced keys.
    pub keys: Vec<String>,
}

/// Returns the case without the alternatives of the file that an option replaces, and a list of
/// these replacements. Two alternatives that both come from options, or both from the file, stay
/// and are reported later.
pub(super) fn resolve(raw: &RawCase, known: &[KnownKey<'_>]) -> (RawCase, Vec<Replaced>) {
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

/// Returns the number of the option that has set a key.
fn set_by(tree: &Table, key: &str) -> Option<usize> {
    match tree.find(key)?.origin {
        Origin::Argument(number) => Some(number),
        Origin::File { .. } => None,
    }
}

/// Removes a key, and every section below `keep` that becomes empty.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(keys: &[&str]) -> (String, Vec<String>) {
        let group = group(keys);
        (group.section, group.alternatives.into_iter().map(|a| a.label).collect())
    }

    #[test]
    fn a_table_is_one_alternative() {
        let (section, names) = labels(&["m.speed", "m.creepage.xi", "m.creepage.eta", "m.only.x"]);
        assert_eq!(section, "m");
        assert_eq!(names, ["m.speed", "m.creepage", "m.only.x"]);
    }

    #[test]
    fn keys_of_one_table_are_alternatives() {
        assert_eq!(labels(&["a.b.x", "a.b.y"]).1, ["a.b.x", "a.b.y"]);
        assert_eq!(labels(&["load.n", "contact.a", "contact.b"]).1, ["load.n", "contact"]);
        assert_eq!(labels(&["a.x"]), ("a".to_owned(), vec!["a.x".to_owned()]));
    }
}
