//! Writes a case as TOML again, after options have changed it.

use super::quote::quoted;
use super::tree::{Node, Table, Value};
use std::fmt::Write as _;

/// The TOML text of a case.
pub(super) fn write_case(case: &Table) -> String {
    let mut out = String::new();
    write_section(&mut out, "", case);
    out
}

fn write_section(out: &mut String, path: &str, table: &Table) {
    // Once a table has its own header, its later siblings need theirs to keep the order.
    let is_section = |node: &Node| node.table().is_some_and(|t| !t.inline);
    let first = table.entries.iter().position(|(_, node)| is_section(node));
    let sectioned =
        |(at, node): (usize, &Node)| node.table().is_some() && first.is_some_and(|f| at >= f);
    let (sections, lines): (Vec<_>, Vec<_>) = table
        .entries
        .iter()
        .enumerate()
        .map(|(at, (name, node))| (sectioned((at, node)), name, node))
        .partition(|(section, ..)| *section);
    if !path.is_empty() && (!lines.is_empty() || sections.is_empty()) {
        let gap = if out.is_empty() { "" } else { "\n" };
        let _ = writeln!(out, "{gap}[{path}]");
    }
    for (_, name, node) in lines {
        let _ = writeln!(out, "{} = {}", bare_or_quoted(name), inline(&node.value));
    }
    for (_, name, node) in sections {
        let name = bare_or_quoted(name);
        let path = if path.is_empty() { name } else { format!("{path}.{name}") };
        if let Some(table) = node.table() {
            write_section(out, &path, table);
        }
    }
}

/// A value on one line.
pub(super) fn inline(value: &Value) -> String {
    match value {
        Value::Text(text) => quoted(text),
        Value::Number { written, .. } => written.clone(),
        Value::Flag(flag) => flag.to_string(),
        Value::Date(date) => date.clone(),
        Value::List(items) => {
            let items: Vec<String> = items.iter().map(|item| inline(&item.value)).collect();
            format!("[{}]", items.join(", "))
        }
        Value::Table(table) if table.entries.is_empty() => "{}".to_owned(),
        Value::Table(table) => {
            let entry = |(name, node): &(String, Node)| {
                format!("{} = {}", bare_or_quoted(name), inline(&node.value))
            };
            let entries: Vec<String> = table.entries.iter().map(entry).collect();
            format!("{{ {} }}", entries.join(", "))
        }
    }
}

fn bare_or_quoted(name: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !name.is_empty() && name.chars().all(bare) { name.to_owned() } else { quoted(name) }
}
