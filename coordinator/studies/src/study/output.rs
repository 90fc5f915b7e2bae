//! Files that every study leaves in its folder: one file of plain data, from which the page is
//! built.

use super::folder::{StudyFolder, says_incomplete};
use console::output::print;
use contract::text::json;
use pages::page::Page;
use run::error::{RunError, input_failure};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Plain data that a study keeps in its folder. The key `schema` holds the version of the layout;
/// `complete = false` marks an unfinished study.
pub trait StudyFile: Serialize + DeserializeOwned {
    /// The command that performs the study.
    const COMMAND: &'static str;
    /// Name of the file.
    const FILE: &'static str;
    /// Version of the layout.
    const SCHEMA: u32;

    /// Writes the file into the folder of the study.
    ///
    /// # Errors
    /// The file cannot be written.
    fn write(&self, folder: &StudyFolder) -> Result<(), RunError> {
        folder.write(Self::FILE, json(self).as_bytes())
    }

    /// Reads the file from the folder of the study.
    ///
    /// # Errors
    /// [`RunError::Usage`] if the file has another version, belongs to an unfinished study or is
    /// malformed; an input error if the file cannot be read.
    fn read(folder: &Path) -> Result<Self, RunError> {
        read_file(folder)
    }

    /// Returns whether the folder holds an interrupted study.
    #[must_use]
    fn is_unfinished(folder: &Path) -> bool {
        says_incomplete(&folder.join(Self::FILE))
    }
}

/// Reads the file of a study. See [`StudyFile::read`].
///
/// # Errors
/// Same as [`StudyFile::read`].
pub fn read_file<S: StudyFile>(folder: &Path) -> Result<S, RunError> {
    let path = folder.join(S::FILE);
    if !path.exists() {
        let (folder, command) = (folder.display(), S::COMMAND);
        return Err(RunError::Usage(format!(
            "{folder} holds no results of `coordinator {command}`; name the folder of one"
        )));
    }
    let text = run::results::read_file(&path).map_err(|error| input_failure(&path, &error))?;
    let refuse = |why: &dyn std::fmt::Display| {
        let fix = format!("run `coordinator {}` again", S::COMMAND);
        RunError::Usage(format!("{} contains no readable study: {why}; {fix}", path.display()))
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

/// Keys common to the files of all studies.
#[derive(Deserialize)]
struct Head {
    schema: u32,
    complete: Option<bool>,
}

/// A study with a page.
pub trait StudyPage: StudyFile {
    /// Builds the page from the files in the folder of the study.
    ///
    /// # Errors
    /// A file that the page needs is missing or cannot be read.
    fn page(&self, folder: &Path) -> Result<Page, RunError>;

    /// Writes the study and its page into the folder.
    ///
    /// # Errors
    /// Same as [`StudyFile::write`] and [`StudyPage::page`].
    fn publish(&self, folder: &StudyFolder) -> Result<(), RunError> {
        self.write(folder)?;
        let place = folder.open()?;
        pages::write(&self.page(&place)?, &place).map(drop)
    }
}

/// Entry points that the command `report` needs of a kind of study.
#[derive(Clone, Copy)]
pub struct Kind {
    /// Name of the file in the study's folder.
    pub file: &'static str,
    /// Builds the page of the study in a folder.
    pub page: fn(&Path) -> Result<Page, RunError>,
}

/// Returns the [`Kind`] of a study.
#[must_use]
pub const fn kind<S: StudyPage>() -> Kind {
    Kind { file: S::FILE, page: |folder| S::read(folder)?.page(folder) }
}

/// Output format of a command.
#[derive(Clone, Copy, Debug)]
pub struct Printing {
    /// Print JSON.
    pub json: bool,
    /// Print nothing, unless JSON is requested.
    pub quiet: bool,
}

impl Printing {
    /// Prints the study as JSON, or `text` followed by the path of the folder.
    ///
    /// # Errors
    /// The output cannot be written.
    pub fn print<S: StudyFile>(
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

    /// Returns whether to hide the progress display.
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

    impl StudyFile for Some {
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
            assert!(message.contains("some.json contains no readable study: "), "{message}");
            assert!(message.contains(why), "{message}");
            assert!(message.ends_with("; run `coordinator some` again"), "{message}");
        }
    }
}
