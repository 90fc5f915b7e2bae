//! Whose a folder of results is, and which process may write into it.
//!
//! A file of its own, [`MARKER`], says that a folder holds results, and of what. Nothing in a folder
//! without it is ever replaced. It also carries the lock: a process that writes into the folder holds it
//! until it ends.

use super::dir::Dir;
use crate::error::{RunError, file_failure};
use rustix::fs::{FlockOperation, OFlags, flock};
use rustix::io::Errno;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::Path;

/// The file that says what a folder is.
pub const MARKER: &str = ".cosim-results";

/// What the marker of a run says.
pub const A_RUN: &str = "a run";

/// What becomes of results that are there already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// They stay, and the folder is refused.
    Refuse,
    /// They are replaced.
    Replace,
}

impl Existing {
    /// As the option `--replace` says.
    #[must_use]
    pub fn option(replace: bool) -> Self {
        if replace { Self::Replace } else { Self::Refuse }
    }
}

/// A folder that only this process writes into.
#[derive(Debug)]
pub struct Claim {
    dir: Dir,
    /// Holds the lock.
    _marker: File,
}

/// What is in a folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Content {
    Nothing,
    /// Results of the kind asked for.
    Results,
    Foreign,
}

impl Claim {
    /// Takes the folder at this path, which is made if it is not there, for results `of` a run or a
    /// study.
    ///
    /// # Errors
    /// [`RunError::Usage`] if it is a file, holds what is not such results, holds some that are to stay,
    /// or is used by another process.
    pub fn take(path: &Path, of: &str, existing: Existing) -> Result<Self, RunError> {
        create(path)?;
        let dir = Dir::open(path).map_err(|error| file_failure(path, &error))?;
        if content(&dir, of)? == Content::Foreign {
            return Err(refuse(
                &dir,
                &format!("holds files but no results of {of}; give a new folder with --out"),
            ));
        }
        let marker = lock(&dir)?;
        // Now that nobody else writes.
        if content(&dir, of)? == Content::Results && existing == Existing::Refuse {
            let fix = "--replace replaces them, or give another folder with --out";
            return Err(refuse(&dir, &format!("holds results of {of} already; {fix}")));
        }
        mark(&marker, of).map_err(|error| file_failure(&dir.path().join(MARKER), &error))?;
        Ok(Self { dir, _marker: marker })
    }

    /// Takes a folder that holds results `of` a run or a study, to go on with them.
    ///
    /// # Errors
    /// [`RunError::Usage`] if it holds none, or is used by another process.
    pub fn again(path: &Path, of: &str) -> Result<Self, RunError> {
        match Dir::open(path) {
            Ok(dir) if is_marked(&dir, of) => Ok(Self { _marker: lock(&dir)?, dir }),
            _ => {
                let shown = path.display();
                Err(RunError::Usage(format!("{shown} holds no results of {of}")))
            }
        }
    }

    /// The folder.
    #[must_use]
    pub fn dir(&self) -> &Dir {
        &self.dir
    }
}

/// The folder at this path holds results `of` a run or a study.
#[must_use]
pub fn holds_results(path: &Path, of: &str) -> bool {
    Dir::open(path).is_ok_and(|dir| is_marked(&dir, of))
}

fn refuse(dir: &Dir, what: &str) -> RunError {
    RunError::Usage(format!("{} {what}", dir.shown().display()))
}

/// Makes the folder, and those that it lies in.
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
    // A marker alone is what a process leaves that was killed at once.
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

/// What a marker begins with.
fn head(of: &str) -> String {
    format!("results of {of};")
}

fn mark(mut marker: &File, of: &str) -> io::Result<()> {
    let text = format!("{} --replace may replace what is in this folder\n", head(of));
    marker.set_len(0).and_then(|()| marker.write_all(text.as_bytes()))
}

/// Takes the marker for this process.
fn lock(dir: &Dir) -> Result<File, RunError> {
    let marker = dir.file(MARKER, OFlags::RDWR | OFlags::CREATE | OFlags::APPEND);
    let marker = marker.map_err(|error| file_failure(&dir.path().join(MARKER), &error))?;
    match flock(&marker, FlockOperation::NonBlockingLockExclusive) {
        Err(Errno::WOULDBLOCK) => {
            let fix = "wait for its end, or give another folder with --out";
            return Err(refuse(dir, &format!("is used by another run; {fix}")));
        }
        // Some network file systems know no locks.
        Err(error) => tracing::warn!(%error, "the result folder cannot be locked"),
        Ok(()) => {}
    }
    Ok(marker)
}
