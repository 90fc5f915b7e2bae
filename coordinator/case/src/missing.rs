//! What the case lacks: required keys, alternatives of which none is given, incomplete groups.

use super::checker::Checker;
use super::diagnostics::{Place, Problem};
use super::example::example;
use super::groups::{Alternative, Group, groups};
use super::known::Instance;
use super::tree::{Node, Origin};
use contract::suggest::{all_of, any_of};
use std::collections::BTreeMap;

/// Something that a section lacks.
struct Lack {
    key: String,
    reason: String,
    /// What to add: `speed = "30 m/s"`.
    add: String,
}

/// A required key that is not there, and what needs it.
struct Wanted<'i> {
    instance: &'i Instance<'i>,
    owners: Vec<&'i str>,
}

impl Checker<'_> {
    /// Checks that nothing is missing; `all` and `active` are the keys known and read.
    pub(super) fn missing(&mut self, all: &[Instance<'_>], active: &[Instance<'_>]) {
        let groups = groups(all);
        let mut lacks: BTreeMap<String, Vec<Lack>> = BTreeMap::new();
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
        self.case.tree.find(key).is_some()
    }

    fn is_chosen(&self, alternative: &Alternative) -> bool {
        alternative.members.iter().any(|key| self.given(key))
    }

    /// It, or a section that holds it, is there under a wrong name or as no table: reported
    /// already.
    fn is_botched(&self, key: &str) -> bool {
        let holds = |section: &str| {
            key.strip_prefix(section).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        let no_table = |section: &str| {
            let node = self.case.tree.find(section).filter(|node| node.table().is_none());
            node.is_some() && self.readers(section).is_empty()
        };
        self.meant.iter().any(|meant| holds(meant))
            || key.match_indices('.').any(|(at, _)| no_table(&key[..at]))
    }

    /// Required keys that are not there, in order, each with all that need it.
    fn required<'i>(&self, active: &'i [Instance<'i>], groups: &[Group]) -> Vec<Wanted<'i>> {
        let mut found: Vec<Wanted<'i>> = Vec::new();
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
                None => found.push(Wanted { instance, owners: vec![owner] }),
            }
        }
        found
    }

    fn report_lacks(&mut self, section: &str, lacks: Vec<Lack>) {
        let place = self.case.section_place(section);
        let node = self.case.tree.find(section);
        if node.is_none() && !section.is_empty() {
            let add: Vec<&str> = lacks.iter().map(|lack| lack.add.as_str()).collect();
            let fix = format!("add [{section}] with {}", all_of(&add));
            let reason = format!("missing section [{section}]");
            self.problems.push(Problem::new(place, section, reason, fix));
            return;
        }
        for lack in lacks {
            let to = if section.is_empty() { String::new() } else { format!(" to [{section}]") };
            let fix = format!("add {}{to}", lack.add);
            self.problems.push(Problem::new(place.clone(), lack.key, lack.reason, fix));
        }
    }

    /// Checks that exactly one alternative is given; what is lacking if none is.
    fn alternatives(&mut self, group: &Group, active: &[Instance<'_>]) -> Option<Lack> {
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
                self.problems.push(Problem::new(place, only.label.as_str(), reason, fix));
                None
            }
            several => {
                self.conflict(several);
                None
            }
        }
    }

    /// Several alternatives are given: reported at the last of them, naming the others.
    fn conflict(&mut self, chosen: &[&Alternative]) {
        let mut placed: Vec<(Place, &str)> =
            chosen.iter().map(|a| (self.alternative_place(a), a.label.as_str())).collect();
        placed.sort();
        let Some(((place, label), others)) = placed.split_last() else { return };
        let others_given = others.iter().map(|(place, label)| format!("`{label}` at {place}"));
        let reason = format!("excludes {}", all_of(&others_given.collect::<Vec<_>>()));
        let names: Vec<&str> = placed.iter().map(|(_, label)| *label).collect();
        let fix = format!("keep exactly one of {}", all_of(&names));
        self.problems.push(Problem::new(place.clone(), *label, reason, fix));
    }

    /// Where an alternative is given: by an option, or at its key or section in the file.
    fn alternative_place(&self, alternative: &Alternative) -> Place {
        let given = alternative.members.iter().filter_map(|key| self.case.tree.find(key));
        let is_set = |node: &&Node| matches!(node.origin, Origin::Argument(_));
        match given.max_by_key(is_set) {
            Some(node) if alternative.members.len() == 1 || is_set(&node) => {
                self.case.key_place(node)
            }
            _ => self.case.section_place(&alternative.label),
        }
    }

    /// Checks groups of which all or none are given.
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
                self.fault(what, reason, fix);
            }
        }
    }
}

fn lack(wanted: &Wanted<'_>) -> Lack {
    let path = &wanted.instance.path;
    let known = wanted.instance.known;
    let name = path.rsplit('.').next().unwrap_or(path);
    let (owner, verb) = owners_verb(wanted.owners.iter().copied());
    Lack {
        key: path.clone(),
        reason: format!("missing; {owner} {verb} the {}", known.spec.help),
        add: format!("`{name} = {}`", example(&known.spec, known.shape)),
    }
}

/// None of a group is given.
fn lack_of_all(
    group: &Group,
    readable: &[(&Alternative, Vec<&Instance<'_>>)],
    labels: &[&str],
) -> Lack {
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
    Lack { key, reason, add: format!("{add}{}", any_of(&examples)) }
}

/// ("mech and thermal", "need").
fn owners_verb<'a>(owners: impl Iterator<Item = &'a str>) -> (String, &'static str) {
    let mut names: Vec<&str> = Vec::new();
    for owner in owners {
        if !names.contains(&owner) {
            names.push(owner);
        }
    }
    (all_of(&names), if names.len() > 1 { "need" } else { "needs" })
}

/// "`creepage = { xi = 0.5 }`": the keys of an alternative that have no default.
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
