//! What every study leaves in its folder: one file of plain data, which is read again for its page.

use super::folder::{StudyFolder, says_incomplete};
use console::output::print;
use contract::input_file;
use contract::text::json;
use pages::page::Page;
use run::error::{RunError, input_failure};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Larger files are refused [byte].
const MOST_BYTES: u64 = 1 << 30;

/// Plain data that a study keeps in its folder. A key `schema` holds the version of its layout; with
/// `complete = false` it is of a study that has not finished.
pub trait Kept: Serialize + DeserializeOwned {
    /// The command that makes it.
    const COMMAND: &'static str;
    /// Name of its file.
    const FILE: &'static str;
    /// Version of its layout.
    const SCHEMA: u32;

    /// Writes it into its folder.
    ///
    /// # Errors
    /// The file system.
    fn write(&self, folder: &StudyFolder) -> Result<(), RunError> {
        folder.write(Self::FILE, json(self).as_bytes())
    }

    /// Reads it out of its folder.
    ///
    /// # Errors
    /// [`RunError::Usage`] if the file is of another version, of a study that has not finished, or
    /// something else; the file system.
    fn read(folder: &Path) -> Result<Self, RunError> {
        read_file(folder)
    }

    /// The study in this folder was stopped.
    #[must_use]
    fn is_unfinished(folder: &Path) -> bool {
        says_incomplete(&folder.join(Self::FILE))
    }
}

/// Reads the file of a study, as [`Kept::read`] has it.
///
/// # Errors
/// Those of [`Kept::read`].
pub fn read_file<S: Kept>(folder: &Path) -> Result<S, RunError> {
    let path = folder.join(S::FILE);
    let text = input_file::read(&path, MOST_BYTES).map_err(|error| input_failure(&path, &error))?;
    let refuse = |why: &dyn std::fmt::Display| {
        let fix = format!("run `coordinator {}` again", S::COMMAND);
        RunError::Usage(format!("{} contains no study: {why}; {fix}", path.display()))
    };
    let head: Head = serde_json::from_slice(&text).map_err(|fault| refuse(&fault))?;
    if head.schema != S::SCHEMA {
        let (found, known) = (head.schema, S::SCHEMA);
        return Err(refuse(&format!("its layout has version {found}, supported is {known}")));
    }
    if head.complete == Some(false) {
        return Err(refuse(&"the study has not finished"));
    }
    serde_json::from_slice(&text).map_err(|fault| refuse(&fault))
}

/// What the file of every study begins with.
#[derive(Deserialize)]
struct Head {
    schema: u32,
    complete: Option<bool>,
}

/// A study with a page.
pub trait Shown: Kept {
    /// The page about it, made of what lies in its folder.
    ///
    /// # Errors
    /// Something that the page needs is not in the folder.
    fn page(&self, folder: &Path) -> Result<Page, RunError>;

    /// Writes it and its page into its folder.
    ///
    /// # Errors
    /// Those of [`Kept::write`] and [`Shown::page`].
    fn publish(&self, folder: &StudyFolder) -> Result<(), RunError> {
        self.write(folder)?;
        let place = folder.open()?;
        pages::write(&self.page(&place)?, &place).map(drop)
    }
}

/// A kind of study, as the command `report` knows it.
#[derive(Clone, Copy)]
pub struct Kind {
    /// The file that it leaves in its folder.
    pub file: &'static str,
    /// The page about the study in a folder.
    pub page: fn(&Path) -> Result<Page, RunError>,
}

/// The kind of a study.
#[must_use]
pub const fn kind<S: Shown>() -> Kind {
    Kind { file: S::FILE, page: |folder| S::read(folder)?.page(folder) }
}

/// How a command prints what it has done.
#[derive(Clone, Copy, Debug)]
pub struct Printing {
    /// As JSON.
    pub json: bool,
    /// Not at all, but for JSON.
    pub quiet: bool,
}

impl Printing {
    /// Prints a study: its data, or this text and where its files are.
    ///
    /// # Errors
    /// It cannot be printed.
    pub fn print<S: Kept>(
        self,
        study: &S,
        text: impl Fn() -> String,
        folder: &StudyFolder,
    ) -> Result<(), RunError> {
        print(&match (self.json, self.quiet) {
            (true, _) => json(study),
            (false, true) => String::new(),
            (false, false) => format!("{}  results   {}\n", text(), folder.path().display()),
        })
    }

    /// Progress is to be shown.
    #[must_use]
    pub fn is_silent(self) -> bool {
        self.json || self.quiet
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Serialize, Deserialize)]
    struct Some {
        schema: u32,
        value: f64,
    }

    impl Kept for Some {
        const COMMAND: &'static str = "some";
        const FILE: &'static str = "some.json";
        const SCHEMA: u32 = 2;
    }

    #[test]
    fn only_a_study_of_this_version_that_is_done_is_read() {
        let place = tempfile::tempdir().unwrap();
        let read = |text: &str| {
            std::fs::write(place.path().join(Some::FILE), text).unwrap();
            Some::read(place.path()).map(|some| some.value).map_err(|error| error.to_string())
        };
        assert_eq!(read(r#"{"schema": 2, "value": 1.5}"#), Ok(1.5));
        for (text, why) in [
            (r#"{"schema": 1, "value": 1.5}"#, "its layout has version 1, supported is 2"),
            (r#"{"schema": 2, "complete": false}"#, "the study has not finished"),
            (r#"{"schema": 2}"#, "missing field `value`"),
            ("[", "EOF"),
        ] {
            let message = read(text).unwrap_err();
            assert!(message.contains("some.json contains no study: "), "{message}");
            assert!(message.contains(why), "{message}");
            assert!(message.ends_with("; run `coordinator some` again"), "{message}");
        }
    }
}
