//! Options and lines of the commands that list keys, fields, figures and models.

use clap::Args;
use run::error::RunError;
use run::wrap;

/// Width of the column of names.
const NAMES: usize = 32;

/// Entries of a list to print, and the format.
#[derive(Debug, Args)]
pub struct Listing {
    /// Show only entries whose name or meaning contains this text, with all details.
    pattern: Option<String>,
    /// Print JSON.
    #[arg(long, conflicts_with = "markdown")]
    pub json: bool,
    /// Print the page of the documentation.
    #[arg(long)]
    pub markdown: bool,
}

/// An entry of a list on the terminal.
#[derive(Debug)]
pub struct Entry<'a> {
    /// Name, in the first column.
    pub name: &'a str,
    /// Text beside the name.
    pub text: String,
    /// Further lines, shown when a pattern is given.
    pub details: Vec<String>,
}

impl Listing {
    /// Reports whether one of the texts contains the pattern, ignoring case.
    #[must_use]
    pub fn matches(&self, texts: [&str; 2]) -> bool {
        self.pattern.as_ref().is_none_or(|pattern| {
            let wanted = pattern.to_lowercase();
            texts.iter().any(|text| text.to_lowercase().contains(&wanted))
        })
    }

    /// Returns entries that match.
    ///
    /// # Errors
    /// No entry matches.
    pub fn found<T>(&self, entries: Vec<T>) -> Result<Vec<T>, RunError> {
        match &self.pattern {
            Some(pattern) if entries.is_empty() => {
                let fix = "leave the pattern out to list all";
                Err(RunError::Usage(format!("no entry matches `{pattern}`; {fix}")))
            }
            _ => Ok(entries),
        }
    }

    /// Returns the lines of an entry on the terminal.
    #[must_use]
    pub fn lines(&self, entry: &Entry<'_>) -> String {
        let mut lines = wrap::item(entry.name, NAMES, &entry.text);
        if self.pattern.is_some() {
            lines.extend(entry.details.iter().map(|detail| wrap::item("", NAMES, detail)));
        }
        lines
    }
}
