//! Every key that the case has: known or not, and with a value that fits or not.

use super::check::{Fault, check};
use super::checker::{Checker, put};
use super::known::{COORDINATOR, Known, leads_to};
use super::live::is_live;
use super::schema::{ON_FAILURE, SECTIONS};
use super::tree::{Node, Table, Value};
use contract::description::{KeyKind, matches};
use contract::suggest::{all_of, any_of, nearest};
use contract::text::check_line;
use serde_json::{Map, Value as Json};
use std::collections::BTreeSet;

/// Most names that a fix lists.
const MOST_NAMES: usize = 12;

impl Checker<'_> {
    /// Checks every key of a table; `path` is its dotted key.
    pub(super) fn walk(&mut self, table: &Table, path: &str) {
        for (name, node) in &table.entries {
            let key = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
            if name.is_empty() || name.contains('.') {
                let reason = "a name must not be empty or have a dot in it".to_owned();
                self.fault_at_name(node, &key, reason, name_fix(name));
                continue;
            }
            if let Err(reason) = check_line("the name", name) {
                self.fault_at_name(node, &key, reason, "write a plain name".to_owned());
                continue;
            }
            let readers = self.readers(&key);
            match node.table() {
                Some(table) if self.is_section(&key) => self.walk(table, &key),
                None if readers.is_empty() && self.is_section(&key) => {
                    self.not_a_section(&key, node);
                }
                _ if readers.is_empty() => self.unknown(&key, node),
                Some(table) if table.get("column").is_some() => {
                    self.column(&key, node, table, &readers);
                }
                Some(table) if is_live(table) => self.live(&key, node, table, &readers),
                _ => self.leaf(&key, node, &readers),
            }
        }
    }

    fn leaf(&mut self, key: &str, node: &Node, readers: &[&Known<'_>]) {
        if readers.iter().all(|r| r.owner == COORDINATOR && !r.active) && key.starts_with("time.") {
            let reason = format!("has no meaning in a {} case", self.selection.timing.word());
            let other = if key == ON_FAILURE { "sequence" } else { "transient" };
            let fix = format!("remove it, or write `time.mode = \"{other}\"`");
            return self.fault_at_name(node, key, reason, fix);
        }
        let folder = self.case.folder().to_owned();
        let checked = |active| {
            let of = readers.iter().filter(move |r| r.active == active);
            of.map(|r| check(r, node, &folder)).collect::<Vec<_>>()
        };
        let results = checked(true);
        let faults: Vec<&Fault> = results.iter().filter_map(|r| r.as_ref().err()).collect();
        // No participant reads it now: it must suit one of those which would.
        let idle = if results.is_empty() { checked(false) } else { Vec::new() };
        let value = results.iter().chain(&idle).find_map(|r| r.as_ref().ok());
        let refused =
            idle.iter().filter_map(|r| r.as_ref().err()).take(usize::from(value.is_none()));
        for fault in faults.into_iter().chain(refused) {
            self.fault(key, fault.reason.clone(), fault.fix.clone());
        }
        if let Some(value) = value {
            put(&mut self.values.0, key, value.clone());
        }
    }

    /// A table may stand at this key.
    pub(super) fn is_section(&self, key: &str) -> bool {
        let named = |table: &str| leads_to(key, &format!("{table}.*.*"));
        let effect = |name: &str| self.selection.claimants(name).next().is_some();
        key == "effects"
            || key.strip_prefix("effects.").is_some_and(effect)
            || self.selection.players.iter().any(|player| player.role == key)
            || self.known.iter().any(|k| {
                let refers = matches!(&k.spec.kind, KeyKind::NameIn { table } if named(table));
                refers || leads_to(key, &k.spec.path)
            })
            || self.is_read_by_replaced(|spec| leads_to(key, &spec.path))
    }

    fn not_a_section(&mut self, key: &str, node: &Node) {
        let effect = key.starts_with("effects.");
        let fix = match &node.value {
            Value::Flag(false) if effect => {
                "remove it: an effect without a table is off".to_owned()
            }
            _ => format!("write it as a section: [{key}]"),
        };
        self.fault(key, format!("is {}, not a table", node.value.describe()), fix);
    }

    fn unknown(&mut self, key: &str, node: &Node) {
        if self.unasked && !is_own(key) {
            return self.not_judged.push(key.to_owned());
        }
        if let Some(to) = self.renamed(key) {
            let reason = "is the spelling of an earlier version".to_owned();
            return self.fault_at_name(node, key, reason, format!("write {to}"));
        }
        let (section, name) = key.rsplit_once('.').unwrap_or(("", key));
        if section == "effects" {
            return self.unknown_effect(key, name, node);
        }
        if self.is_read_by_replaced(|spec| spec.is_of(key)) {
            return;
        }
        let kind = if section.is_empty() && node.table().is_some() { "section" } else { "key" };
        let siblings = self.siblings(section);
        let at =
            |name: &str| if section.is_empty() { name.into() } else { format!("{section}.{name}") };
        let near = nearest(name, siblings.iter().map(String::as_str)).map(at);
        self.meant.extend(near.clone());
        let fix = match near.or_else(|| self.elsewhere(name)) {
            Some(near) if kind == "section" => format!("write [{near}]"),
            Some(near) => format!("write `{near}`"),
            None => self.remove_or_pick(key, kind, &siblings),
        };
        let reason = match node.table() {
            Some(table) if kind == "section" && is_role(table) => {
                "unknown section: no participant of this name was asked".to_owned()
            }
            _ => format!("unknown {kind}; {} do not read it", all_of(&self.selection.asked())),
        };
        self.fault_at_name(node, key, reason, fix);
    }

    /// What a participant has in the place of a key of an earlier version.
    fn renamed(&self, key: &str) -> Option<&str> {
        let mut keys = self.selection.players.iter().flat_map(|p| &p.description.renamed);
        keys.find(|renamed| renamed.from == key).map(|renamed| renamed.to.as_str())
    }

    fn remove_or_pick(&self, key: &str, kind: &str, siblings: &[String]) -> String {
        let participant = if kind == "section" {
            format!("; a participant of your own needs `{key}.command`")
        } else {
            String::new()
        };
        match siblings {
            [] => format!("remove it{participant}"),
            names if names.len() > MOST_NAMES => format!("remove it{participant}"),
            names => format!("remove it, or write {} instead{participant}", any_of(names)),
        }
    }

    fn unknown_effect(&mut self, key: &str, name: &str, node: &Node) {
        let players = &self.selection.players;
        let offers = |p: &super::selection::Player<'_>| {
            p.description.effects.iter().map(|e| e.name.clone()).collect::<Vec<_>>()
        };
        let names: BTreeSet<String> = players.iter().flat_map(offers).collect();
        let near = nearest(name, names.iter().map(String::as_str));
        let hint = near.map(|n| format!("; did you mean `{n}`?")).unwrap_or_default();
        let listed: Vec<String> = names.iter().map(|n| self.offer(n)).collect();
        let fix = match near {
            Some(near) => format!("write [effects.{near}]; there are {}", all_of(&listed)),
            None if listed.is_empty() => "remove it: no participant offers effects".to_owned(),
            None => format!("remove it; there are {}", all_of(&listed)),
        };
        self.fault_at_name(node, key, format!("unknown effect `{name}`{hint}"), fix);
    }

    /// "friction_heat (mech, thermal)".
    fn offer(&self, effect: &str) -> String {
        let roles: Vec<&str> = self.selection.claimants(effect).map(|(p, _)| p.role).collect();
        format!("{effect} ({})", roles.join(", "))
    }

    /// The names that may stand in a section.
    fn siblings(&self, section: &str) -> Vec<String> {
        let depth = if section.is_empty() { 0 } else { section.split('.').count() };
        let paths = self.known.iter().map(|k| k.spec.path.as_str());
        let paths = paths.filter(|path| section.is_empty() || leads_to(section, path));
        let names: BTreeSet<&str> =
            paths.filter_map(|p| p.split('.').nth(depth)).filter(|n| *n != "*").collect();
        names.into_iter().map(str::to_owned).collect()
    }

    /// A known key of this name in another section.
    fn elsewhere(&self, name: &str) -> Option<String> {
        let mut paths = self.known.iter().map(|k| &k.spec.path).filter(|p| !p.contains('*'));
        let found = paths.find(|p| p.rsplit_once('.').is_some_and(|(_, last)| last == name));
        found.filter(|path| !matches(path, name)).cloned()
    }

    /// An empty table for every active effect, so that it is there even without parameters.
    pub(super) fn put_effects(&mut self) {
        for effect in self.selection.effects.iter().filter(|e| !e.contains('.')) {
            let key = format!("effects.{effect}");
            if self.is_section(&key) && !self.values.has(&key) {
                put(&mut self.values.0, &key, Json::Object(Map::new()));
            }
        }
    }
}

/// The key is in a section of the coordinator; those of effects are the participants'.
fn is_own(key: &str) -> bool {
    let section = key.split('.').next().unwrap_or(key);
    section != "effects" && SECTIONS.contains(&section)
}

fn is_role(table: &Table) -> bool {
    table.get("model").is_some()
}

fn name_fix(name: &str) -> String {
    let plain = name.replace('.', "_");
    if plain.is_empty() { "write a name".to_owned() } else { format!("write `{plain}`") }
}
