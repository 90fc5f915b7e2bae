//! Known keys, and the keys that are active in a case.
//!
//! A key is *known* if the coordinator, or a model or effect of any described participant, reads
//! it. It is *active* if the chosen models and active effects of the needed participants read it.
//! Only active keys are required and have defaults. A known key that is not active may stand in the
//! case: users keep the keys of other models when they switch models with `--set`.

use super::schema::{DISTANCE, ON_FAILURE, ROLE, Shape, TIME, own_keys};
use super::selection::{SelectedParticipant, Selection};
use super::settings::TimeMode;
use super::tree::{Node, Origin, Table};
use contract::description::{Description, KeyKind, KeySpec};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

/// Owner of the coordinator's own keys.
pub(super) const COORDINATOR: &str = "the coordinator";

/// A key that the coordinator or a participant reads.
#[derive(Clone, Debug)]
pub(super) struct KnownKey<'a> {
    pub(super) spec: Cow<'a, KeySpec>,
    pub(super) shape: Shape,
    pub(super) owner: &'a str,
    /// A condition under which the owner reads the key: a model as `mech.model = "half-space"`, an
    /// effect, or its section.
    pub(super) reader: Rc<str>,
    pub(super) active: bool,
}

/// A known key with names substituted for its `*`.
#[derive(Clone, Debug)]
pub(super) struct Instance<'a> {
    pub(super) known: &'a KnownKey<'a>,
    /// Dotted key.
    pub(super) path: String,
    /// The names substituted for `*`, each followed by a dot.
    pub(super) binding: String,
}

/// Lists all known keys.
pub(super) fn known_keys<'a>(
    selection: &Selection<'a>,
    extra_roles: &[String],
) -> Vec<KnownKey<'a>> {
    let mut keys = Vec::new();
    let reader: Rc<str> = COORDINATOR.into();
    let described = selection.players.iter().map(|p| (p.role, Some(p)));
    let others = extra_roles.iter().map(|role| (role.as_str(), None));
    let roles: Vec<_> = described.chain(others).collect();
    for own in own_keys() {
        let known = |spec, active| {
            let (owner, reader) = (COORDINATOR, Rc::clone(&reader));
            KnownKey { spec, shape: own.shape, owner, reader, active }
        };
        match own.spec.path.strip_prefix(ROLE) {
            Some(rest) => keys.extend(roles.iter().map(|(role, player)| {
                let needed = player.is_some_and(|p| p.needed);
                known(Cow::Owned(for_role(&own.spec, role, rest, *player)), needed)
            })),
            None => {
                let path = own.spec.path.as_str();
                let active = is_active(path, selection.timing);
                let spec = match path {
                    "time.window" | "time.end" => Cow::Owned(own.spec.clone().required()),
                    _ => Cow::Borrowed(&own.spec),
                };
                keys.push(known(spec, active));
            }
        }
    }
    for player in &selection.players {
        add_player(&mut keys, player, &selection.effects);
    }
    keys
}

/// Returns whether a case of this mode reads the coordinator's key.
fn is_active(path: &str, timing: TimeMode) -> bool {
    match path {
        TIME | DISTANCE => timing != TimeMode::Steady,
        ON_FAILURE => timing == TimeMode::Sequence,
        "time.mode" => true,
        _ => !path.starts_with("time.") || timing == TimeMode::Transient,
    }
}

/// Returns the coordinator's key for one role. A model must be one of the described models.
fn for_role(
    spec: &KeySpec,
    role: &str,
    rest: &str,
    player: Option<&SelectedParticipant<'_>>,
) -> KeySpec {
    let mut spec = KeySpec { path: format!("{role}{rest}"), ..spec.clone() };
    if let (".model", Some(player)) = (rest, player) {
        let of = player.description.models.iter().map(|m| m.name.clone()).collect();
        spec.kind = KeyKind::Choice { of };
    }
    spec
}

fn add_player<'a>(
    keys: &mut Vec<KnownKey<'a>>,
    player: &SelectedParticipant<'a>,
    effects: &[String],
) {
    let role = player.role;
    let whole: Rc<str> = match player.present {
        true => format!("an effect of {role}").into(),
        false => format!("[{role}]").into(),
    };
    let known = |spec: &'a KeySpec, reader: &Rc<str>, chosen: bool| KnownKey {
        spec: Cow::Borrowed(spec),
        shape: if spec.list { Shape::OneOrList } else { Shape::One },
        owner: role,
        reader: Rc::clone(if chosen { &whole } else { reader }),
        active: chosen && player.needed,
    };
    keys.extend(player.description.keys.iter().map(|spec| known(spec, &whole, true)));
    // If the case names an unknown model, its keys are checked against the first model.
    let standing = player.model.or(player.description.models.first());
    for model in &player.description.models {
        let chosen = standing.is_some_and(|m| m.name == model.name);
        let reader = format!("{role}.model = \"{}\"", model.name).into();
        keys.extend(model.keys.iter().map(|spec| known(spec, &reader, chosen)));
    }
    for effect in &player.description.effects {
        let active = effects.contains(&effect.name);
        let reader = format!("[effects.{}]", effect.name).into();
        keys.extend(effect.keys.iter().map(|spec| known(spec, &reader, active)));
    }
}

/// Returns the keys that a participant reads with a model and these effects.
pub(super) fn read_by<'a>(
    description: &'a Description,
    model: &str,
    effects: &[String],
) -> Vec<KnownKey<'a>> {
    let player = SelectedParticipant {
        role: &description.role,
        description,
        present: true,
        needed: true,
        model: description.models.iter().find(|m| m.name == model),
    };
    let mut keys = Vec::new();
    add_player(&mut keys, &player, effects);
    keys.retain(|key| key.active);
    keys
}

/// Returns the known keys that match a dotted key.
pub(super) fn readers<'k, 'a>(known: &'k [KnownKey<'a>], key: &str) -> Vec<&'k KnownKey<'a>> {
    known.iter().filter(|k| k.spec.is_of(key)).collect()
}

/// Iterates over the keys of a program with all of its models and effects.
pub(super) fn all_keys(description: &Description) -> impl Iterator<Item = &KeySpec> {
    let models = description.models.iter().flat_map(|model| &model.keys);
    let effects = description.effects.iter().flat_map(|effect| &effect.keys);
    description.keys.iter().chain(models).chain(effects)
}

/// Returns whether a dotted key is a section above a path with `*`.
pub(super) fn leads_to(key: &str, pattern: &str) -> bool {
    let mut pattern = pattern.split('.');
    let leads =
        key.split('.').all(|name| pattern.next().is_some_and(|part| part == "*" || part == name));
    leads && pattern.next().is_some()
}

/// Expands a path with `*` to keys, each with the names substituted for `*`.
pub(super) fn expand(pattern: &str, names: impl Fn(&str) -> Vec<String>) -> Vec<(String, String)> {
    let mut found = vec![(String::new(), String::new())];
    for part in pattern.split('.') {
        let step = |(path, binding): (String, String)| {
            let at =
                |name: &str| if path.is_empty() { name.into() } else { format!("{path}.{name}") };
            if part == "*" {
                let each = |name: String| (at(&name), format!("{binding}{name}."));
                names(&path).into_iter().map(each).collect::<Vec<_>>()
            } else {
                vec![(at(part), binding)]
            }
        };
        found = found.into_iter().flat_map(step).collect();
    }
    found
}

/// Names to which the values of `name_in` keys refer, by table.
pub(super) type References = BTreeMap<String, Vec<String>>;

/// Expands the keys that are read. Of a table with referenced names, only the referenced entries
/// are read.
pub(super) fn instances<'a>(
    keys: impl IntoIterator<Item = &'a KnownKey<'a>>,
    tree: &Table,
    references: &References,
) -> Vec<Instance<'a>> {
    let names = |table: &str| match references.get(table) {
        Some(referred) => {
            let there = tree.names(table);
            referred.iter().filter(|name| there.contains(name)).cloned().collect()
        }
        None => tree.names(table),
    };
    let each = |known: &'a KnownKey<'a>| {
        let expanded = expand(&known.spec.path, names);
        expanded.into_iter().map(move |(path, binding)| Instance { known, path, binding })
    };
    keys.into_iter().flat_map(each).collect()
}

/// The keys of one case, with names substituted for `*`.
pub(super) struct Keys<'a> {
    /// Names to which active `name_in` keys refer.
    pub(super) references: References,
    /// Keys that are known, independent of the choices of the case.
    pub(super) all: Vec<Instance<'a>>,
    /// Keys that are active in this case.
    pub(super) active: Vec<Instance<'a>>,
}

impl<'a> Keys<'a> {
    /// Expands the known keys for a case.
    pub(super) fn of(known: &'a [KnownKey<'a>], tree: &Table) -> Self {
        let references = refer(known, tree);
        let all = instances(known, tree, &references);
        let active = all.iter().filter(|instance| instance.known.active).cloned().collect();
        Self { references, all, active }
    }
}

/// Collects the names to which active `name_in` keys refer, by value or by default.
fn refer(known: &[KnownKey<'_>], tree: &Table) -> References {
    let mut references = References::new();
    for known in known {
        let KeyKind::NameIn { table } = &known.spec.kind else { continue };
        let names = references.entry(table.clone()).or_default();
        if !known.active {
            continue;
        }
        let default = known.spec.default.as_ref().and_then(serde_json::Value::as_str);
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
    references
}

/// A key of the case that has no effect.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unread {
    /// Dotted path of the key.
    pub key: String,
    /// Conditions under which the key is read, as `mech.model = "half-space"`. Empty for an entry
    /// of a table, such as a material, to which no key refers.
    pub readers: Vec<String>,
    /// Whether the key is an unread property in a table of named entries, such as materials, where
    /// such properties are usual. False for a key set by an option.
    pub is_usual: bool,
}

/// All keys that a case can have, used to decide whether a key is read.
pub(super) struct Readers<'a> {
    pub(super) known: &'a [KnownKey<'a>],
    pub(super) references: &'a References,
    /// Descriptions of the default programs of roles that another program plays.
    pub(super) swapped: &'a [(String, Arc<Description>)],
}

impl Readers<'_> {
    /// Finds every key of a case that neither the chosen models nor the active effects read.
    pub(super) fn unread(&self, tree: &Table) -> Vec<Unread> {
        let mut found = Vec::new();
        self.find_unread(tree, "", &mut found);
        found
    }

    fn find_unread(&self, table: &Table, path: &str, found: &mut Vec<Unread>) {
        for (name, node) in &table.entries {
            let key = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
            match node.table() {
                Some(table) if readers(self.known, &key).is_empty() => {
                    self.find_unread(table, &key, found);
                }
                _ => found.extend(self.judge_unread(key, node)),
            }
        }
    }

    fn judge_unread(&self, key: String, node: &Node) -> Option<Unread> {
        let readers = readers(self.known, &key);
        // The coordinator has already read its own keys.
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
            let reads = |(_, description): &&(String, Arc<Description>)| {
                all_keys(description).any(|spec| spec.is_of(&key))
            };
            let usual = self.swapped.iter().filter(reads);
            words.extend(usual.map(|(role, of)| format!("{} as {role}", of.name)));
        }
        words.dedup();
        Some(Unread { key, readers: words, is_usual })
    }
}
