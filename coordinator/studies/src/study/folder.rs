//! The folder of a study: nothing but an earlier study of the same kind is ever replaced, and one that
//! was stopped is gone on with.

use run::error::RunError;
use run::results::Existing;
use run::results::claim::{Claim, holds_results};
use run::results::place::{RESULTS, link_latest, numbered};
use run::results::write::{create, remove, replace};
use serde_json::Value;
use std::cell::OnceCell;
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// What a study asks of its folder.
#[derive(Clone, Copy)]
pub struct Wanted<'a> {
    /// The command that makes it.
    pub command: &'static str,
    /// Name of its folder in `results`, for one that the user does not name.
    pub name: &'a str,
    /// The folder that the user names.
    pub out: Option<&'a Path>,
    /// A study that is there already is replaced.
    pub replace: bool,
    /// The study in this folder was stopped, and is the one that is asked for.
    pub goes_on: &'a dyn Fn(&Path) -> bool,
}

/// A folder that a study writes into; it is made when the first file is written.
#[derive(Debug)]
pub struct StudyFolder {
    path: PathBuf,
    of: String,
    existing: Existing,
    /// It is linked as the latest one.
    latest: bool,
    claim: OnceCell<Claim>,
}

impl StudyFolder {
    /// Chooses the folder: the one that the user names, or the next that is free in `results`, or there
    /// the last one if it is gone on with.
    ///
    /// # Errors
    /// [`RunError::Usage`] if the folder that the user names is a file, holds something else, a study
    /// that is to stay, or is used by another process.
    pub fn choose(wanted: &Wanted<'_>) -> Result<Self, RunError> {
        let of = format!("`coordinator {}`", wanted.command);
        let (path, latest) = match wanted.out {
            Some(out) => (out.to_owned(), false),
            None => (next(wanted, &of), true),
        };
        let goes_on = holds_results(&path, &of) && (wanted.goes_on)(&path);
        let existing = Existing::option(wanted.replace || goes_on);
        let folder = Self { path, of, existing, latest, claim: OnceCell::new() };
        match fs::metadata(&folder.path) {
            // What is there is reported before anything has run.
            Ok(_) => folder.claim().map(drop)?,
            Err(_) => refuse_file(&folder.path)?,
        }
        Ok(folder)
    }

    /// Its path, as it was given.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A path that leads to it as long as this is there, whatever it is called by then; it is made if it
    /// is not there.
    ///
    /// # Errors
    /// The file system, or another process has taken the folder meanwhile.
    pub fn open(&self) -> Result<PathBuf, RunError> {
        Ok(self.claim()?.dir().path())
    }

    /// Writes a file in one go.
    ///
    /// # Errors
    /// As [`StudyFolder::open`].
    pub fn write(&self, name: &str, content: &[u8]) -> Result<(), RunError> {
        replace(&self.open()?.join(name), content)
    }

    /// Writes a file in one go, as it is made.
    ///
    /// # Errors
    /// As [`StudyFolder::open`].
    pub fn create(
        &self,
        name: &str,
        write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<(), RunError> {
        create(&self.open()?.join(name), write)
    }

    /// Removes a file, if it is there.
    ///
    /// # Errors
    /// As [`StudyFolder::open`].
    pub fn remove(&self, name: &str) -> Result<(), RunError> {
        remove(&self.open()?.join(name))
    }

    fn claim(&self) -> Result<&Claim, RunError> {
        if let Some(claim) = self.claim.get() {
            return Ok(claim);
        }
        let claim = Claim::take(&self.path, &self.of, self.existing)?;
        if let (true, Some(name)) = (self.latest, self.path.file_name().and_then(|n| n.to_str())) {
            link_latest(Path::new(RESULTS), name);
        }
        Ok(self.claim.get_or_init(|| claim))
    }
}

fn next(wanted: &Wanted<'_>, of: &str) -> PathBuf {
    let paths = || numbered(wanted.name).map(|name| Path::new(RESULTS).join(name));
    if wanted.replace {
        return Path::new(RESULTS).join(wanted.name);
    }
    let goes_on = |path: &PathBuf| holds_results(path, of) && (wanted.goes_on)(path);
    let last = paths().take_while(|path| path.symlink_metadata().is_ok()).last();
    match last.filter(goes_on) {
        Some(last) => last,
        None => paths().find(|path| path.symlink_metadata().is_err()).unwrap_or_default(),
    }
}

fn refuse_file(path: &Path) -> Result<(), RunError> {
    match path.ancestors().any(Path::is_file) {
        true => {
            let what = "is not a directory; give one with --out";
            Err(RunError::Usage(format!("{} {what}", path.display())))
        }
        false => Ok(()),
    }
}

/// A record in which a study says that it has not come to its end.
#[must_use]
pub fn says_incomplete(record: &Path) -> bool {
    let record = fs::read(record).ok().and_then(|text| serde_json::from_slice(&text).ok());
    record.is_some_and(|record: Value| record["complete"] == false)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choose(out: &Path, command: &'static str, replace: bool) -> Result<StudyFolder, RunError> {
        let goes_on = |folder: &Path| says_incomplete(&folder.join("study.json"));
        let wanted = Wanted { command, name: "x", out: Some(out), replace, goes_on: &goes_on };
        StudyFolder::choose(&wanted)
    }

    fn refusal(chosen: Result<StudyFolder, RunError>) -> String {
        chosen.unwrap_err().to_string()
    }

    #[test]
    fn only_a_study_of_the_same_kind_is_replaced() {
        let place = tempfile::tempdir().unwrap();
        let out = place.path().join("out");
        let folder = choose(&out, "cost", false).unwrap();
        assert!(!out.exists(), "nothing is made before there is something to write");
        folder.write("study.json", b"{}").unwrap();
        assert!(refusal(choose(&out, "cost", true)).contains("is used by another run"));
        drop(folder);
        assert!(refusal(choose(&out, "cost", false)).contains("--replace"));
        choose(&out, "cost", true).unwrap();
        let other = refusal(choose(&out, "ablate", true));
        assert!(other.contains("holds files but no results of `coordinator ablate`"), "{other}");
        let file = refusal(choose(&out.join("study.json/below"), "cost", false));
        assert!(file.contains("is not a directory; give one"), "{file}");
    }

    #[test]
    fn a_study_that_was_stopped_is_gone_on_with() {
        let place = tempfile::tempdir().unwrap();
        let out = place.path().join("out");
        let folder = choose(&out, "cost", false).unwrap();
        folder.write("study.json", br#"{"complete": false}"#).unwrap();
        drop(folder);
        let folder = choose(&out, "cost", false).unwrap();
        folder.write("study.json", br#"{"complete": true}"#).unwrap();
        drop(folder);
        assert!(refusal(choose(&out, "cost", false)).contains("--replace"));
    }
}
