//! Groups of alternatives: of all keys with the same `one_of` word exactly one is given.
//!
//! The alternatives of a group are distinguished by the first part of their keys after what all
//! have in common: of `motion.speed`, `motion.creepage.xi` and `motion.creepage.eta` the last two
//! are one alternative, `motion.creepage`.

use super::known::Instance;
use std::collections::BTreeMap;

/// One alternative of a group.
#[derive(Clone, Debug)]
pub(super) struct Alternative {
    /// What people call it: its key, or the section that its keys share.
    pub(super) label: String,
    /// Its keys.
    pub(super) members: Vec<String>,
}

/// Keys of which exactly one alternative is given.
#[derive(Clone, Debug)]
pub(super) struct Group {
    /// The section that all alternatives share; empty for none.
    pub(super) section: String,
    /// The alternatives, in the order of their declaration.
    pub(super) alternatives: Vec<Alternative>,
}

impl Group {
    /// The alternative that a key belongs to.
    pub(super) fn alternative_of(&self, key: &str) -> Option<&Alternative> {
        self.alternatives.iter().find(|a| a.members.iter().any(|m| m == key))
    }
}

/// The groups among some keys.
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
