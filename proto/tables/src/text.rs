//! Text from outside: titles, names and messages of cases, participants and recordings.
//!
//! Characters that control a terminal, or move text about in a line, never reach a person: they are
//! written as escapes (`\u{1b}`, `\n`). Where a text is one line by contract, one with such
//! characters is refused on entry ([`check_line`]).

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
