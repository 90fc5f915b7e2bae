//! The keys as JSON Schema (draft 7), for editors: what there is, its type and range, and what it means.
//!
//! A name that a user chooses, a body's or a material's, is any property; a table at the top that is none of
//! ours is a participant of another program, which names its command.

use case::schema::ROLE;
use console::keys::{Key, facts};
use contract::description::{Description, KeyKind};
use serde_json::{Map, Value, json};

/// The schema of a case.
pub(super) fn schema(keys: &[Key], described: &[Description]) -> Value {
    let mut root = table("a case of a co-simulation");
    let roles: Vec<&str> = described.iter().map(|one| one.role.as_str()).collect();
    for key in keys {
        let value = value(key);
        match key.spec.path.split_once('.') {
            Some((ROLE, rest)) => {
                roles.iter().for_each(|role| insert(&mut root, &format!("{role}.{rest}"), &value));
            }
            _ => insert(&mut root, &key.spec.path, &value),
        }
    }
    for effect in described.iter().flat_map(|one| &one.effects) {
        let path = format!("effects.{}", effect.name);
        let node = at(&mut root, &path);
        node["description"] = format!("{} ({})", effect.law, effect.source).into();
    }
    root["$schema"] = "http://json-schema.org/draft-07/schema#".into();
    root["additionalProperties"] = json!({
        "type": "object",
        "description": "a participant of another program",
        "anyOf": [{"required": ["command"]}, {"required": ["attach"]}],
    });
    root
}

/// A table without keys so far.
fn table(description: &str) -> Value {
    let mut node = json!({"type": "object", "properties": {}, "additionalProperties": false});
    if !description.is_empty() {
        node["description"] = description.into();
    }
    node
}

/// The node of a path, with all tables on the way.
fn at<'a>(root: &'a mut Value, path: &str) -> &'a mut Value {
    path.split('.').fold(root, |node, part| {
        let missing = || table("");
        if part == "*" {
            if node["additionalProperties"] == false {
                node["additionalProperties"] = missing();
            }
            return &mut node["additionalProperties"];
        }
        let Value::Object(node) = node else { unreachable!("every node is an object") };
        let properties = node.entry("properties").or_insert_with(|| Map::new().into());
        let Value::Object(properties) = properties else {
            unreachable!("properties are an object")
        };
        properties.entry(part).or_insert_with(missing)
    })
}

/// Puts the schema of a value at a path; one that has another reader may be of either type.
fn insert(root: &mut Value, path: &str, value: &Value) {
    let (parent, name) = path.rsplit_once('.').unwrap_or(("", path));
    let parent = if parent.is_empty() { root } else { at(root, parent) };
    let place = if name == "*" { "additionalProperties" } else { "properties" };
    if name == "*" {
        parent[place] = value.clone();
        return;
    }
    match &mut parent[place][name] {
        none @ Value::Null => *none = value.clone(),
        other if other.get("anyOf").is_some() => {
            if let Some(all) = other["anyOf"].as_array_mut() {
                all.push(value.clone());
            }
        }
        other => {
            *other = json!({"description": other["description"], "anyOf": [other.clone(), value]})
        }
    }
}

fn value(key: &Key) -> Value {
    let spec = &key.spec;
    let bounded = |mut number: Value| {
        let bounds = [
            ("exclusiveMinimum", spec.above),
            ("minimum", spec.at_least),
            ("maximum", spec.at_most),
        ];
        for (name, bound) in bounds {
            if let Some(bound) = bound {
                number[name] = bound.into();
            }
        }
        number
    };
    let mut ways = match &spec.kind {
        KeyKind::Quantity { .. } => vec![
            bounded(json!({"type": "number"})),
            json!({"type": "string", "pattern": "^\\s*[-+]?(\\d|\\.\\d|inf)"}),
        ],
        KeyKind::Integer => vec![bounded(json!({"type": "integer"}))],
        KeyKind::Flag => vec![json!({"type": "boolean"})],
        KeyKind::Choice { of } => vec![json!({"enum": of})],
        KeyKind::Text | KeyKind::File | KeyKind::NameIn { .. } => vec![json!({"type": "string"})],
    };
    if key.list {
        let items = json!({"type": "array", "items": {"anyOf": ways.clone()}});
        ways.push(items);
    }
    if spec.varies {
        let column = json!({"type": "string"});
        ways.push(json!({
            "type": "object",
            "properties": {"file": column, "column": column},
            "required": ["file", "column"],
        }));
        let live = json!({"type": ["number", "string"]});
        ways.push(json!({
            "type": "object",
            "properties": {"at": live, "from": live, "to": live},
            "required": ["at", "from", "to"],
            "additionalProperties": false,
        }));
    }
    let mut node = match ways.len() {
        1 => ways.remove(0),
        _ => json!({"anyOf": ways}),
    };
    node["description"] = format!("{} [{}]", spec.help, facts(key)).into();
    if let Some(default) = &spec.default {
        node["default"] = default.clone();
    }
    node
}
