//! The case as a tree of keys that remember their places. It is read from TOML, and written as TOML
//! again after options have changed it.

use std::fmt::Write as _;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// Deepest nesting of tables and lists, far beyond any key of a case.
const DEEPEST: usize = 12;

/// The place at which a key was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// In the file: the bytes of the key, and of its value.
    File { key: Range<usize>, value: Range<usize> },
    /// On the command line: the number of the option.
    Argument(usize),
}

/// A value and its origin.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) origin: Origin,
    pub(super) value: Value,
}

/// A TOML value.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Text(String),
    /// A number as written; `whole` if it is an integer within range.
    Number {
        written: String,
        value: f64,
        whole: Option<i64>,
    },
    Flag(bool),
    /// A date or time as written.
    Date(String),
    List(Vec<Node>),
    Table(Table),
}

/// A table, its entries in the order of the file.
#[derive(Clone, Debug, Default)]
pub(super) struct Table {
    pub(super) entries: Vec<(String, Node)>,
    /// Written in braces.
    pub(super) inline: bool,
}

impl Table {
    pub(super) fn get(&self, name: &str) -> Option<&Node> {
        self.entries.iter().find(|(key, _)| key == name).map(|(_, node)| node)
    }

    fn get_mut(&mut self, name: &str) -> Option<&mut Node> {
        self.entries.iter_mut().find(|(key, _)| key == name).map(|(_, node)| node)
    }

    /// Returns the node at a dotted key.
    pub(super) fn find(&self, key: &str) -> Option<&Node> {
        let mut parts = key.split('.');
        let first = self.get(parts.next()?)?;
        parts.try_fold(first, |node, part| node.table()?.get(part))
    }

    /// Returns the text at a dotted key; `None` for another value.
    pub(super) fn text(&self, key: &str) -> Option<&str> {
        match &self.find(key)?.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Returns the table at a dotted key; `None` for another value.
    pub(super) fn table(&self, key: &str) -> Option<&Self> {
        self.find(key)?.table()
    }

    /// Returns the names in the table at a dotted key.
    pub(super) fn names(&self, key: &str) -> Vec<String> {
        let table = self.table(key);
        table.map_or_else(Vec::new, |t| t.entries.iter().map(|(name, _)| name.clone()).collect())
    }

    /// Puts a node at a path. Missing tables on the way get the same origin.
    ///
    /// # Errors
    /// A value on the way is not a table; the error is its dotted key.
    pub(super) fn insert(&mut self, path: &[String], node: Node) -> Result<(), String> {
        let Some((last, way)) = path.split_last() else { return Ok(()) };
        let mut table = self;
        for (depth, part) in way.iter().enumerate() {
            if table.get(part).is_none() {
                let value = Value::Table(Self::default());
                let step = Node { origin: node.origin.clone(), value };
                table.entries.push((part.clone(), step));
            }
            let step = table.get_mut(part).map(|node| &mut node.value);
            let Some(Value::Table(next)) = step else { return Err(path[..=depth].join(".")) };
            table = next;
        }
        match table.get_mut(last) {
            Some(old) => *old = node,
            None => table.entries.push((last.clone(), node)),
        }
        Ok(())
    }

    /// Removes and returns the node at a path.
    pub(super) fn remove(&mut self, path: &[String]) -> Option<Node> {
        let (last, way) = path.split_last()?;
        let mut table = self;
        for part in way {
            let Value::Table(next) = &mut table.get_mut(part)?.value else { return None };
            table = next;
        }
        let index = table.entries.iter().position(|(key, _)| key == last)?;
        Some(table.entries.remove(index).1)
    }
}

impl Node {
    pub(super) fn table(&self) -> Option<&Table> {
        match &self.value {
            Value::Table(table) => Some(table),
            _ => None,
        }
    }

    /// Returns the items of a list of texts.
    pub(super) fn texts(&self) -> Option<Vec<String>> {
        let Value::List(items) = &self.value else { return None };
        let text = |item: &Node| match &item.value {
            Value::Text(text) => Some(text.clone()),
            _ => None,
        };
        items.iter().map(text).collect()
    }
}

impl Value {
    /// Describes the value for messages: "the text \"fast\"".
    pub(super) fn describe(&self) -> String {
        match self {
            Self::Text(text) => format!("the text {}", quoted(text)),
            Self::Number { written, .. } => format!("the number {written}"),
            Self::Flag(flag) => flag.to_string(),
            Self::Date(date) => format!("the date {date}"),
            Self::List(_) => "a list".to_owned(),
            Self::Table(_) => "a table".to_owned(),
        }
    }
}

/// Converts parsed TOML to a tree, for a file or for the value of an option.
pub(super) struct Convert<'a> {
    /// The text that was parsed.
    pub(super) text: &'a str,
    /// The number of the option; `None` for the file.
    pub(super) argument: Option<usize>,
}

/// Error for too deep nesting, with the bytes of its place.
pub(super) struct TooDeep(pub(super) Range<usize>);

impl Convert<'_> {
    pub(super) fn table(&self, table: &DeTable<'_>, depth: usize) -> Result<Table, TooDeep> {
        let mut entries = Vec::with_capacity(table.len());
        for (key, value) in table {
            let node = self.node(key.span(), value, depth)?;
            entries.push((key.span().start, key.get_ref().to_string(), node));
        }
        entries.sort_by_key(|(start, ..)| *start);
        let entries = entries.into_iter().map(|(_, name, node)| (name, node)).collect();
        Ok(Table { entries, inline: false })
    }

    /// Converts a value; `key` is the range of its key, or of the value itself without a key.
    pub(super) fn node(
        &self,
        key: Range<usize>,
        value: &Spanned<DeValue<'_>>,
        depth: usize,
    ) -> Result<Node, TooDeep> {
        if depth > DEEPEST {
            return Err(TooDeep(key));
        }
        let span = value.span();
        let value = match value.get_ref() {
            DeValue::String(text) => Value::Text(text.to_string()),
            DeValue::Integer(integer) => {
                let digits = integer.as_str();
                let whole = i64::from_str_radix(digits, integer.radix()).ok();
                // Beyond i64 only decimal digits are converted; other forms become NaN, which is
                // refused.
                let value = digits.parse().unwrap_or(f64::NAN);
                let value = whole.map_or(value, |whole| whole as f64);
                Value::Number { written: integer.to_string(), value, whole }
            }
            DeValue::Float(float) => {
                let value = float.as_str().parse().unwrap_or(f64::NAN);
                Value::Number { written: float.as_str().to_owned(), value, whole: None }
            }
            DeValue::Boolean(flag) => Value::Flag(*flag),
            DeValue::Datetime(date) => Value::Date(date.to_string()),
            DeValue::Array(array) => Value::List(self.list(array, depth)?),
            DeValue::Table(table) => {
                let braces = self.text.get(span.start..).is_some_and(|rest| rest.starts_with('{'));
                let inline = braces && self.argument.is_none();
                Value::Table(Table { inline, ..self.table(table, depth + 1)? })
            }
        };
        let origin = self.argument.map_or(Origin::File { key, value: span }, Origin::Argument);
        Ok(Node { origin, value })
    }

    fn list(&self, array: &DeArray<'_>, depth: usize) -> Result<Vec<Node>, TooDeep> {
        array.iter().map(|item| self.node(item.span(), item, depth + 1)).collect()
    }
}

/// Writes a case as TOML.
pub(super) fn write_case(case: &Table) -> String {
    let mut out = String::new();
    write_section(&mut out, "", case);
    out
}

fn write_section(out: &mut String, path: &str, table: &Table) {
    // After a table with its own header, later siblings need headers too, to keep the order.
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

/// Writes a value on one line.
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

/// Writes a TOML basic string.
pub(super) fn quoted(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
