//! Errors of a case as shown to the user: place, key, reason and fix.
//!
//! ```text
//! error: cases/bad.toml:12:1: motion.sped: unknown key
//!   12 | sped = "140 km/h"
//!      | ^^^^
//!   fix: write `motion.speed`
//!
//! 1 error in cases/bad.toml
//! ```

use contract::text::is_hidden;
use std::fmt::{self, Write as _};
use std::ops::Range;
use std::sync::Arc;

/// Longest part of a source line that is shown \[characters\].
const SHOWN: usize = 100;

/// A place in the case.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// Part of one line of the case file.
    File {
        /// The file, as the user named it.
        path: Arc<str>,
        /// Line, from 1.
        line: usize,
        /// Column, in characters from 1.
        column: usize,
        /// Number of characters, at least 1, within the line.
        length: usize,
    },
    /// The case file as a whole: a required part is missing.
    Case {
        /// The file, as the user named it.
        path: Arc<str>,
    },
    /// A command-line option, in full: `--set motion.speed=30`.
    Argument {
        /// The option and its value.
        text: String,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File { path, line, column, .. } => write!(f, "{path}:{line}:{column}"),
            Self::Case { path } => f.write_str(path),
            Self::Argument { text } => f.write_str(&crop(&printable(text), 1).0),
        }
    }
}

/// One error of a case.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}\n  fix: {fix}", self.headline())]
pub struct Problem {
    /// Place of the error.
    pub place: Place,
    /// Dotted key at fault; empty for an error of syntax.
    pub key: String,
    /// Reason.
    pub reason: String,
    /// Fix: what to write instead.
    pub fix: String,
}

impl Problem {
    /// Creates an error.
    pub fn new(
        place: Place,
        key: impl Into<String>,
        reason: impl Into<String>,
        fix: impl Into<String>,
    ) -> Self {
        Self { place, key: key.into(), reason: reason.into(), fix: fix.into() }
    }

    fn headline(&self) -> String {
        let key = printable(&self.key);
        let separator = if key.is_empty() { "" } else { ": " };
        format!("error: {}: {key}{separator}{}", self.place, printable(&self.reason))
    }
}

/// Text of a case file, with the offsets of its lines.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Source {
    pub(super) name: Arc<str>,
    pub(super) text: String,
    starts: Vec<usize>,
}

impl Source {
    pub(super) fn new(name: &str, text: String) -> Self {
        let ends = text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(at, _)| at + 1);
        let starts = std::iter::once(0).chain(ends).collect();
        Self { name: name.into(), text, starts }
    }

    /// Returns the place of a range of bytes. A range over several lines is cut at the end of its
    /// first line.
    pub(super) fn place(&self, span: Range<usize>) -> Place {
        let index = self.starts.partition_point(|start| *start <= span.start).saturating_sub(1);
        let start = self.starts[index];
        let line = self.line(index + 1);
        let before = line.char_indices().take_while(|(at, _)| start + at < span.start).count();
        let within = line.char_indices().filter(|(at, _)| span.contains(&(start + at))).count();
        Place::File {
            path: Arc::clone(&self.name),
            line: index + 1,
            column: before + 1,
            length: within.max(1),
        }
    }

    /// Returns a line by its number from 1, without its line break.
    fn line(&self, number: usize) -> &str {
        let Some(start) = self.starts.get(number.saturating_sub(1)) else { return "" };
        let end = self.starts.get(number).copied().unwrap_or(self.text.len());
        self.text[*start..end].trim_end_matches(['\n', '\r'])
    }
}

/// All errors of a case, sorted by place; at least one.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.render(false))]
pub struct Problems {
    file: Arc<Source>,
    list: Vec<Problem>,
}

impl Problems {
    pub(super) fn new(file: Arc<Source>, mut list: Vec<Problem>) -> Self {
        list.sort_by(|a, b| a.place.cmp(&b.place));
        let mut unique: Vec<Problem> = Vec::with_capacity(list.len());
        for problem in list {
            // Equal errors have equal places: compare only the last errors at the same place.
            let same_place = unique.iter().rev().take_while(|p| p.place == problem.place);
            if !same_place.into_iter().any(|p| *p == problem) {
                unique.push(problem);
            }
        }
        Self { file, list: unique }
    }

    /// Returns the errors in the order of their places.
    #[must_use]
    pub fn list(&self) -> &[Problem] {
        &self.list
    }

    /// Renders the errors with their source lines; `colour` adds ANSI escapes.
    #[must_use]
    pub fn render(&self, colour: bool) -> String {
        let mut out = String::new();
        for problem in &self.list {
            self.render_one(&mut out, problem, colour);
        }
        let count = self.list.len();
        let errors = if count == 1 { "error" } else { "errors" };
        out + &format!("{count} {errors} in {}", self.file.name)
    }

    fn render_one(&self, out: &mut String, problem: &Problem, colour: bool) {
        let headline = problem.headline();
        let rest = headline.strip_prefix("error").unwrap_or(&headline);
        let error = paint("error", "1;31", colour);
        let _ = writeln!(out, "{error}{rest}");
        if let Place::File { line, column, length, .. } = problem.place {
            let (shown, column) = crop(&printable(self.file.line(line)), column);
            let number = line.to_string();
            let blank = " ".repeat(number.len());
            let indent: String =
                shown.chars().take(column - 1).map(|c| if c == '\t' { c } else { ' ' }).collect();
            let room = shown.chars().count().saturating_sub(column - 1).max(1);
            let carets = paint(&"^".repeat(length.min(room)), "1;31", colour);
            let _ = writeln!(out, "  {number} | {shown}\n  {blank} | {indent}{carets}");
        }
        let fix = paint("fix", "1;36", colour);
        let _ = writeln!(out, "  {fix}: {}\n", printable(&problem.fix));
    }
}

fn paint(text: &str, code: &str, colour: bool) -> String {
    if colour { format!("\x1b[{code}m{text}\x1b[0m") } else { text.to_owned() }
}

/// Replaces each hidden character except a tab by one visible character, which keeps the carets in
/// place.
fn printable(text: &str) -> String {
    text.chars().map(|c| if is_hidden(c) && c != '\t' { '\u{fffd}' } else { c }).collect()
}

/// Cuts out the part of a long line around a column, and returns the column within that part.
fn crop(line: &str, column: usize) -> (String, usize) {
    let count = line.chars().count();
    if count <= SHOWN {
        return (line.to_owned(), column);
    }
    let skip = column.saturating_sub(SHOWN / 2);
    let piece: String = line.chars().skip(skip).take(SHOWN).collect();
    let (head, shift) = if skip > 0 { ("…", 1) } else { ("", 0) };
    let tail = if skip + SHOWN < count { "…" } else { "" };
    (format!("{head}{piece}{tail}"), column - skip + shift)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(text: &str, span: Range<usize>) -> Problems {
        let source = Arc::new(Source::new("a.toml", text.to_owned()));
        let problem = Problem::new(source.place(span), "a.b", "is wrong", "write c");
        Problems::new(source, vec![problem])
    }

    #[test]
    fn the_line_is_shown_with_carets() {
        let shown = one("x = 1\n\tb = \"é\" # r\n", 11..15).to_string();
        let expected = "error: a.toml:2:6: a.b: is wrong\n  2 | \tb = \"é\" # r\n    | \t    ^^^\n  \
                        fix: write c\n\n1 error in a.toml";
        assert_eq!(shown, expected);
    }

    #[test]
    fn places_beyond_the_text_or_the_line_are_cut() {
        assert!(one("", 0..5).to_string().starts_with("error: a.toml:1:1: "));
        assert!(one("ab\ncd", 1..5).to_string().contains("  1 | ab\n    |  ^\n"));
        assert!(one("ab\n", 3..3).to_string().contains("a.toml:2:1"));
    }

    #[test]
    fn a_long_line_is_cropped_round_its_place() {
        let text = format!("{}X{}", "a".repeat(300), "b".repeat(300));
        let shown = one(&text, 300..301).to_string();
        let lines: Vec<&str> = shown.lines().collect();
        let caret = lines[2].chars().position(|c| c == '^');
        assert_eq!(lines[1].chars().position(|c| c == 'X'), caret);
        assert!(lines[1].chars().count() < 130);
    }

    #[test]
    fn escapes_of_the_case_do_not_reach_the_terminal() {
        assert!(!one("a = \"\x1b[2J\"", 0..1).to_string().contains('\x1b'));
        assert!(one("a", 0..1).render(true).contains("\x1b[1;31merror\x1b[0m: a.toml"));
    }

    #[test]
    fn equal_errors_are_reported_once() {
        let source = Arc::new(Source::new("a.toml", "ab".to_owned()));
        let problem = Problem::new(source.place(0..1), "a", "r", "f");
        let other = Problem::new(source.place(0..1), "a", "s", "f");
        let list = vec![problem.clone(), other, problem];
        assert_eq!(Problems::new(source, list).list().len(), 2);
    }
}
