//! `--set key=value` and `--unset key`.

use super::diagnostics::{Place, Problem, Problems};
use super::raw::RawCase;
use super::tree::{Convert, Node, Origin, Table, TooDeep, Value};
use contract::suggest::nearest;
use toml::de::{DeTable, DeValue};

/// Most parts of a dotted key.
const MOST_PARTS: usize = 8;

impl RawCase {
    /// Applies `--set` and then `--unset` options.
    ///
    /// # Errors
    /// All options that cannot be applied.
    pub fn apply<S: AsRef<str>>(&mut self, set: &[S], unset: &[S]) -> Result<(), Problems> {
        let mut problems = Vec::new();
        problems.extend(set.iter().filter_map(|option| self.set(option.as_ref()).err()));
        problems.extend(unset.iter().filter_map(|option| self.unset(option.as_ref()).err()));
        self.report(problems).map_or(Ok(()), Err)
    }

    /// Sets a key: `motion.speed=30`, `load.normal_force=100 kN`, `effects.partial_slip={}`. What
    /// is not a TOML value is a text. Of alternatives, the one that is set replaces those of the
    /// file when the case is validated.
    ///
    /// # Errors
    /// There is no `=`, no key or no value, the value is broken TOML, or the key leads through
    /// something that is not a table.
    pub fn set(&mut self, assignment: &str) -> Result<(), Problem> {
        let option = format!("--set {assignment}");
        let fail = |key: &str, reason: String, fix: String| {
            Problem::new(Place::Argument { text: option.clone() }, key, reason, fix)
        };
        let form = "write `--set key=value`, such as `--set motion.speed=30`";
        let (key, value) =
            split(assignment).ok_or_else(|| fail("", "has no `=`".to_owned(), form.to_owned()))?;
        let path = parse_key(key)
            .ok_or_else(|| fail("", format!("`{}` is not a key", key.trim()), form.to_owned()))?;
        let dotted = path.join(".");
        let value = self.parse_value(value).map_err(|fault| fail(&dotted, fault.0, fault.1))?;
        let node = Node { origin: Origin::Argument(self.arguments.len()), value };
        self.tree.insert(&path, node).map_err(|step| {
            fail(&dotted, format!("`{step}` is not a table"), format!("set `{step}` itself"))
        })?;
        self.arguments.push(option);
        Ok(())
    }

    /// Removes a key or a table.
    ///
    /// # Errors
    /// The key is not there.
    pub fn unset(&mut self, key: &str) -> Result<(), Problem> {
        let option = format!("--unset {key}");
        if parse_key(key).and_then(|path| self.tree.remove(&path)).is_some() {
            self.arguments.push(option);
            return Ok(());
        }
        let mut keys = Vec::new();
        collect(&self.tree, "", &mut keys);
        let fix = match nearest(key, keys.iter().map(String::as_str)) {
            Some(near) => format!("write `--unset {near}`"),
            None => "leave the option out".to_owned(),
        };
        let place = Place::Argument { text: option };
        Err(Problem::new(place, key, "is not in the case", fix))
    }

    /// The value of an option, or the reason and the fix.
    fn parse_value(&self, text: &str) -> Result<Value, (String, String)> {
        let text = text.trim();
        if text.is_empty() {
            let fix = "write a value, `\"\"` for an empty text, or use --unset";
            return Err(("has no value".to_owned(), fix.to_owned()));
        }
        let parsed = match DeValue::parse(text) {
            Ok(parsed) if !matches!(parsed.get_ref(), DeValue::Datetime(_)) => parsed,
            // Brackets and quotes are meant as TOML; anything else is a bare text.
            Err(error) if text.starts_with(['{', '[', '"', '\'']) => {
                let fix = "mind that the shell takes quotes away: --set 'key=\"value\"'";
                let reason = format!("the value is not TOML: {}", error.message());
                return Err((reason, fix.to_owned()));
            }
            _ => return Ok(Value::Text(text.to_owned())),
        };
        let convert = Convert { text, argument: Some(self.arguments.len()) };
        let node = convert.node(parsed.span(), &parsed, 0);
        node.map(|node| node.value).map_err(|TooDeep(_)| {
            ("the value is nested too deeply".to_owned(), "use fewer levels".to_owned())
        })
    }
}

/// Splits at the first `=` outside of quotes.
fn split(assignment: &str) -> Option<(&str, &str)> {
    let mut quote = None;
    for (at, c) in assignment.char_indices() {
        match (quote, c) {
            (None, '=') => return Some((&assignment[..at], &assignment[at + 1..])),
            (None, '"' | '\'') => quote = Some(c),
            (Some(open), c) if c == open => quote = None,
            _ => {}
        }
    }
    None
}

/// The parts of a dotted key, quoted or bare.
fn parse_key(key: &str) -> Option<Vec<String>> {
    let key = key.trim();
    if key.starts_with('[') || key.contains(['\n', '\r']) {
        return None;
    }
    // TOML's own rules for keys: the key with some value is a document of nested tables.
    let document = format!("{key} = true");
    let parsed = DeTable::parse(&document).ok()?;
    let mut table = parsed.get_ref();
    let mut path = Vec::new();
    while path.len() < MOST_PARTS {
        let (name, value) = table.iter().next()?;
        path.push(name.get_ref().to_string());
        match value.get_ref() {
            DeValue::Table(next) => table = next,
            _ => return Some(path),
        }
    }
    None
}

/// All dotted keys of a table.
fn collect(table: &Table, path: &str, keys: &mut Vec<String>) {
    for (name, node) in &table.entries {
        let key = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        if let Some(inner) = node.table() {
            collect(inner, &key, keys);
        }
        keys.push(key);
    }
}
