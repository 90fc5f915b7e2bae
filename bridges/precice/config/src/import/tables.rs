//! Text of a case: tables, keys, values and comments, in the layout of the cases of this project.

use std::fmt::Write as _;

/// Longest line.
const WIDTH: usize = 100;
/// Column of comments behind values.
const COLUMN: usize = 34;

/// Tables of a case. A table without keys is left out.
#[derive(Debug, Default)]
pub(super) struct Tables {
    text: String,
    open: Option<String>,
}

impl Tables {
    /// Begins a table.
    pub(super) fn open(&mut self, name: &str) {
        self.open = Some(format!("[{name}]\n"));
    }

    /// Begins a table after an empty line.
    pub(super) fn open_apart(&mut self, name: &str) {
        self.open = Some(format!("\n[{name}]\n"));
    }

    /// Adds a key to the table.
    pub(super) fn key(&mut self, key: &str, value: impl AsRef<str>) {
        self.text += &self.open.take().unwrap_or_default();
        let _ = writeln!(self.text, "{key} = {}", value.as_ref());
    }

    /// Adds a key with a comment behind it.
    pub(super) fn explained(&mut self, key: &str, value: impl AsRef<str>, comment: &str) {
        let line = format!("{key} = {}", value.as_ref());
        self.text += &self.open.take().unwrap_or_default();
        let _ = writeln!(self.text, "{line:COLUMN$}# {comment}");
    }

    /// Returns the text of all tables.
    pub(super) fn finish(self) -> String {
        self.text
    }
}

/// Returns a text as comments, with the start of the first line and of the others.
pub(super) fn comment(first: &str, others: &str, text: &str) -> String {
    let mut lines = vec![first.to_owned()];
    for word in text.split_whitespace() {
        let Some(line) = lines.last_mut() else { break };
        let empty = line.len() <= first.len().max(others.len()) && line.ends_with(' ');
        if !empty && line.chars().count() + 1 + word.chars().count() > WIDTH {
            lines.push(format!("{others}{word}"));
            continue;
        }
        if !empty {
            line.push(' ');
        }
        line.push_str(word);
    }
    lines.join("\n") + "\n"
}

/// Returns a string of TOML.
pub(super) fn text(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => quoted += "\\\"",
            '\\' => quoted += "\\\\",
            c if c.is_control() => _ = write!(quoted, "\\u{:04X}", u32::from(c)),
            c => quoted.push(c),
        }
    }
    quoted + "\""
}

/// Returns a list of strings, with a line break before each of the words that begin a group.
pub(super) fn list(words: &[String], begins: impl Fn(&str) -> bool) -> String {
    let mut list = String::from("[");
    let mut length = 0;
    for (place, word) in words.iter().enumerate() {
        let quoted = text(word);
        if place > 0 {
            list.push(',');
            let full = length + quoted.chars().count() + 2 > WIDTH - 12;
            let apart = begins(word) || full;
            list += if apart { "\n    " } else { " " };
            length = if apart { 0 } else { length };
        }
        length += quoted.chars().count() + 2;
        list += &quoted;
    }
    list + "]"
}

/// Returns a number of TOML: the shortest that has the same value.
pub(super) fn number(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e6 {
        format!("{value:.0}")
    } else if (1e-2..1e6).contains(&value.abs()) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_exact() {
        let written = [1.0, 100.0, 0.01, 0.025, 5e-3, 1e-6, 2.5e-4, 0.0, 1e9, 1.0 / 3.0, 1e-300];
        let expected = [
            "1",
            "100",
            "0.01",
            "0.025",
            "5e-3",
            "1e-6",
            "2.5e-4",
            "0",
            "1e9",
            "0.3333333333333333",
            "1e-300",
        ];
        assert_eq!(written.map(number), expected);
        assert!(written.iter().all(|value| number(*value).parse() == Ok(*value)));
    }

    #[test]
    fn comments_fit_their_lines() {
        let made = comment("# - ", "#   ", &"word ".repeat(50));
        assert!(made.lines().all(|line| line.len() <= WIDTH && line.starts_with('#')), "{made}");
        assert_eq!(comment("# - ", "#   ", "a  b"), "# - a b\n");
        assert_eq!(comment("# ", "# ", &"x".repeat(200)), format!("# {}\n", "x".repeat(200)));
    }

    #[test]
    fn strings_are_valid() {
        for hard in ["a\"b\\c", "two\nlines\u{7f}", "ä → \u{1}"] {
            let table: toml::Table = format!("key = {}", text(hard)).parse().unwrap();
            assert_eq!(table["key"].as_str(), Some(hard));
        }
    }
}
