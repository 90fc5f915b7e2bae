//! Ownership of a result folder, and the lock of the process that may write into it.
//!
//! The file [`MARKER`] states that a folder holds results, and their kind. Files in a folder
//! without the marker are never replaced. The marker also carries the lock: a process that writes
//! into the folder holds it until it ends.

use super::dir::Dir;
use crate::error::{RunError, file_failure};
use crate::warnings::Warning;
use proto::lock_file::LockFile;
use rustix::fs::OFlags;
use std::fs::{self, File, TryLockError};
use std::io::{self, Read, Write};
use std::path::Path;
use std::time::Duration;

/// File that marks a result folder.
pub const MARKER: &str = ".cosim-results";

/// Kind of results in the marker of a run.
pub const A_RUN: &str = "a run";

/// Number of refusals of the lock that may be due to somebody who watches.
const LOOKS: usize = 10;
/// Time between two tries to take the lock.
const PAUSE: Duration = Duration::from_millis(5);

/// Treatment of existing results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// Existing results stay, and the folder is refused.
    Refuse,
    /// Existing results are replaced.
    Replace,
}

impl Existing {
    /// Returns the treatment chosen by the option `--replace`.
    #[must_use]
    pub fn option(replace: bool) -> Self {
        if replace { Self::Replace } else { Self::Refuse }
    }
}

/// A folder into which only this process writes.
#[derive(Debug)]
pub struct Claim {
    dir: Dir,
    /// Carries the lock.
    _marker: LockFile,
    warning: Option<Warning>,
}

/// Content of a folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Content {
    Nothing,
    /// Results of the requested kind.
    Results,
    Foreign,
}

impl Claim {
    /// Takes the folder at this path for results `of` a run or a study. A missing folder is
    /// created.
    ///
    /// # Errors
    /// [`RunError::Usage`] if the path is a file, the folder holds other files, holds results that
    /// are to stay, or is used by another process.
    pub fn take(path: &Path, of: &str, existing: Existing) -> Result<Self, RunError> {
        create(path)?;
        let dir = Dir::open(path).map_err(|error| file_failure(path, &error))?;
        if content(&dir, of)? == Content::Foreign {
            return Err(refuse(
                &dir,
                &format!("holds files but no results of {of}; give a new folder with --out"),
            ));
        }
        let (marker, warning) = lock(&dir)?;
        // The check is final only under the lock.
        if content(&dir, of)? == Content::Results && existing == Existing::Refuse {
            let fix = "replace them with --replace, or give another folder with --out";
            return Err(refuse(&dir, &format!("already holds results of {of}; {fix}")));
        }
        mark(&marker, of).map_err(|error| file_failure(&dir.path().join(MARKER), &error))?;
        Ok(Self { dir, _marker: marker, warning })
    }

    /// Takes a folder that holds results `of` a run or a study, to continue them.
    ///
    /// # Errors
    /// [`RunError::Usage`] if the folder holds no such results, or is used by another process.
    pub fn again(path: &Path, of: &str) -> Result<Self, RunError> {
        match Dir::open(path) {
            Ok(dir) if is_marked(&dir, of) => {
                let (marker, warning) = lock(&dir)?;
                Ok(Self { dir, _marker: marker, warning })
            }
            _ => {
                let shown = path.display();
                Err(RunError::Usage(format!("{shown} holds no results of {of}")))
            }
        }
    }

    /// Warning about a folder that cannot be locked.
    #[must_use]
    pub fn warning(&self) -> Option<&Warning> {
        self.warning.as_ref()
    }

    /// The folder.
    #[must_use]
    pub fn dir(&self) -> &Dir {
        &self.dir
    }
}

/// Returns whether the folder at this path holds results `of` a run or a study.
#[must_use]
pub fn holds_results(path: &Path, of: &str) -> bool {
    Dir::open(path).is_ok_and(|dir| is_marked(&dir, of))
}

fn refuse(dir: &Dir, what: &str) -> RunError {
    RunError::Usage(format!("{} {what}", dir.shown().display()))
}

/// Creates the folder and its parents.
pub(super) fn create(path: &Path) -> Result<(), RunError> {
    match fs::create_dir_all(path) {
        Ok(()) => Ok(()),
        Err(error) => match error.kind() {
            io::ErrorKind::AlreadyExists | io::ErrorKind::NotADirectory => Err(RunError::Usage(
                format!("{} is not a directory; give one with --out", path.display()),
            )),
            _ => Err(file_failure(path, &error)),
        },
    }
}

fn content(dir: &Dir, of: &str) -> Result<Content, RunError> {
    let names = dir.names().map_err(|error| file_failure(&dir.path(), &error))?;
    // A marker alone is left by a process that was killed at once.
    Ok(match names.iter().all(|name| name == MARKER) {
        true if !dir.path().join(MARKER).is_symlink() => Content::Nothing,
        false if is_marked(dir, of) => Content::Results,
        _ => Content::Foreign,
    })
}

fn is_marked(dir: &Dir, of: &str) -> bool {
    let expected = head(of);
    let mut found = vec![0; expected.len()];
    let read = dir.file(MARKER, OFlags::RDONLY).and_then(|mut file| file.read_exact(&mut found));
    read.is_ok() && found == expected.as_bytes()
}

/// Returns the beginning of a marker.
fn head(of: &str) -> String {
    format!("results of {of};")
}

fn mark(mut marker: &File, of: &str) -> io::Result<()> {
    let text = format!("{} --replace may replace the content of this folder\n", head(of));
    marker.set_len(0).and_then(|()| marker.write_all(text.as_bytes()))
}

/// Tries to take the lock. Whoever watches holds it for an instant at every look, so that a first
/// refusal proves nothing.
fn try_lock(marker: &LockFile) -> Result<(), TryLockError> {
    for _ in 0..LOOKS {
        match marker.try_lock() {
            Err(TryLockError::WouldBlock) => std::thread::sleep(PAUSE),
            other => return other,
        }
    }
    marker.try_lock()
}

/// Locks the marker for this process. A file system without locks causes a warning.
fn lock(dir: &Dir) -> Result<(LockFile, Option<Warning>), RunError> {
    let marker = dir.file(MARKER, OFlags::RDWR | OFlags::CREATE | OFlags::APPEND);
    let marker = marker.map_err(|error| file_failure(&dir.path().join(MARKER), &error))?;
    let marker = LockFile::from(marker);
    match try_lock(&marker) {
        Err(TryLockError::WouldBlock) => {
            let fix = "wait for its end, or give another folder with --out";
            Err(refuse(dir, &format!("is used by another run; {fix}")))
        }
        // Some network file systems have no locks.
        Err(TryLockError::Error(error)) => {
            let reason = format!("the result folder cannot be locked: {error}");
            let fix = "let no other run write into it, or use a file system with locks";
            let warning = Warning::remark("results", reason, fix);
            tracing::warn!("{warning}");
            Ok((marker, Some(warning)))
        }
        Ok(()) => Ok((marker, None)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::watching::is_running;
    use std::sync::atomic::{AtomicBool, Ordering};

    /// Somebody who watches a folder does not keep a run from it; another run does.
    #[test]
    fn a_look_does_not_refuse_a_run() {
        let folder = tempfile::tempdir().unwrap();
        let take = || Claim::take(folder.path(), A_RUN, Existing::Replace);
        drop(take().unwrap());
        let done = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !done.load(Ordering::Relaxed) {
                    let _ = is_running(folder.path());
                }
            });
            let refused = (0..200).filter(|_| take().is_err()).count();
            done.store(true, Ordering::Relaxed);
            assert_eq!(refused, 0);
        });
        let held = take().unwrap();
        assert!(take().unwrap_err().to_string().contains("is used by another run"));
        drop(held);
    }
}
