//! Folder into which a run writes: taken, cleared of earlier results on request, then held open and
//! locked until the run ends.

use super::claim::{A_RUN, Claim, Existing, create};
use super::clear::{FILES, LOG, REFINED, RESERVE, SUMMARY};
use super::clear::{clear, refuse_links, remove_refined, take_over_refined};
use super::dir::Dir;
use super::place::{link_latest, numbered};
use super::read::read_file;
use super::write::{Reserve, fresh, remove, replace};
use crate::error::{RunError, file_failure, input_failure};
use crate::results::summary::Summary;
use crate::warnings::Warning;
use case::RawCase;
use rustix::fs::OFlags;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Disk space reserved for a summary \[byte\].
const SUMMARY_BYTES: u64 = 64 << 10;

/// Folder into which a run writes, locked for this run.
#[derive(Debug)]
pub struct ResultFolder {
    claim: Claim,
    /// The log; none in a folder that is only passed through.
    log: Option<File>,
    reserve: Mutex<Option<Reserve>>,
}

impl ResultFolder {
    /// Takes the folder at this path for a run of the case file `case`. A missing folder is
    /// created.
    ///
    /// # Errors
    /// [`RunError::Usage`] if the path is a file, or if the folder holds other files, holds results
    /// that are to stay, holds `case` itself under a name that the run would write, or is used by
    /// another run.
    pub fn prepare(path: &Path, case: &Path, existing: Existing) -> Result<Self, RunError> {
        spare_case(path, case)?;
        Self::cleared(Claim::take(path, A_RUN, existing)?)
    }

    /// Takes an empty or earlier folder of this kind for a run whose summary is used at once: only
    /// the tables of the run are written.
    ///
    /// # Errors
    /// The folder holds other files.
    pub fn transient(path: &Path) -> Result<Self, RunError> {
        let claim = Claim::take(path, A_RUN, Existing::Replace)?;
        Ok(Self { claim, log: None, reserve: Mutex::new(None) })
    }

    /// Returns whether the run writes more than its tables.
    pub(crate) fn is_kept(&self) -> bool {
        self.log.is_some()
    }

    /// Creates the folder NAME in `results`, or else NAME-2, and so on, and links it as the latest.
    ///
    /// # Errors
    /// The folder cannot be created.
    pub fn next(results: &Path, name: &str) -> Result<Self, RunError> {
        create(results)?;
        let mut names = numbered(name);
        loop {
            let name = names.next().expect("there is no last number");
            let path = results.join(&name);
            match fs::create_dir(&path) {
                Ok(()) => {
                    let folder = Self::cleared(Claim::take(&path, A_RUN, Existing::Refuse)?)?;
                    link_latest(results, &name);
                    return Ok(folder);
                }
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(file_failure(&path, &error)),
            }
        }
    }

    /// Opens the folder of a run that is resumed, without clearing it.
    ///
    /// # Errors
    /// [`RunError::Usage`] if no run has written into the folder, or if another run uses it.
    pub fn resume(path: &Path) -> Result<Self, RunError> {
        let claim = Claim::again(path, A_RUN)?;
        refuse_links(claim.dir())?;
        let log = claim.dir().file(LOG, OFlags::WRONLY | OFlags::APPEND | OFlags::CREATE);
        let log = log.map_err(|error| file_failure(&claim.dir().path().join(LOG), &error))?;
        Self::with(claim, log)
    }

    /// Creates a subfolder for a refined result that will replace the present one.
    ///
    /// # Errors
    /// An earlier subfolder cannot be removed, or the new one cannot be created.
    pub fn refined(&self) -> Result<Self, RunError> {
        remove_refined(self.dir())?;
        let dir = self.dir().inner(REFINED);
        let dir = dir.map_err(|error| file_failure(&self.file(REFINED), &error))?;
        Self::cleared(Claim::take(&dir.path(), A_RUN, Existing::Refuse)?)
    }

    /// Replaces the results of this folder by those of a folder from [`ResultFolder::refined`].
    ///
    /// # Errors
    /// A file cannot be moved or removed.
    pub fn take_over(self, refined: Self) -> Result<Self, RunError> {
        take_over_refined(self.dir())?;
        Ok(Self { log: refined.log, ..self })
    }

    fn cleared(claim: Claim) -> Result<Self, RunError> {
        refuse_links(claim.dir())?;
        clear(claim.dir())?;
        let path = claim.dir().path().join(LOG);
        let log = fresh(&path).map_err(|error| file_failure(&path, &error))?;
        Self::with(claim, log)
    }

    fn with(claim: Claim, log: File) -> Result<Self, RunError> {
        let reserve = Reserve::keep(claim.dir(), RESERVE, SUMMARY_BYTES)?;
        Ok(Self { claim, log: Some(log), reserve: Mutex::new(Some(reserve)) })
    }

    /// Warning about a folder that cannot be locked.
    #[must_use]
    pub fn warning(&self) -> Option<&Warning> {
        self.claim.warning()
    }

    /// Returns whether the run in this folder has ended successfully.
    #[must_use]
    pub fn has_ended(&self) -> bool {
        let text = read_file(&self.file(SUMMARY)).ok();
        let summary = text.and_then(|text| serde_json::from_slice::<Summary>(&text).ok());
        summary.is_some_and(|summary| !summary.status.ended_early())
    }

    /// Removes the summary of an earlier end of a run that is resumed.
    ///
    /// # Errors
    /// The summary cannot be removed.
    pub fn reopen(&self) -> Result<(), RunError> {
        remove(&self.file(SUMMARY))
    }

    /// Reads the case as it was run.
    ///
    /// # Errors
    /// The file cannot be read, or is not a valid case.
    pub fn read_case(&self) -> Result<RawCase, RunError> {
        let path = self.file("case.toml");
        let text = read_file(&path).map_err(|error| input_failure(&path, &error))?;
        let name = self.shown().join("case.toml").display().to_string();
        Ok(RawCase::parse_bytes(&name, &text)?)
    }

    /// Returns the folder.
    #[must_use]
    pub fn dir(&self) -> &Dir {
        self.claim.dir()
    }

    /// Returns a path that leads to the folder while this object exists, even if the folder is
    /// renamed.
    #[must_use]
    pub fn path(&self) -> PathBuf {
        self.dir().path()
    }

    /// Returns the path of a file in the folder, based on [`ResultFolder::path`].
    #[must_use]
    pub fn file(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    /// Returns the path of the folder for display.
    #[must_use]
    pub fn shown(&self) -> PathBuf {
        self.dir().shown()
    }

    /// Returns the path of the log for display.
    #[must_use]
    pub fn shown_log(&self) -> PathBuf {
        self.shown().join(LOG)
    }

    /// Returns the log, opened for writing.
    pub fn log(&self) -> Result<File, RunError> {
        let log = self.log.as_ref().ok_or_else(|| io::Error::other("this run has no log"));
        let log = log.and_then(File::try_clone);
        log.map_err(|error| file_failure(&self.file(LOG), &error))
    }

    /// Writes a small file atomically: either the whole file exists, or none.
    pub fn write(&self, name: &str, content: &[u8]) -> Result<(), RunError> {
        replace(&self.file(name), content)
    }

    /// Writes the summary. The first summary goes into reserved space, so that a full disk does not
    /// leave a run without one.
    pub fn write_summary(&self, summary: &Summary) -> Result<(), RunError> {
        if !self.is_kept() {
            return Ok(());
        }
        let content = &summary.to_json();
        let reserve = self.reserve.lock().unwrap_or_else(PoisonError::into_inner).take();
        match reserve {
            Some(reserve) => reserve.write(&self.file(SUMMARY), content),
            None => self.write(SUMMARY, content),
        }
    }
}

/// Checks that the run would not replace its own case file.
fn spare_case(path: &Path, case: &Path) -> Result<(), RunError> {
    let Ok(case) = case.canonicalize() else { return Ok(()) };
    for name in FILES {
        if path.join(name).canonicalize().is_ok_and(|ours| ours == case) {
            return Err(RunError::Usage(format!(
                "the run would replace its own case file {}; give another folder with --out",
                case.display()
            )));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
