//! Missing keys: required keys, alternatives of which none is given, incomplete groups.

use super::alternatives::{Alternative, Group, groups};
use super::check::example;
use super::diagnostics::{Place, Problem};
use super::filled_case::FilledCase;
use super::known::Instance;
use super::tree::{Node, Origin};
use contract::suggest::{all_of, any_of};
use std::collections::BTreeMap;

/// A missing part of a section.
struct MissingPart {
    key: String,
    reason: String,
    /// Text to add: `speed = "30 m/s"`.
    add: String,
}

/// A missing required key, with everything that needs it.
struct MissingKey<'i> {
    instance: &'i Instance<'i>,
    owners: Vec<&'i str>,
}

impl FilledCase<'_> {
    /// Reports all missing keys.
    pub(super) fn missing(&mut self) {
        let active = &self.keys.active;
        let groups = groups(&self.keys.all);
        let mut lacks: BTreeMap<String, Vec<MissingPart>> = BTreeMap::new();
        for wanted in self.required(active, &groups) {
            let path = &wanted.instance.path;
            let section = path.rsplit_once('.').map_or("", |(section, _)| section);
            lacks.entry(section.to_owned()).or_default().push(lack(&wanted));
        }
        for group in &groups {
            if let Some(lack) = self.alternatives(group, active) {
                lacks.entry(group.section.clone()).or_default().push(lack);
            }
        }
        for (section, lacks) in lacks {
            self.report_lacks(&section, lacks);
        }
        self.together(active);
    }

    fn given(&self, key: &str) -> bool {
        self.scope.case.tree.find(key).is_some()
    }

    fn is_chosen(&self, alternative: &Alternative) -> bool {
        alternative.members.iter().any(|key| self.given(key))
    }

    /// Returns whether an error was already reported for the key or a section above it: a wrong
    /// name, or a value that is not a table.
    fn is_botched(&self, key: &str) -> bool {
        let holds = |section: &str| {
            key.strip_prefix(section).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        let no_table = |section: &str| {
            let node = self.scope.case.tree.find(section).filter(|node| node.table().is_none());
            node.is_some() && self.scope.readers(section).is_empty()
        };
        self.meant.iter().any(|meant| holds(meant))
            || key.match_indices('.').any(|(at, _)| no_table(&key[..at]))
    }

    /// Returns the missing required keys, in order, each with everything that needs it.
    fn required<'i>(&self, active: &'i [Instance<'i>], groups: &[Group]) -> Vec<MissingKey<'i>> {
        let mut found: Vec<MissingKey<'i>> = Vec::new();
        for instance in active {
            let spec = &instance.known.spec;
            let mut alternatives = groups.iter().filter_map(|g| g.alternative_of(&instance.path));
            let asked = spec.one_of.is_none() || alternatives.any(|a| self.is_chosen(a));
            let lacking = spec.required && spec.default.is_none() && !self.given(&instance.path);
            if !asked || !lacking || self.is_botched(&instance.path) {
                continue;
            }
            let owner = instance.known.owner;
            match found.iter_mut().find(|w| w.instance.path == instance.path) {
                Some(wanted) if wanted.owners.contains(&owner) => {}
                Some(wanted) => wanted.owners.push(owner),
                None => found.push(MissingKey { instance, owners: vec![owner] }),
            }
        }
        found
    }

    fn report_lacks(&mut self, section: &str, lacks: Vec<MissingPart>) {
        let place = self.scope.case.section_place(section);
        let node = self.scope.case.tree.find(section);
        if node.is_none() && !section.is_empty() {
            let add: Vec<&str> = lacks.iter().map(|lack| lack.add.as_str()).collect();
            let fix = format!("add [{section}] with {}", all_of(&add));
            let reason = format!("missing section [{section}]");
            self.faults.push(Problem::new(place, section, reason, fix));
            return;
        }
        for lack in lacks {
            let to = if section.is_empty() { String::new() } else { format!(" to [{section}]") };
            let fix = format!("add {}{to}", lack.add);
            self.faults.push(Problem::new(place.clone(), lack.key, lack.reason, fix));
        }
    }

    /// Checks that exactly one alternative is given; returns the missing part if none is given.
    fn alternatives(&mut self, group: &Group, active: &[Instance<'_>]) -> Option<MissingPart> {
        let readers =
            |a: &Alternative| active.iter().filter(|i| a.members.contains(&i.path)).collect();
        let each = group.alternatives.iter().map(|a| (a, readers(a)));
        let readable: Vec<(&Alternative, Vec<&Instance<'_>>)> =
            each.filter(|(_, readers): &(_, Vec<_>)| !readers.is_empty()).collect();
        let labels: Vec<&str> = readable.iter().map(|(a, _)| a.label.as_str()).collect();
        let chosen: Vec<&Alternative> =
            group.alternatives.iter().filter(|a| self.is_chosen(a)).collect();
        let mut members = group.alternatives.iter().flat_map(|a| &a.members);
        let botched = members.any(|key| self.is_botched(key));
        match chosen.as_slice() {
            _ if readable.is_empty() => None,
            [] if botched => None,
            [] if readable.iter().flat_map(|(_, r)| r).all(|i| i.known.spec.or_none) => None,
            [] => Some(lack_of_all(group, &readable, &labels)),
            [only] if labels.contains(&only.label.as_str()) => None,
            [only] => {
                let place = self.alternative_place(only);
                let reason = "the chosen models do not read it";
                let fix = format!("write {} instead", any_of(&labels));
                self.faults.push(Problem::new(place, only.label.as_str(), reason, fix));
                None
            }
            several => {
                self.conflict(several);
                None
            }
        }
    }

    /// Reports several given alternatives at the last of them, and names the others.
    fn conflict(&mut self, chosen: &[&Alternative]) {
        let mut placed: Vec<(Place, &str)> =
            chosen.iter().map(|a| (self.alternative_place(a), a.label.as_str())).collect();
        placed.sort();
        let Some(((place, label), others)) = placed.split_last() else { return };
        let others_given = others.iter().map(|(place, label)| format!("`{label}` at {place}"));
        let reason = format!("excludes {}", all_of(&others_given.collect::<Vec<_>>()));
        let names: Vec<&str> = placed.iter().map(|(_, label)| *label).collect();
        let fix = format!("keep exactly one of {}", all_of(&names));
        self.faults.push(Problem::new(place.clone(), *label, reason, fix));
    }

    /// Returns the place of an alternative: its option, or its key or section in the file.
    fn alternative_place(&self, alternative: &Alternative) -> Place {
        let given = alternative.members.iter().filter_map(|key| self.scope.case.tree.find(key));
        let is_set = |node: &&Node| matches!(node.origin, Origin::Argument(_));
        match given.max_by_key(is_set) {
            Some(node) if alternative.members.len() == 1 || is_set(&node) => {
                self.scope.case.key_place(node)
            }
            _ => self.scope.case.section_place(&alternative.label),
        }
    }

    /// Checks groups of keys of which all or none must be given.
    fn together(&mut self, active: &[Instance<'_>]) {
        let mut words: BTreeMap<(&str, &str), Vec<&Instance<'_>>> = BTreeMap::new();
        for instance in active {
            if let Some(word) = &instance.known.spec.together {
                words.entry((word, &instance.binding)).or_default().push(instance);
            }
        }
        for members in words.into_values() {
            let Some(given) = members.iter().find(|i| self.given(&i.path)) else { continue };
            let lacking: Vec<_> = members
                .iter()
                .filter(|i| i.known.spec.default.is_none() && !self.given(&i.path))
                .collect();
            for instance in lacking {
                let what = &instance.path;
                let reason = format!("missing; `{}` is given, and they go together", given.path);
                let add = example(&instance.known.spec, instance.known.shape);
                let fix = format!("add `{what} = {add}`, or remove `{}`", given.path);
                self.faults.at(what, reason, fix);
            }
        }
    }
}

fn lack(wanted: &MissingKey<'_>) -> MissingPart {
    let path = &wanted.instance.path;
    let known = wanted.instance.known;
    let name = path.rsplit('.').next().unwrap_or(path);
    let (owner, verb) = owners_verb(wanted.owners.iter().copied());
    MissingPart {
        key: path.clone(),
        reason: format!("missing; {owner} {verb} the {}", known.spec.help),
        add: format!("`{name} = {}`", example(&known.spec, known.shape)),
    }
}

/// Describes a group of which no alternative is given.
fn lack_of_all(
    group: &Group,
    readable: &[(&Alternative, Vec<&Instance<'_>>)],
    labels: &[&str],
) -> MissingPart {
    let owners = readable.iter().flat_map(|(_, readers)| readers).map(|i| i.known.owner);
    let (owner, verb) = owners_verb(owners);
    let short = |label: &str| match group.section.as_str() {
        "" => label.to_owned(),
        section => label[section.len() + 1..].to_owned(),
    };
    let examples: Vec<String> = readable
        .iter()
        .map(|(alternative, readers)| {
            write_example(&short(&alternative.label), alternative, readers)
        })
        .collect();
    let key = if group.section.is_empty() { labels.join(" | ") } else { group.section.clone() };
    let reason = format!("missing; {owner} {verb} exactly one of {}", any_of(labels));
    let add = if examples.len() > 1 { "one of " } else { "" };
    MissingPart { key, reason, add: format!("{add}{}", any_of(&examples)) }
}

/// Returns owners and verb, such as ("mech and thermal", "need").
fn owners_verb<'a>(owners: impl Iterator<Item = &'a str>) -> (String, &'static str) {
    let mut names: Vec<&str> = Vec::new();
    for owner in owners {
        if !names.contains(&owner) {
            names.push(owner);
        }
    }
    (all_of(&names), if names.len() > 1 { "need" } else { "needs" })
}

/// Writes the keys of an alternative that have no default: "`creepage = { xi = 0.5 }`".
fn write_example(label: &str, alternative: &Alternative, read: &[&Instance<'_>]) -> String {
    let value = |i: &Instance<'_>| example(&i.known.spec, i.known.shape);
    if let ([_], [instance, ..]) = (alternative.members.as_slice(), read) {
        return format!("`{label} = {}`", value(instance));
    }
    let mut entries: Vec<String> = Vec::new();
    for instance in read.iter().filter(|i| i.known.spec.default.is_none()) {
        let skip = alternative.label.len() + 1;
        let entry = format!("{} = {}", &instance.path[skip..], value(instance));
        if !entries.contains(&entry) {
            entries.push(entry);
        }
    }
    format!("`{label} = {{ {} }}`", entries.join(", "))
}
