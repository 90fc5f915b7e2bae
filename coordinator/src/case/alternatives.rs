//! Of several alternatives, the one that an option sets replaces those of the file.

use super::groups::{Alternative, groups};
use super::known::{Known, References, instances};
use super::raw::RawCase;
use super::tree::{Origin, Table};

/// The case without the alternatives of the file that an option replaces. Two that both come from
/// options, or both from the file, stay and are told later.
pub(super) fn resolve(raw: &RawCase, known: &[Known]) -> RawCase {
    let mut case = raw.clone();
    for group in groups(&instances(known, &raw.tree, &References::new())) {
        let set = |a: &Alternative| a.members.iter().any(|key| is_set(&raw.tree, key));
        if !group.alternatives.iter().any(set) {
            continue;
        }
        for replaced in group.alternatives.iter().filter(|a| !set(a)) {
            for key in &replaced.members {
                remove_with_empty_sections(&mut case.tree, key, &group.section);
            }
        }
    }
    case
}

fn is_set(tree: &Table, key: &str) -> bool {
    tree.find(key).is_some_and(|node| matches!(node.origin, Origin::Argument(_)))
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
