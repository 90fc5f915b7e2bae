//! Keys of a case and their descriptions.

use case::schema::{OwnKey, ROLE, Shape, own_keys};
use contract::description::{Description, KeyKind, KeySpec};
use serde::Serialize;

/// A key, and all readers that describe it alike.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Key {
    #[serde(flatten)]
    /// Description by its reader.
    pub spec: KeySpec,
    /// The key takes a list of values.
    pub list: bool,
    /// Readers: the coordinator, roles, models or effects.
    pub read_by: Vec<String>,
}

/// Reader of the coordinator's own keys.
const COORDINATOR: &str = "the coordinator";

/// Returns all keys by sections: first those of every case, then those of participants.
pub fn all(described: &[Description]) -> Vec<Key> {
    let mut keys: Vec<Key> = Vec::new();
    let mut add = |spec: &KeySpec, shape: Shape, reader: String| {
        let list = shape != Shape::One || spec.list;
        let spec = KeySpec { list: false, ..spec.clone() };
        match keys.iter_mut().find(|key| key.spec == spec && key.list == list) {
            Some(key) if key.read_by.contains(&reader) => {}
            Some(key) => key.read_by.push(reader),
            None => keys.push(Key { spec, list, read_by: vec![reader] }),
        }
    };
    for OwnKey { spec, shape } in own_keys() {
        add(spec, *shape, COORDINATOR.to_owned());
    }
    for Description { role, keys, models, effects, .. } in described {
        keys.iter().for_each(|spec| add(spec, Shape::One, role.clone()));
        for model in models {
            let reader = format!("{role} {}", model.name);
            model.keys.iter().for_each(|spec| add(spec, Shape::One, reader.clone()));
        }
        for effect in effects {
            let reader = format!("effect {}", effect.name);
            effect.keys.iter().for_each(|spec| add(spec, Shape::One, reader.clone()));
        }
    }
    let order: Vec<String> = keys.iter().map(|key| section(key).to_owned()).collect();
    let place = |key: &Key| order.iter().position(|other| other == section(key));
    keys.sort_by(|a, b| (place(a), &a.spec.path).cmp(&(place(b), &b.spec.path)));
    keys
}

/// Returns the section of the case in which a key stands.
#[must_use]
pub fn section(key: &Key) -> &str {
    key.spec.path.split('.').next().unwrap_or_default()
}

/// Returns the type, the unit or the choices of a key.
pub fn kind(key: &Key) -> String {
    let one = match &key.spec.kind {
        KeyKind::Quantity { unit } if unit == "1" => "number".to_owned(),
        KeyKind::Quantity { unit } => unit.clone(),
        KeyKind::Integer => "integer".to_owned(),
        KeyKind::Flag => "true or false".to_owned(),
        KeyKind::Choice { of } => of.join(" | "),
        KeyKind::Text => "text".to_owned(),
        KeyKind::File => "file".to_owned(),
        KeyKind::NameIn { table } => format!("name in [{table}]"),
    };
    if key.list { format!("list of {one}") } else { one }
}

/// Returns the bounds of a number.
pub fn range(spec: &KeySpec) -> String {
    let bounds = [(">", spec.above), ("≥", spec.at_least), ("≤", spec.at_most)];
    let bounds = bounds.iter().filter_map(|(sign, bound)| {
        let bound = (*bound)?;
        Some(format!("{sign} {}", plain(bound)))
    });
    let below = spec.magnitude_below.join(" · ");
    let below = (!below.is_empty()).then(|| format!("|…| < {below}"));
    bounds.chain(below).collect::<Vec<_>>().join(", ")
}

/// Returns whether a key is required, its default and its alternatives.
pub fn need(spec: &KeySpec) -> String {
    let default = spec.default.as_ref().map(|value| match value.as_str() {
        Some(word) => format!("default {word}"),
        None => format!("default {}", value.as_f64().map_or(value.to_string(), plain)),
    });
    let group = match (&spec.one_of, spec.or_none) {
        (Some(group), false) => Some(format!("one of {group}")),
        (Some(group), true) => Some(format!("one of {group}, or none")),
        _ => None,
    };
    let required = (spec.required && spec.one_of.is_none()).then(|| "required".to_owned());
    let together = spec.together.as_ref().map(|group| format!("together: {group}"));
    let varies = spec.varies.then(|| "may vary".to_owned());
    let all = [required, group, together, default, varies];
    all.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// Returns a number as a case would write it.
#[must_use]
pub fn plain(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e6).contains(&size) {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}

/// Returns type or unit, range, and whether the key is required.
pub fn facts(key: &Key) -> String {
    let facts = [kind(key), range(&key.spec), need(&key.spec)];
    let facts: Vec<String> = facts.into_iter().filter(|fact| !fact.is_empty()).collect();
    facts.join("; ")
}

/// Returns help and facts of a key by its dotted path. Models and effects that the case selects
/// come first. Unknown keys have none.
pub fn about(described: &[Description], case: &toml::Table) -> impl Fn(&str) -> Option<String> {
    let (reading, others): (Vec<Key>, Vec<Key>) =
        all(described).into_iter().partition(|key| key.read_by.iter().any(|by| reads(case, by)));
    move |path| {
        let mut keys = reading.iter().chain(&others);
        let key = keys.find(|key| fits(&key.spec.path, path))?;
        Some(format!("{} [{}]", key.spec.help, facts(key)))
    }
}

/// Returns true if the case uses a reader of [`Key::read_by`].
fn reads(case: &toml::Table, by: &str) -> bool {
    let has = |section: &str, name: &str| case.get(section).and_then(|table| table.get(name));
    match by.split_once(' ') {
        _ if by == COORDINATOR => true,
        Some(("effect", name)) => has("effects", name).is_some(),
        Some((role, model)) => has(role, "model").and_then(|name| name.as_str()) == Some(model),
        None => case.contains_key(by),
    }
}

/// Returns the help of keys by dotted path, or the path of an unknown key.
pub fn names<'a>(described: &[Description], paths: impl Iterator<Item = &'a str>) -> Vec<String> {
    let keys = all(described);
    let name = |path: &str| {
        let known = keys.iter().find(|key| fits(&key.spec.path, path));
        known.map_or(path, |key| key.spec.help.as_str()).to_owned()
    };
    paths.map(name).collect()
}

/// Returns SI units of keys by dotted path: "1" for a plain number, empty for other types and
/// unknown keys.
pub fn units<'a>(described: &[Description], paths: impl Iterator<Item = &'a str>) -> Vec<String> {
    let keys = all(described);
    let unit = |path: &str| match &keys.iter().find(|key| fits(&key.spec.path, path))?.spec.kind {
        KeyKind::Quantity { unit } => Some(unit.clone()),
        KeyKind::Integer => Some("1".to_owned()),
        _ => None,
    };
    paths.map(|path| unit(path).unwrap_or_default()).collect()
}

/// Returns true if a path fits a known key, in which `*` stands for any name.
fn fits(known: &str, path: &str) -> bool {
    let mut parts = (known.split('.'), path.split('.'));
    let alike = |(known, own): (&str, &str)| ["*", ROLE, own].contains(&known);
    parts.0.clone().count() == parts.1.clone().count()
        && std::iter::zip(&mut parts.0, &mut parts.1).all(alike)
}
