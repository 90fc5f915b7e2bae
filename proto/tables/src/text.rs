//! Text from outside: titles, names and messages of cases, participants and recordings.
//!
//! Characters that control a terminal, or rearrange text in a line, are always shown as escapes
//! (`\u{1b}`, `\n`). A text that must be a single line is refused on entry if it has such
//! characters ([`check_line`]).

use std::borrow::Cow;

/// Returns true for invisible characters that change the appearance of text: controls, line
/// separators, and marks of text direction.
#[must_use]
pub fn is_hidden(c: char) -> bool {
    let turns = |c| matches!(c, '\u{200e}' | '\u{200f}' | '\u{2066}'..='\u{2069}');
    c.is_control() || matches!(c, '\u{2028}'..='\u{202e}') || turns(c)
}

/// Returns the text as one line, with hidden characters as escapes.
#[must_use]
pub fn one_line(text: &str) -> Cow<'_, str> {
    escaped(text, is_hidden)
}

/// Returns the text with its line breaks and tabs; other hidden characters become escapes.
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

/// Checks a text that must be a single line.
///
/// # Errors
/// Fails if the text has hidden characters.
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
}
