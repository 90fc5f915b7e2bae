//! Checks and JSON output of data with texts from other processes. For a single text see
//! [`tables::text`].

use serde::Serialize;
use serde_json::Value;
use std::borrow::Cow;

pub use tables::text::{check_line, is_hidden, one_line, visible};

/// Returns a value as JSON for a terminal or a file, with all hidden characters escaped;
/// `serde_json` escapes only ASCII controls.
#[must_use]
pub fn json(value: &impl Serialize) -> String {
    let text = serde_json::to_string_pretty(value).expect("plain data");
    let mut out = String::with_capacity(text.len() + 1);
    for c in text.chars() {
        // All hidden characters are in the 16-bit plane and occur only in strings.
        match is_hidden(c) && c != '\n' {
            true => out += &format!("\\u{:04x}", u32::from(c)),
            false => out.push(c),
        }
    }
    out + "\n"
}

/// Checks that every text in plain data is a single line.
///
/// # Errors
/// Fails like [`check_line`], with the key of the text.
pub fn check_lines(what: &str, data: &impl Serialize) -> Result<(), String> {
    let tree = serde_json::to_value(data).map_err(|error| format!("{what}: {error}"))?;
    check_tree(what, &tree)
}

fn check_tree(what: &str, tree: &Value) -> Result<(), String> {
    match tree {
        Value::String(text) => check_line(what, text),
        Value::Array(list) => list.iter().try_for_each(|item| check_tree(what, item)),
        Value::Object(table) => table.iter().try_for_each(|(key, value)| {
            check_line(what, key)?;
            check_tree(&format!("{what}.{key}"), value)
        }),
        _ => Ok(()),
    }
}

/// Returns a text of the same length in which names in double quotes are filled with `x`, so that
/// separators are found outside of names only. A quoted name begins at the start of a word, and a
/// double quote in it is written twice.
#[must_use]
pub fn masked(text: &str) -> String {
    let mut mask = String::with_capacity(text.len());
    let mut word_begins = true;
    loop {
        let rest = &text[mask.len()..];
        let Some(c) = rest.chars().next() else { return mask };
        match quoted_length(rest).filter(|_| word_begins) {
            Some(length) => {
                mask.extend(std::iter::repeat_n('x', length));
                word_begins = false;
            }
            None => {
                mask.push(c);
                word_begins = c.is_whitespace() || c == ',';
            }
        }
    }
}

/// Returns the length of the quoted name at the start of a text, with its quotes.
fn quoted_length(text: &str) -> Option<usize> {
    let mut end = 1;
    text.strip_prefix('"')?;
    loop {
        end += text[end..].find('"')? + 1;
        match text[end..].starts_with('"') {
            true => end += 1,
            false => return Some(end),
        }
    }
}

/// Returns the name that stands in double quotes, or a name without quotes as it is.
#[must_use]
pub fn unquoted(name: &str) -> Cow<'_, str> {
    match name.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')) {
        Some(inner) => Cow::Owned(inner.replace("\"\"", "\"")),
        None => Cow::Borrowed(name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_stays_json() {
        let value = serde_json::json!({"a\u{1b}\u{9b}": "\u{202e}\n\u{7f}"});
        let text = json(&value);
        assert!(text.chars().all(|c| !is_hidden(c) || c == '\n'), "{text}");
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
    }

    #[test]
    fn names_in_quotes_hide_their_separators() {
        for (text, mask, name) in [
            ("\"a -> b\" -> f", "xxxxxxxx -> f", "a -> b"),
            ("\"a\"\", b\",c", "xxxxxxxx,c", "a\", b"),
            ("\"µ\"", "xxxx", "µ"),
        ] {
            assert_eq!(masked(text), mask);
            assert_eq!(unquoted(&text[..mask.rfind('x').unwrap() + 1]), name);
        }
        // A quote within a word belongs to the name, and an open one is a character.
        for plain in ["'a\"b' -> \"", "a\"b, c\"", ""] {
            assert_eq!(masked(plain), plain);
        }
        assert_eq!(unquoted("a\"b"), "a\"b");
    }

    #[test]
    fn a_text_of_several_lines_is_named_with_its_key() {
        let data = serde_json::json!({"models": [{"name": "a", "summary": "x\ny"}]});
        let fault = check_lines("description", &data).unwrap_err();
        assert!(fault.contains("description.models.summary `x\\ny`"), "{fault}");
        assert_eq!(check_lines("description", &serde_json::json!({"a": ["µm"]})), Ok(()));
    }
}
