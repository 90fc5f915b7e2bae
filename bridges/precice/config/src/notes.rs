//! Notes on elements that a case has no counterpart for, or another one.

use crate::error::{shown, visible};
use std::fmt;

/// Kind of a note, by its urgency.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum NoteKind {
    /// Something that is to be added to the case.
    Todo,
    /// An element without a counterpart, which may change results.
    Missing,
    /// An element whose counterpart differs, which may change results.
    Changed,
    /// An element that has no effect on results.
    Unneeded,
}

impl NoteKind {
    /// All kinds, in the order of a list.
    pub const ALL: [Self; 4] = [Self::Todo, Self::Missing, Self::Changed, Self::Unneeded];

    /// Returns the heading of the notes of this kind.
    #[must_use]
    pub fn heading(self) -> &'static str {
        match self {
            Self::Todo => "To do before the first run",
            Self::Missing => "Without a counterpart",
            Self::Changed => "Different from preCICE",
            Self::Unneeded => "Not needed",
        }
    }
}

/// A note on one element, or on several equal ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    /// Kind.
    pub kind: NoteKind,
    /// Lines of the elements, ascending; empty for a note on the case itself.
    pub lines: Vec<usize>,
    /// Name of the element, with the attribute if the note is on one; or a key of the case.
    pub element: String,
    /// Reason, in one line.
    pub reason: String,
    /// Advice.
    pub instead: Option<String>,
}

impl fmt::Display for Note {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: Vec<String> = self.lines.iter().map(usize::to_string).collect();
        match lines.as_slice() {
            [] => {}
            [line] => write!(out, "line {line}, ")?,
            lines => write!(out, "lines {}, ", lines.join(", "))?,
        }
        write!(out, "{}: {}", self.element, self.reason)?;
        self.instead.iter().try_for_each(|instead| write!(out, "; {instead}"))
    }
}

/// Collection of notes.
#[derive(Debug, Default)]
pub(crate) struct Notes(Vec<Note>);

impl Notes {
    /// Adds a note. An equal note gets the line in addition.
    pub(crate) fn add(
        &mut self,
        kind: NoteKind,
        line: usize,
        element: impl AsRef<str>,
        reason: impl AsRef<str>,
    ) {
        self.advise(kind, line, element, reason, None);
    }

    /// Adds a note with advice.
    pub(crate) fn advise(
        &mut self,
        kind: NoteKind,
        line: usize,
        element: impl AsRef<str>,
        reason: impl AsRef<str>,
        instead: Option<&str>,
    ) {
        self.put(kind, Some(line), element.as_ref(), reason.as_ref(), instead);
    }

    /// Adds a note on the case itself.
    pub(crate) fn of_case(
        &mut self,
        kind: NoteKind,
        key: &str,
        reason: &str,
        instead: Option<&str>,
    ) {
        self.put(kind, None, key, reason, instead);
    }

    fn put(
        &mut self,
        kind: NoteKind,
        line: Option<usize>,
        element: &str,
        reason: &str,
        instead: Option<&str>,
    ) {
        let element = shown(element);
        let (reason, instead) = (visible(reason), instead.map(visible));
        let same = |note: &&mut Note| {
            note.kind == kind
                && note.element == element
                && note.reason == reason
                && note.instead == instead
        };
        match self.0.iter_mut().find(same) {
            Some(note) => {
                note.lines.extend(line);
                note.lines.sort_unstable();
                note.lines.dedup();
            }
            None => {
                let lines = line.into_iter().collect();
                self.0.push(Note { kind, lines, element, reason, instead });
            }
        }
    }

    /// Returns the notes by kind, then by line.
    pub(crate) fn into_list(mut self) -> Vec<Note> {
        self.0.sort_by_key(|note| (note.kind, note.lines.first().copied()));
        self.0
    }
}
