//! The state that all checks of a case share.

use super::diagnostics::Problem;
use super::known::{Instance, Known, References, all_keys, expand};
use super::live_key::LiveKey;
use super::raw::RawCase;
use super::selection::Selection;
use super::tree::Node;
use contract::description::{Description, KeyKind, KeySpec};
use contract::params::Params;
use contract::table::Table as DataTable;
use serde_json::{Map, Value as Json};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The columns of a table that a case refers to.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    /// The file, and its table unless it is unusable, which is reported once.
    pub(super) table: Option<(PathBuf, Option<DataTable>)>,
    /// Values in SI units by key, in the order of the rows.
    pub(super) values: BTreeMap<String, Vec<f64>>,
    /// Names of the columns by key.
    pub(super) names: BTreeMap<String, String>,
    /// A key refers to a column that could not be read.
    pub(super) incomplete: bool,
}

/// A case under check: what it says, what is known, and what has been found.
pub(super) struct Checker<'a> {
    pub(super) case: &'a RawCase,
    pub(super) selection: &'a Selection<'a>,
    pub(super) known: &'a [Known<'a>],
    /// Names that active `name_in` keys refer to.
    pub(super) references: References,
    /// Checked values in SI units.
    pub(super) values: Params,
    /// Keys that misspelt ones were probably meant to be; they are not missing as well.
    pub(super) meant: Vec<String>,
    /// What the usual programs say of themselves whose roles others play.
    pub(super) replaced: &'a [(String, Description)],
    /// The columns of tables that keys refer to.
    pub(super) columns: Columns,
    /// Values that are given from outside, by key.
    pub(super) live: BTreeMap<String, LiveKey>,
    pub(super) problems: Vec<Problem>,
    /// No participant was asked: what the coordinator does not know itself is not judged.
    pub(super) unasked: bool,
    /// Keys and sections that were not judged.
    pub(super) not_judged: Vec<String>,
}

impl<'a> Checker<'a> {
    pub(super) fn new(
        case: &'a RawCase,
        selection: &'a Selection<'a>,
        known: &'a [Known<'a>],
        replaced: &'a [(String, Description)],
    ) -> Self {
        Self {
            case,
            selection,
            known,
            references: References::new(),
            values: Params(Json::Object(Map::new())),
            meant: Vec::new(),
            replaced,
            columns: Columns::default(),
            live: BTreeMap::new(),
            problems: Vec::new(),
            unasked: false,
            not_judged: Vec::new(),
        }
    }

    /// Notes an error at a key: at its value, or its section.
    pub(super) fn fault(&mut self, key: &str, reason: impl Into<String>, fix: impl Into<String>) {
        self.problems.push(self.case.problem_at(key, reason, fix));
    }

    /// Notes an error at the name of a key.
    pub(super) fn fault_at_name(&mut self, node: &Node, key: &str, reason: String, fix: String) {
        self.problems.push(Problem::new(self.case.key_place(node), key, reason, fix));
    }

    /// The keys that read a dotted key.
    pub(super) fn readers(&self, key: &str) -> Vec<&'a Known<'a>> {
        self.known.iter().filter(|k| k.spec.is_of(key)).collect()
    }

    /// The usual program of a role, in the place of which another one runs, reads such a key.
    pub(super) fn is_read_by_replaced(&self, reads: impl Fn(&KeySpec) -> bool) -> bool {
        self.replaced.iter().any(|(_, description)| all_keys(description).any(&reads))
    }

    /// Collects the names that active `name_in` keys refer to, by value or by default.
    pub(super) fn refer(&mut self) {
        let tree = &self.case.tree;
        for known in self.known {
            let KeyKind::NameIn { table } = &known.spec.kind else { continue };
            let names = self.references.entry(table.clone()).or_default();
            if !known.active {
                continue;
            }
            let default = known.spec.default.as_ref().and_then(Json::as_str);
            for (key, _) in expand(&known.spec.path, |section| tree.names(section)) {
                let name = match tree.find(&key) {
                    Some(_) => tree.text(&key),
                    None => default,
                };
                if let Some(name) = name.filter(|name| !names.iter().any(|n| n == name)) {
                    names.push(name.to_owned());
                }
            }
        }
    }
}

/// Puts a value at a dotted key, in objects that are made as needed.
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

/// Fills in the defaults of keys that have no value; of alternatives, only those of the given one.
pub(super) fn fill_defaults(values: &mut Params, active: &[Instance<'_>]) {
    let groups = super::groups::groups(active);
    for instance in active {
        let Some(default) = &instance.known.spec.default else { continue };
        let group = groups.iter().find_map(|group| group.alternative_of(&instance.path));
        let chosen = group.is_none_or(|a| a.members.iter().any(|key| values.has(key)));
        if chosen && !values.has(&instance.path) {
            let quantity = matches!(instance.known.spec.kind, KeyKind::Quantity { .. });
            let number = default.as_f64().filter(|_| quantity).map(Json::from);
            put(&mut values.0, &instance.path, number.unwrap_or_else(|| default.clone()));
        }
    }
}
