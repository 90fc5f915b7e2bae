//! Text from outside: titles, names and messages of cases, participants and recordings.
//!
//! What controls a terminal, or moves text about in a line, never reaches a person as it is: it is
//! written as an escape (`\u{1b}`, `\n`). Where a text is one line by contract, one with such
//! characters is refused on entry ([`check_line`]).

use serde::Serialize;
use serde_json::Value;
use std::borrow::Cow;

/// Characters that a person does not see, but that change what is seen: controls, separators of
/// lines, and marks that turn the direction of a text.
#[must_use]
pub fn is_hidden(c: char) -> bool {
    let turns = |c| matches!(c, '\u{200e}' | '\u{200f}' | '\u{2066}'..='\u{2069}');
    c.is_control() || matches!(c, '\u{2028}'..='\u{202e}') || turns(c)
}

/// The text as one line, hidden characters as escapes.
#[must_use]
pub fn one_line(text: &str) -> Cow<'_, str> {
    escaped(text, is_hidden)
}

/// The text with its lines and tabs, other hidden characters as escapes.
#[must_use]
pub fn visible(text: &str) -> Cow<'_, str> {
    escaped(text, |c| is_hidden(c) && c != '\n' && c != '\t')
}

fn escaped(text: &str, hidden: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&hidden) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match hidden(c) {
            true => out.extend(c.escape_default()),
            false => out.push(c),
        }
    }
    Cow::Owned(out)
}

/// A value as JSON for a terminal or a file: `serde_json` escapes the ASCII controls alone.
#[must_use]
pub fn json(value: &impl Serialize) -> String {
    let text = serde_json::to_string_pretty(value).expect("plain data");
    let mut out = String::with_capacity(text.len() + 1);
    for c in text.chars() {
        // All of them are in the 16-bit plane, and stand in strings alone.
        match is_hidden(c) && c != '\n' {
            true => out += &format!("\\u{:04x}", u32::from(c)),
            false => out.push(c),
        }
    }
    out + "\n"
}

/// A text that is one line by contract.
///
/// # Errors
/// It holds hidden characters.
pub fn check_line(what: &str, text: &str) -> Result<(), String> {
    match text.chars().find(|c| is_hidden(*c)) {
        None => Ok(()),
        Some(c) => {
            let shown: String = one_line(text).chars().take(80).collect();
            let code = c.escape_unicode();
            Err(format!("{what} `{shown}` holds the control character {code}"))
        }
    }
}

/// Every text of plain data, each one line by contract.
///
/// # Errors
/// As [`check_line`], with the key of the text.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_controls_a_terminal_becomes_an_escape() {
        assert_eq!(one_line("a\u{1b}[2J\r\nb\tc"), "a\\u{1b}[2J\\r\\nb\\tc");
        assert_eq!(visible("a\u{1b}[2J\r\nb\tc"), "a\\u{1b}[2J\\r\nb\tc");
        assert_eq!(
            one_line("\u{9b}31m \u{202e} \u{2028} \u{7f}"),
            "\\u{9b}31m \\u{202e} \\u{2028} \\u{7f}"
        );
        for plain in ["", "naïve µm²·K⁻¹ ∂ 日本", "a \\ b"] {
            assert!(matches!(one_line(plain), Cow::Borrowed(text) if text == plain));
        }
    }

    #[test]
    fn json_stays_json() {
        let value = serde_json::json!({"a\u{1b}\u{9b}": "\u{202e}\n\u{7f}"});
        let text = json(&value);
        assert!(text.chars().all(|c| !is_hidden(c) || c == '\n'), "{text}");
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
    }

    #[test]
    fn a_text_of_several_lines_is_named_with_its_key() {
        let data = serde_json::json!({"models": [{"name": "a", "summary": "x\ny"}]});
        let fault = check_lines("description", &data).unwrap_err();
        assert!(fault.contains("description.models.summary `x\\ny`"), "{fault}");
        assert_eq!(check_lines("description", &serde_json::json!({"a": ["µm"]})), Ok(()));
    }
}
