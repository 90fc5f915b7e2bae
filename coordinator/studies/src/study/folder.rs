//! The folder of a study. A study replaces only an earlier study of the same kind, and resumes an
//! interrupted one.

use contract::input_file;
use run::error::{RunError, file_failure};
use run::results::Existing;
use run::results::claim::{Claim, holds_results};
use run::results::place::{RESULTS, link_latest, numbered};
use run::results::write::{create, fresh, remove, replace};
use rustix::fs::OFlags;
use serde_json::Value;
use std::cell::OnceCell;
use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, SeekFrom};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};

/// Size above which the file of a study is refused [byte].
pub(crate) const MOST_BYTES: u64 = 1 << 30;

/// The choice of a folder for a study.
#[derive(Clone, Copy)]
pub struct FolderRequest<'a> {
    /// The command that performs the study.
    pub command: &'static str,
    /// Default name of the folder in `results`.
    pub name: &'a str,
    /// Folder given by the user.
    pub out: Option<&'a Path>,
    /// Whether to replace an existing study.
    pub replace: bool,
    /// Returns whether a folder holds the requested study, interrupted.
    pub goes_on: &'a dyn Fn(&Path) -> bool,
}

/// The folder that a study writes to. The folder is created when the first file is written.
#[derive(Debug)]
pub struct StudyFolder {
    path: PathBuf,
    of: String,
    existing: Existing,
    /// Whether to link the folder as the latest results.
    latest: bool,
    claim: OnceCell<Claim>,
}

impl StudyFolder {
    /// Chooses the folder: the user's folder, or the next free name in `results`. Without a user's
    /// folder, the last study in `results` is used again if it can be resumed.
    ///
    /// # Errors
    /// [`RunError::Usage`] if the user's folder is a file, holds anything but a study of this kind,
    /// holds a finished study without `replace`, or is in use by another process.
    pub fn choose(wanted: &FolderRequest<'_>) -> Result<Self, RunError> {
        let of = format!("`coordinator {}`", wanted.command);
        let (path, latest) = match wanted.out {
            Some(out) => (out.to_owned(), false),
            None => (next(wanted, &of), true),
        };
        let goes_on = holds_results(&path, &of) && (wanted.goes_on)(&path);
        let existing = Existing::option(wanted.replace || goes_on);
        let folder = Self { path, of, existing, latest, claim: OnceCell::new() };
        match fs::metadata(&folder.path) {
            // Report a conflict with existing files before anything runs.
            Ok(_) => folder.claim().map(drop)?,
            Err(_) => refuse_file(&folder.path)?,
        }
        Ok(folder)
    }

    /// The path as given.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns a path that stays valid while `self` exists, even if the folder is renamed. Creates
    /// the folder if necessary.
    ///
    /// # Errors
    /// The folder cannot be created, or another process has claimed the folder meanwhile.
    pub fn open(&self) -> Result<PathBuf, RunError> {
        Ok(self.claim()?.dir().path())
    }

    /// Replaces a file atomically.
    ///
    /// # Errors
    /// Same as [`StudyFolder::open`], or the file cannot be written.
    pub fn write(&self, name: &str, content: &[u8]) -> Result<(), RunError> {
        replace(&self.open()?.join(name), content)
    }

    /// Replaces a file atomically, with content that `write` produces.
    ///
    /// # Errors
    /// Same as [`StudyFolder::open`], or the file cannot be written.
    pub fn create(
        &self,
        name: &str,
        write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<(), RunError> {
        create(&self.open()?.join(name), write)
    }

    /// Opens a file for appending after its first `bytes` bytes; with 0 a new file begins.
    ///
    /// # Errors
    /// Same as [`StudyFolder::open`], or the file cannot be opened.
    pub fn grow(&self, name: &str, bytes: u64) -> Result<File, RunError> {
        let (place, shown) = (self.open()?.join(name), self.path.join(name));
        let again = || {
            let no_link = OFlags::NOFOLLOW.bits().cast_signed();
            let mut file = File::options().write(true).custom_flags(no_link).open(&place)?;
            file.set_len(bytes)?;
            file.seek(SeekFrom::End(0))?;
            Ok(file)
        };
        let file = if bytes == 0 { fresh(&place) } else { again() };
        file.map_err(|error| file_failure(&shown, &error))
    }

    /// Removes a file if it exists.
    ///
    /// # Errors
    /// Same as [`StudyFolder::open`], or the file cannot be removed.
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

fn next(wanted: &FolderRequest<'_>, of: &str) -> PathBuf {
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

/// Returns whether the record of a study states that the study is incomplete.
#[must_use]
pub fn says_incomplete(record: &Path) -> bool {
    let text = input_file::read(record, MOST_BYTES).ok();
    let record = text.and_then(|text| serde_json::from_slice(&text).ok());
    record.is_some_and(|record: Value| record["complete"] == false)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choose(out: &Path, command: &'static str, replace: bool) -> Result<StudyFolder, RunError> {
        let goes_on = |folder: &Path| says_incomplete(&folder.join("study.json"));
        let wanted =
            FolderRequest { command, name: "x", out: Some(out), replace, goes_on: &goes_on };
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
