//! A folder held open by a handle, so that files reach it under any name.
//!
//! The kernel's `/proc/PID/fd/N` leads to an open folder itself, from every process of the user,
//! and is always ASCII. Therefore a folder that is renamed during a run keeps all of its results
//! together. Another folder that takes the old name receives none of them.

use rustix::fs::{Mode, OFlags, fstat, mkdirat, open, openat};
use rustix::io::Errno;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io;
use std::os::fd::{AsRawFd, OwnedFd};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const FOLDER: OFlags = OFlags::DIRECTORY.union(OFlags::CLOEXEC);

/// A folder held open.
#[derive(Clone, Debug)]
pub struct Dir {
    handle: Arc<OwnedFd>,
    given: PathBuf,
}

impl Dir {
    /// Opens a folder that a user names.
    ///
    /// # Errors
    /// The path is no folder, or cannot be opened.
    pub fn open(path: &Path) -> io::Result<Self> {
        let handle = open(path, FOLDER, Mode::empty())?;
        Ok(Self { handle: Arc::new(handle), given: shown(path) })
    }

    /// Opens the subfolder of this name, and creates it if it is missing. A link is not followed.
    ///
    /// # Errors
    /// The name is a link or a file, or the folder cannot be created.
    pub fn inner(&self, name: &str) -> io::Result<Self> {
        match mkdirat(&self.handle, name, Mode::from_raw_mode(0o777)) {
            Err(error) if error != Errno::EXIST => return Err(error.into()),
            _ => {}
        }
        let opened = openat(&self.handle, name, FOLDER | OFlags::NOFOLLOW, Mode::empty());
        let handle = opened.map_err(|error| match error {
            Errno::NOTDIR | Errno::LOOP => io::Error::other("is not a directory"),
            other => other.into(),
        })?;
        Ok(Self { handle: Arc::new(handle), given: self.shown().join(name) })
    }

    /// Opens a file in the folder. A link is not followed, and the call does not wait for the other
    /// end of a pipe.
    ///
    /// # Errors
    /// The file cannot be opened.
    pub fn file(&self, name: &str, flags: OFlags) -> io::Result<File> {
        let flags = flags | OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::CLOEXEC;
        Ok(openat(&self.handle, name, flags, Mode::from_raw_mode(0o666))?.into())
    }

    /// Returns a path that leads to the folder while this handle is open, even if the folder is
    /// renamed.
    #[must_use]
    pub fn path(&self) -> PathBuf {
        handles().join(self.handle.as_raw_fd().to_string())
    }

    /// Returns the path for display: the given path, or the current one if the folder has been
    /// moved.
    #[must_use]
    pub fn shown(&self) -> PathBuf {
        let there = fs::metadata(&self.given).map(|found| (found.dev(), found.ino()));
        let here = fstat(&self.handle).map(|own| (own.st_dev, own.st_ino));
        match (there, here) {
            (Ok(there), Ok(here)) if there == here => self.given.clone(),
            _ => shown(&self.path()),
        }
    }

    /// Returns the names of the entries of the folder.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn names(&self) -> io::Result<Vec<OsString>> {
        fs::read_dir(self.path())?.map(|entry| Ok(entry?.file_name())).collect()
    }
}

/// Folder in which the kernel shows the open files of this process.
fn handles() -> PathBuf {
    PathBuf::from(format!("/proc/{}/fd", std::process::id()))
}

/// Returns the path for display. A path through a handle is replaced by that of the open folder.
#[must_use]
pub fn shown(path: &Path) -> PathBuf {
    let Ok(rest) = path.strip_prefix(handles()) else { return path.to_owned() };
    let mut parts = rest.components();
    let folder = parts.next().and_then(|number| fs::read_link(handles().join(number)).ok());
    match folder {
        Some(folder) if parts.as_path().as_os_str().is_empty() => folder,
        Some(folder) => folder.join(parts.as_path()),
        None => path.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rustix::fs::{CWD, FileType, mknodat};

    #[test]
    fn what_is_written_lands_in_the_folder_whatever_it_is_called() {
        let place = tempfile::tempdir().unwrap();
        let (before, after) = (place.path().join("before"), place.path().join("after"));
        fs::create_dir(&before).unwrap();
        let dir = Dir::open(&before).unwrap();
        assert_eq!(dir.shown(), before);
        fs::rename(&before, &after).unwrap();
        fs::create_dir(&before).unwrap();
        fs::write(dir.path().join("file"), "x").unwrap();
        assert!(after.join("file").exists() && !before.join("file").exists());
        assert_eq!(dir.shown().as_os_str(), after.as_os_str(), "without a slash at its end");
        assert_eq!(shown(&dir.path().join("file")), after.join("file"));
        assert_eq!(dir.names().unwrap(), ["file"]);
    }

    #[test]
    fn a_link_within_is_not_followed() {
        let place = tempfile::tempdir().unwrap();
        let dir = Dir::open(place.path()).unwrap();
        std::os::unix::fs::symlink("/tmp", place.path().join("fields")).unwrap();
        let error = dir.inner("fields").unwrap_err().to_string();
        assert_eq!(error, "is not a directory");
        assert_eq!(dir.inner("other").unwrap().shown(), place.path().join("other"));
        assert!(dir.file("fields", OFlags::RDONLY).is_err());
        mknodat(CWD, dir.path().join("pipe"), FileType::Fifo, Mode::from_raw_mode(0o600), 0)
            .unwrap();
        assert!(dir.file("pipe", OFlags::WRONLY).is_err(), "nobody reads it");
    }
}
