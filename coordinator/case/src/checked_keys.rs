//! First step of a validation: each key is checked by itself. It must be known, and its value must
//! fit.

use super::check::{Fault, check};
use super::diagnostics::Problem;
use super::known::{COORDINATOR, KnownKey, all_keys, leads_to, readers};
use super::raw::RawCase;
use super::schema::{ON_FAILURE, SECTIONS};
use super::selection::{SelectedParticipant, Selection};
use super::settings::TimeMode;
use super::tree::{Node, Table, Value};
use contract::description::{Description, KeyKind, KeySpec, matches};
use contract::field::FieldKind;
use contract::params::Params;
use contract::suggest::{all_of, any_of, nearest};
use contract::table::Table as DataTable;
use contract::text::check_line;
use serde_json::{Map, Value as Json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

/// Maximum number of names listed in a fix.
const MOST_NAMES: usize = 12;

/// Entries of a live value: its first value and its limits.
pub(super) const LIVE_ENTRIES: [&str; 3] = ["at", "from", "to"];

/// A case, and the descriptions against which it is checked.
#[derive(Clone, Copy)]
pub(super) struct Scope<'a> {
    pub(super) case: &'a RawCase,
    pub(super) selection: &'a Selection<'a>,
    pub(super) known: &'a [KnownKey<'a>],
    /// Descriptions of the default programs of roles that another program plays.
    pub(super) swapped: &'a [(String, Arc<Description>)],
    /// Whether the participants were asked for their keys. If not, their keys are not checked.
    pub(super) asked: bool,
}

impl<'a> Scope<'a> {
    /// Returns the keys that match a dotted key.
    pub(super) fn readers(&self, key: &str) -> Vec<&'a KnownKey<'a>> {
        readers(self.known, key)
    }

    /// Returns whether the default program of a role that another program plays reads such a key.
    fn is_read_by_swapped(&self, reads: impl Fn(&KeySpec) -> bool) -> bool {
        self.swapped.iter().any(|(_, description)| all_keys(description).any(&reads))
    }

    /// Returns whether a table may stand at this key.
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
            || self.is_read_by_swapped(|spec| leads_to(key, &spec.path))
    }

    /// Returns the present spelling of a key from an earlier version.
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

    /// Formats an effect with its participants: "friction_heat (mech, thermal)".
    fn offer(&self, effect: &str) -> String {
        let roles: Vec<&str> = self.selection.claimants(effect).map(|(p, _)| p.role).collect();
        format!("{effect} ({})", roles.join(", "))
    }

    /// Returns the names allowed in a section.
    fn siblings(&self, section: &str) -> Vec<String> {
        let depth = if section.is_empty() { 0 } else { section.split('.').count() };
        let paths = self.known.iter().map(|k| k.spec.path.as_str());
        let paths = paths.filter(|path| section.is_empty() || leads_to(section, path));
        let names: BTreeSet<&str> =
            paths.filter_map(|p| p.split('.').nth(depth)).filter(|n| *n != "*").collect();
        names.into_iter().map(str::to_owned).collect()
    }

    /// Returns a known key of this name in another section.
    fn elsewhere(&self, name: &str) -> Option<String> {
        let mut paths = self.known.iter().map(|k| &k.spec.path).filter(|p| !p.contains('*'));
        let found = paths.find(|p| p.rsplit_once('.').is_some_and(|(_, last)| last == name));
        found.filter(|path| !matches(path, name)).cloned()
    }
}

/// The errors found so far, each with its place in the case.
pub(super) struct Faults<'a> {
    case: &'a RawCase,
    list: Vec<Problem>,
}

impl<'a> Faults<'a> {
    fn new(case: &'a RawCase) -> Self {
        Self { case, list: Vec::new() }
    }

    pub(super) fn push(&mut self, problem: Problem) {
        self.list.push(problem);
    }

    /// Adds an error at a key: at its value, or at its section.
    pub(super) fn at(&mut self, key: &str, reason: impl Into<String>, fix: impl Into<String>) {
        self.push(self.case.problem_at(key, reason, fix));
    }

    /// Adds an error at the name of a key.
    pub(super) fn at_name(&mut self, node: &Node, key: &str, reason: String, fix: String) {
        self.push(Problem::new(self.case.key_place(node), key, reason, fix));
    }

    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    /// Returns the errors in the order in which they were found.
    pub(super) fn into_list(self) -> Vec<Problem> {
        self.list
    }
}

/// The columns of a table that a case refers to.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    /// The file and its table. An unusable table is `None`, and is reported once.
    pub(super) table: Option<(PathBuf, Option<DataTable>)>,
    /// Values in SI units by key, in the order of the rows.
    pub(super) values: BTreeMap<String, Vec<f64>>,
    /// Names of the columns by key.
    pub(super) names: BTreeMap<String, String>,
    /// Whether a key refers to a column that could not be read.
    pub(super) incomplete: bool,
}

/// A key whose value is set from outside during the run.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveKey {
    /// The field that carries the value; its name is the dotted key.
    pub field: FieldKind,
    /// First value, in SI units.
    pub first: f64,
    /// Lower and upper limit, in SI units.
    pub limits: [f64; 2],
}

/// All keys of a case, each checked by itself.
pub(super) struct CheckedKeys<'a> {
    pub(super) scope: Scope<'a>,
    /// The accepted values, in SI units.
    pub(super) values: Params,
    /// The columns of tables that keys refer to.
    pub(super) columns: Columns,
    /// Values that are set from outside, by key.
    pub(super) live: BTreeMap<String, LiveKey>,
    /// Probable targets of misspelt keys. They are not reported as missing as well.
    pub(super) meant: Vec<String>,
    /// Keys and sections that were not checked because no participant was asked.
    pub(super) not_judged: Vec<String>,
    pub(super) faults: Faults<'a>,
}

impl<'a> CheckedKeys<'a> {
    /// Checks every key of the case.
    pub(super) fn read(scope: Scope<'a>) -> Self {
        let mut written = Self {
            scope,
            values: Params(Json::Object(Map::new())),
            columns: Columns::default(),
            live: BTreeMap::new(),
            meant: Vec::new(),
            not_judged: Vec::new(),
            faults: Faults::new(scope.case),
        };
        written.walk(&scope.case.tree, "");
        written
    }

    /// Checks every key of a table, whose dotted key is `path`.
    fn walk(&mut self, table: &Table, path: &str) {
        for (name, node) in &table.entries {
            let key = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
            if name.is_empty() || name.contains('.') {
                let reason = "a name must not be empty or contain a dot".to_owned();
                self.faults.at_name(node, &key, reason, name_fix(name));
                continue;
            }
            if let Err(reason) = check_line("the name", name) {
                self.faults.at_name(node, &key, reason, "write a plain name".to_owned());
                continue;
            }
            let readers = self.scope.readers(&key);
            match node.table() {
                Some(table) if self.scope.is_section(&key) => self.walk(table, &key),
                None if readers.is_empty() && self.scope.is_section(&key) => {
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

    fn leaf(&mut self, key: &str, node: &Node, readers: &[&KnownKey<'_>]) {
        // A participant may read a time as well, but only where the coordinator reads it.
        if readers.iter().any(|r| r.owner == COORDINATOR && !r.active) && key.starts_with("time.") {
            let reason = format!("has no meaning in a {} case", self.scope.selection.timing.word());
            let own = if key == ON_FAILURE { TimeMode::Sequence } else { TimeMode::Transient };
            let fix = format!("remove it, or write `time.mode = \"{}\"`", own.word());
            return self.faults.at_name(node, key, reason, fix);
        }
        let folder = self.scope.case.folder().to_owned();
        let checked = |active| {
            let of = readers.iter().filter(move |r| r.active == active);
            of.map(|r| check(r, node, &folder)).collect::<Vec<_>>()
        };
        let results = checked(true);
        let faults: Vec<&Fault> = results.iter().filter_map(|r| r.as_ref().err()).collect();
        // No participant reads the key now: the value must suit one participant that could read it.
        let idle = if results.is_empty() { checked(false) } else { Vec::new() };
        let value = results.iter().chain(&idle).find_map(|r| r.as_ref().ok());
        let refused =
            idle.iter().filter_map(|r| r.as_ref().err()).take(usize::from(value.is_none()));
        for fault in faults.into_iter().chain(refused) {
            self.faults.at(key, fault.reason.clone(), fault.fix.clone());
        }
        if let Some(value) = value {
            put(&mut self.values.0, key, value.clone());
        }
    }

    fn not_a_section(&mut self, key: &str, node: &Node) {
        let effect = key.starts_with("effects.");
        let fix = match &node.value {
            Value::Flag(false) if effect => {
                "remove it: an effect without a table is off".to_owned()
            }
            _ => format!("write it as a section: [{key}]"),
        };
        self.faults.at(key, format!("is {}, not a table", node.value.describe()), fix);
    }

    fn unknown(&mut self, key: &str, node: &Node) {
        if !self.scope.asked && !is_own(key) {
            return self.not_judged.push(key.to_owned());
        }
        if let Some(to) = self.scope.renamed(key) {
            let reason = "is a name from an earlier version".to_owned();
            return self.faults.at_name(node, key, reason, format!("write {to}"));
        }
        let (section, name) = key.rsplit_once('.').unwrap_or(("", key));
        if section == "effects" {
            return self.unknown_effect(key, name, node);
        }
        if self.scope.is_read_by_swapped(|spec| spec.is_of(key)) {
            return;
        }
        let kind = if section.is_empty() && node.table().is_some() { "section" } else { "key" };
        let siblings = self.scope.siblings(section);
        let at =
            |name: &str| if section.is_empty() { name.into() } else { format!("{section}.{name}") };
        let near = nearest(name, siblings.iter().map(String::as_str)).map(at);
        self.meant.extend(near.clone());
        let fix = match near.or_else(|| self.scope.elsewhere(name)) {
            Some(near) if kind == "section" => format!("write [{near}]"),
            Some(near) => format!("write `{near}`"),
            None => self.scope.remove_or_pick(key, kind, &siblings),
        };
        let reason = match node.table() {
            Some(table) if kind == "section" && is_role(table) => {
                "unknown section: no participant has this name".to_owned()
            }
            _ => {
                format!("unknown {kind}; not read by {}", all_of(&self.scope.selection.asked()))
            }
        };
        self.faults.at_name(node, key, reason, fix);
    }

    fn unknown_effect(&mut self, key: &str, name: &str, node: &Node) {
        let players = &self.scope.selection.players;
        let offers = |p: &SelectedParticipant<'_>| {
            p.description.effects.iter().map(|e| e.name.clone()).collect::<Vec<_>>()
        };
        let names: BTreeSet<String> = players.iter().flat_map(offers).collect();
        let near = nearest(name, names.iter().map(String::as_str));
        let hint = near.map(|n| format!("; did you mean `{n}`?")).unwrap_or_default();
        let listed: Vec<String> = names.iter().map(|n| self.scope.offer(n)).collect();
        let fix = match near {
            Some(near) => format!("write [effects.{near}]; available effects: {}", all_of(&listed)),
            None if listed.is_empty() => "remove it: no participant offers effects".to_owned(),
            None => format!("remove it; available effects: {}", all_of(&listed)),
        };
        self.faults.at_name(node, key, format!("unknown effect `{name}`{hint}"), fix);
    }
}

/// Returns whether the key is in a section of the coordinator. Keys of effects belong to
/// participants.
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

/// Returns whether the table at a key is a live value.
fn is_live(table: &Table) -> bool {
    LIVE_ENTRIES.iter().any(|entry| table.get(entry).is_some())
}

/// Puts a value at a dotted key, and creates the objects on the way.
pub(super) fn put(values: &mut Json, key: &str, value: Json) {
    let mut at = values;
    for part in key.split('.') {
        if !at.is_object() {
            *at = Json::Object(Map::new());
        }
        at = &mut at[part];
    }
    *at = value;
}
