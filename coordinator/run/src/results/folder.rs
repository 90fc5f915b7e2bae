//! The folder that a run writes into: taken, cleared of an earlier run's results where that is wanted,
//! held open and locked until the run has ended.

use super::claim::{A_RUN, Claim, Existing, create};
use super::clear::{FILES, LOG, REFINED, RESERVE, SUMMARY};
use super::clear::{clear, refuse_links, remove_refined, take_over_refined};
use super::dir::Dir;
use super::place::{link_latest, numbered};
use super::write::{Reserve, fresh, remove, replace};
use crate::error::{RunError, file_failure};
use crate::results::summary::Status;
use case::RawCase;
use rustix::fs::OFlags;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Space kept on the disk for a summary \[byte\].
const SUMMARY_BYTES: u64 = 64 << 10;

/// The folder that a run writes into, locked for it.
#[derive(Debug)]
pub struct ResultFolder {
    claim: Claim,
    log: File,
    reserve: Mutex<Option<Reserve>>,
}

impl ResultFolder {
    /// Takes the folder at this path for a run of the case file `case`; it is made if it is not there.
    ///
    /// # Errors
    /// [`RunError::Usage`] if it is a file, holds what is not results of a run, or some that are to stay,
    /// holds `case` itself under a name that the run would write, or is used by another run.
    pub fn prepare(path: &Path, case: &Path, existing: Existing) -> Result<Self, RunError> {
        spare_case(path, case)?;
        Self::cleared(Claim::take(path, A_RUN, existing)?)
    }

    /// Makes the folder NAME in this one, or else NAME-2, and so on, and links it as the latest.
    ///
    /// # Errors
    /// The folder cannot be made.
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

    /// The folder of a run that is resumed; nothing is cleared.
    ///
    /// # Errors
    /// [`RunError::Usage`] if no run has written into it, or another run is doing so.
    pub fn resume(path: &Path) -> Result<Self, RunError> {
        let claim = Claim::again(path, A_RUN)?;
        refuse_links(claim.dir())?;
        let log = claim.dir().file(LOG, OFlags::WRONLY | OFlags::APPEND | OFlags::CREATE);
        let log = log.map_err(|error| file_failure(&claim.dir().path().join(LOG), &error))?;
        Self::with(claim, log)
    }

    /// A folder within this one, for an answer that is to take the place of the one that is here.
    ///
    /// # Errors
    /// The file system.
    pub fn refined(&self) -> Result<Self, RunError> {
        remove_refined(self.dir())?;
        let dir = self.dir().inner(REFINED);
        let dir = dir.map_err(|error| file_failure(&self.file(REFINED), &error))?;
        Self::cleared(Claim::take(&dir.path(), A_RUN, Existing::Refuse)?)
    }

    /// This folder with the results of one that [`ResultFolder::refined`] has made in the place of its
    /// own.
    ///
    /// # Errors
    /// The file system.
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
        Ok(Self { claim, log, reserve: Mutex::new(Some(reserve)) })
    }

    /// The run in it has come to its end, with success.
    #[must_use]
    pub fn has_ended(&self) -> bool {
        let text = fs::read(self.file(SUMMARY)).ok();
        let summary: Option<serde_json::Value> =
            text.and_then(|text| serde_json::from_slice(&text).ok());
        let status = summary.as_ref().and_then(|summary| summary["status"].as_str());
        status.is_some_and(|status| !Status::ENDED_EARLY.map(Status::word).contains(&status))
    }

    /// Removes the summary of the end that a resumed run has come to before.
    ///
    /// # Errors
    /// The file system.
    pub fn reopen(&self) -> Result<(), RunError> {
        remove(&self.file(SUMMARY))
    }

    /// The case as it was run.
    ///
    /// # Errors
    /// As [`RawCase::read`].
    pub fn read_case(&self) -> Result<RawCase, RunError> {
        let path = self.file("case.toml");
        let text = fs::read(&path).map_err(|error| file_failure(&path, &error))?;
        let name = self.shown().join("case.toml").display().to_string();
        Ok(RawCase::parse_bytes(&name, &text)?)
    }

    /// The folder itself.
    #[must_use]
    pub fn dir(&self) -> &Dir {
        self.claim.dir()
    }

    /// A path that leads to the folder as long as this is there, whatever the folder is called by then.
    #[must_use]
    pub fn path(&self) -> PathBuf {
        self.dir().path()
    }

    /// The path of a file in it, of the same kind.
    #[must_use]
    pub fn file(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    /// The path of the folder for people.
    #[must_use]
    pub fn shown(&self) -> PathBuf {
        self.dir().shown()
    }

    /// The path of the log for people.
    #[must_use]
    pub fn shown_log(&self) -> PathBuf {
        self.shown().join(LOG)
    }

    /// The log, to be written into.
    pub fn log(&self) -> Result<File, RunError> {
        self.log.try_clone().map_err(|error| file_failure(&self.file(LOG), &error))
    }

    /// Writes a small file in one go: it is there as a whole or not at all.
    pub fn write(&self, name: &str, content: &[u8]) -> Result<(), RunError> {
        replace(&self.file(name), content)
    }

    /// Writes the summary: at first into the space that is kept for it, so that a disk that is full does
    /// not leave a run without one.
    pub fn write_summary(&self, content: &[u8]) -> Result<(), RunError> {
        let reserve = self.reserve.lock().unwrap_or_else(PoisonError::into_inner).take();
        match reserve {
            Some(reserve) => reserve.write(&self.file(SUMMARY), content),
            None => self.write(SUMMARY, content),
        }
    }
}

/// The case file is not one of those that the run replaces.
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
