//! Keys that stand in the case and that nothing reads: not the chosen models, not the active effects.

use super::checker::Checker;
use super::known::{COORDINATOR, all_keys};
use super::tree::{Node, Origin, Table};
use contract::description::Description;

/// A key of the case that has no effect.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unread {
    /// Dotted path of the key.
    pub key: String,
    /// What would make somebody read it, as `mech.model = "half-space"`; empty for an entry of a table,
    /// such as a material, that nothing names.
    pub readers: Vec<String>,
    /// It belongs to a table of things with names, such as materials, in which properties that no chosen
    /// model reads are usual, and it has not been set by an option.
    pub is_usual: bool,
}

impl Checker<'_> {
    /// Every key of the case that nothing reads.
    pub(super) fn unread(&self) -> Vec<Unread> {
        let mut found = Vec::new();
        self.find_unread(&self.case.tree, "", &mut found);
        found
    }

    fn find_unread(&self, table: &Table, path: &str, found: &mut Vec<Unread>) {
        for (name, node) in &table.entries {
            let key = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
            match node.table() {
                Some(table) if self.readers(&key).is_empty() => {
                    self.find_unread(table, &key, found);
                }
                _ => found.extend(self.judge_unread(key, node)),
            }
        }
    }

    fn judge_unread(&self, key: String, node: &Node) -> Option<Unread> {
        let readers = self.readers(&key);
        // The coordinator has read its own keys to come this far.
        if readers.iter().any(|known| known.owner == COORDINATOR) {
            return None;
        }
        let mut parts = key.split('.');
        let named =
            parts.next().and_then(|table| Some((self.references.get(table)?, parts.next()?)));
        let is_named = named.is_none_or(|(names, name)| names.iter().any(|one| one == name));
        if is_named && readers.iter().any(|known| known.active) {
            return None;
        }
        let is_usual = named.is_some() && matches!(node.origin, Origin::File { .. });
        let mut words: Vec<String> = match is_named {
            true => readers.iter().map(|known| known.reader.to_string()).collect(),
            false => Vec::new(),
        };
        if readers.is_empty() {
            let reads = |(_, description): &&(String, Description)| {
                all_keys(description).any(|spec| spec.is_of(&key))
            };
            let usual = self.replaced.iter().filter(reads);
            words.extend(usual.map(|(role, of)| format!("{} as {role}", of.name)));
        }
        words.dedup();
        Some(Unread { key, readers: words, is_usual })
    }
}
