//! `coordinator keys`: the keys of a case, with unit, range, default and readers.
//!
//! The keys come from the coordinator's own table and from the descriptions of the installed
//! programs. docs/case.md and docs/case.schema.json are generated from them. In the schema (JSON
//! Schema, draft 7, for editors) names that a user chooses are any property. An unknown table at
//! the top is a participant of another program, which names its command.

use case::schema::ROLE;
use clap::Args;
use console::command::{Command, Context, Group};
use console::keys::{Key, all, facts, kind, need, range, section};
use console::listing::{Entry, Listing};
use console::output::print;
use contract::description::{Description, KeyKind};
use contract::text::json;
use run::error::RunError;
use run::fleet::installed;
use serde_json::{Map, Value, json};
use std::fmt::Write as _;

/// Options of `coordinator keys`.
#[derive(Debug, Args)]
pub(crate) struct KeysCommand {
    #[command(flatten)]
    of: Listing,
    /// Print a JSON Schema of cases, for completion and checks in editors.
    #[arg(long, conflicts_with_all = ["json", "markdown", "pattern"])]
    schema: bool,
}

impl Command for KeysCommand {
    const NAME: &'static str = "keys";
    const GROUP: Group = Group::Reference;
    const ABOUT: &'static str = "List the keys of a case: unit, range, default, reader";
    const EXAMPLES: &'static [&'static str] =
        &["coordinator keys motion", "coordinator keys --schema"];

    fn run(&self, _: &Context<'_>) -> Result<(), RunError> {
        let described = &installed()?;
        let matches = |key: &Key| self.of.matches([&key.spec.path, &key.spec.help]);
        let keys = self.of.found(all(described).into_iter().filter(matches).collect())?;
        print(&match (self.of.json, self.of.markdown, self.schema) {
            (true, ..) => json(&keys),
            (_, true, _) => markdown(&keys),
            (.., true) => json(&schema(&keys, described)),
            _ => keys.iter().map(|key| self.of.lines(&entry(key))).collect(),
        })
    }
}

fn entry(key: &Key) -> Entry<'_> {
    Entry {
        name: &key.spec.path,
        text: format!("{} [{}]", key.spec.help, facts(key)),
        details: vec![format!("read by {}", key.read_by.join(", "))],
    }
}

/// Returns the page docs/case.md.
fn markdown(keys: &[Key]) -> String {
    let mut text = format!(
        "# Keys of a case\n\nEvery key that the coordinator and the installed programs read, as `coordinator keys --markdown` writes \
         them; `coordinator keys PATTERN` shows some. A quantity is a number in the unit given, or a text with another one (`\"134 kN\"`); \
         `*` stands for any name, `{ROLE}` for the name of a participant. A key that may vary takes a column of a table, \
         `{{ file = \"run.csv\", column = \"N\" }}`, or is given from outside as the run goes, \
         `{{ at = \"134 kN\", from = \"60 kN\", to = \"140 kN\" }}` (docs/fmi.md).\n"
    );
    let mut last = "";
    for key in keys {
        if section(key) != last {
            last = section(key);
            let _ = write!(
                text,
                "\n## {last}\n\n| key | unit, type | range | | what | read by |\n| --- | --- | --- | --- | --- | --- |\n"
            );
        }
        let cells = [kind(key), range(&key.spec), need(&key.spec), key.spec.help.clone()];
        let cells = cells.map(|cell| cell.replace('|', "\\|"));
        let _ = writeln!(
            text,
            "| `{}` | {} | {} |",
            key.spec.path,
            cells.join(" | "),
            key.read_by.join(", ")
        );
    }
    text
}

/// Returns the JSON Schema of a case.
fn schema(keys: &[Key], described: &[Description]) -> Value {
    let mut root = table("a case of a co-simulation");
    let roles: Vec<&str> = described.iter().map(|one| one.role.as_str()).collect();
    for key in keys {
        let value = value(key);
        match key.spec.path.split_once('.') {
            Some((ROLE, rest)) => {
                roles.iter().for_each(|role| put(&mut root, &format!("{role}.{rest}"), &value));
            }
            _ => put(&mut root, &key.spec.path, &value),
        }
    }
    for effect in described.iter().flat_map(|one| &one.effects) {
        let path = format!("effects.{}", effect.name);
        let node = at(&mut root, &path);
        node["description"] = format!("{} ({})", effect.law, effect.source).into();
    }
    root["$schema"] = "http://json-schema.org/draft-07/schema#".into();
    allow_other_programs(&mut root, &roles);
    root
}

/// Allows participants of other programs and tables of their keys. A case whose participants all
/// run the programs of this project has known tables only.
fn allow_other_programs(root: &mut Value, roles: &[&str]) {
    let ours = json!({"not": {"anyOf": [{"required": ["command"]}, {"required": ["attach"]}]}});
    let tables = root["properties"].as_object().into_iter().flat_map(Map::keys);
    let known: Map<String, Value> = tables.map(|name| (name.clone(), true.into())).collect();
    let mut only_ours = known.clone();
    only_ours.extend(roles.iter().map(|role| ((*role).to_owned(), ours.clone())));
    root["additionalProperties"] = json!({
        "type": "object",
        "description": "a participant of another program, or a table of keys that it reads",
    });
    root["if"] = json!({"properties": only_ours, "additionalProperties": ours});
    root["then"] = json!({"properties": known, "additionalProperties": false});
}

/// Schema of a table without keys.
fn table(description: &str) -> Value {
    let mut node = json!({"type": "object", "properties": {}, "additionalProperties": false});
    if !description.is_empty() {
        node["description"] = description.into();
    }
    node
}

/// Returns the node of a path, and makes the tables that lead to it.
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

/// Adds the schema of a value at a path. A key with several readers may have the type of any.
fn put(root: &mut Value, path: &str, value: &Value) {
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
