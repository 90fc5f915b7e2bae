//! All keys that anybody reads, and those that this case makes somebody read.
//!
//! A key is *known* if the coordinator, a model or an effect of any described participant reads
//! it, and *active* if the chosen models and the active effects of the participants needed do.
//! Only active keys are required and have defaults. A known key that is not active may stand in
//! the case: users keep the keys of the other models when they switch models with `--set`.

use super::schema::{DISTANCE, ON_FAILURE, ROLE, Shape, TIME, own_keys};
use super::selection::{Player, Selection, TimingWord};
use super::tree::Table;
use contract::description::{Description, KeyKind, KeySpec};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Owner of the coordinator's own keys.
pub(super) const COORDINATOR: &str = "the coordinator";

/// A key that somebody reads.
#[derive(Clone, Debug)]
pub(super) struct Known<'a> {
    pub(super) spec: Cow<'a, KeySpec>,
    pub(super) shape: Shape,
    pub(super) owner: &'a str,
    /// What would make the owner read it: a model as `mech.model = "half-space"`, an effect, or its
    /// section.
    pub(super) reader: Rc<str>,
    pub(super) active: bool,
}

/// A known key with names in the place of its `*`.
#[derive(Clone, Debug)]
pub(super) struct Instance<'a> {
    pub(super) known: &'a Known<'a>,
    /// Dotted key.
    pub(super) path: String,
    /// The names in the place of its `*`, with a dot after each.
    pub(super) binding: String,
}

/// All keys that somebody reads.
pub(super) fn known_keys<'a>(selection: &Selection<'a>, extra_roles: &[String]) -> Vec<Known<'a>> {
    let mut keys = Vec::new();
    let reader: Rc<str> = COORDINATOR.into();
    let described = selection.players.iter().map(|p| (p.role, Some(p)));
    let others = extra_roles.iter().map(|role| (role.as_str(), None));
    let roles: Vec<_> = described.chain(others).collect();
    for own in own_keys() {
        let known = |spec, active| {
            let (owner, reader) = (COORDINATOR, Rc::clone(&reader));
            Known { spec, shape: own.shape, owner, reader, active }
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

/// The kind of case reads this own key.
fn is_active(path: &str, timing: TimingWord) -> bool {
    match path {
        TIME | DISTANCE => timing != TimingWord::Steady,
        ON_FAILURE => timing == TimingWord::Sequence,
        "time.mode" => true,
        _ => !path.starts_with("time.") || timing == TimingWord::Transient,
    }
}

/// An own key for one role; the model is one of those described.
fn for_role(spec: &KeySpec, role: &str, rest: &str, player: Option<&Player<'_>>) -> KeySpec {
    let mut spec = KeySpec { path: format!("{role}{rest}"), ..spec.clone() };
    if let (".model", Some(player)) = (rest, player) {
        let of = player.description.models.iter().map(|m| m.name.clone()).collect();
        spec.kind = KeyKind::Choice { of };
    }
    spec
}

fn add_player<'a>(keys: &mut Vec<Known<'a>>, player: &Player<'a>, effects: &[String]) {
    let role = player.role;
    let whole: Rc<str> = match player.present {
        true => format!("an effect of {role}").into(),
        false => format!("[{role}]").into(),
    };
    let known = |spec: &'a KeySpec, reader: &Rc<str>, chosen: bool| Known {
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

/// The keys that a description reads with a model and a choice of effects.
pub(super) fn read_by<'a>(
    description: &'a Description,
    model: &str,
    effects: &[String],
) -> Vec<Known<'a>> {
    let player = Player {
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

/// The keys that a program reads with one model and effect or another.
pub(super) fn all_keys(description: &Description) -> impl Iterator<Item = &KeySpec> {
    let models = description.models.iter().flat_map(|model| &model.keys);
    let effects = description.effects.iter().flat_map(|effect| &effect.keys);
    description.keys.iter().chain(models).chain(effects)
}

/// A dotted key is a section on the way to a path with `*`.
pub(super) fn leads_to(key: &str, pattern: &str) -> bool {
    let mut pattern = pattern.split('.');
    let leads =
        key.split('.').all(|name| pattern.next().is_some_and(|part| part == "*" || part == name));
    leads && pattern.next().is_some()
}

/// The keys that a path with `*` stands for, with the names that took the place of the `*`.
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

/// The names that the values of `name_in` keys refer to, by table.
pub(super) type References = BTreeMap<String, Vec<String>>;

/// The keys that are read: of a table whose names are referred to, only those that are.
pub(super) fn instances<'a>(
    keys: impl IntoIterator<Item = &'a Known<'a>>,
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
    let each = |known: &'a Known<'a>| {
        let expanded = expand(&known.spec.path, names);
        expanded.into_iter().map(move |(path, binding)| Instance { known, path, binding })
    };
    keys.into_iter().flat_map(each).collect()
}
